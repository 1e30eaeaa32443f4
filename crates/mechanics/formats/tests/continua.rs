//! Continua in files: exact round trips in the neutral format, errors that name the place, and formats that have no such bodies.

use crate::share::one_of;
use featherbench_formats::{OnLoss, Reason, mjcf, neutral, urdf};
use featherbench_model::{
    Continuum, ContinuumElement, ContinuumMaterial, ContinuumSection, ContinuumTip, Description, Malformed, Placement,
};
use featherbench_robots::Family;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// A chain of three hinges.
fn chain() -> Description {
    let mut robot = Family::parse("chain:n=3,layout=spatial").and_then(|family| family.generate()).expect("a family");
    robot.gravity = [0.0, 0.0, -9.81];
    robot
}

fn sections() -> [ContinuumSection; 4] {
    [
        ContinuumSection::Circle { radius: 0.1 + 0.2 },
        ContinuumSection::Tube { inner: 0.0, outer: 1.0 / 3.0 },
        ContinuumSection::Rectangle { width: 5e-324, height: 1e300 },
        ContinuumSection::General { area: 1e-4, second_moments: [1.0 / 3.0, 0.1 + 0.7], torsion: 1e-12, shear_factor: 5.0 / 6.0 },
    ]
}

/// A continuum of every element, with every section and both kinds of tip.
fn every_continuum() -> Vec<Continuum> {
    let tip = ContinuumTip { mass: 0.0, com: [-0.0, 1e-300, 0.1 + 0.2], inertia: [1e-6, -0.0, 0.0, 1.0 / 3.0, 0.0, 1e-6] };
    let of = |(k, element): (usize, ContinuumElement)| Continuum {
        name: format!("a \"{}\" one", element.name()),
        body: (k % 2 == 0).then_some(k % 3),
        placement: Placement { rotation: [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0], translation: [0.1 + 0.2, -0.0, 1e-300] },
        length: 0.1 + 0.7,
        material: ContinuumMaterial { young: 1e11 / 3.0, poisson: 0.5, density: 7850.1, damping: 0.0 },
        section: sections()[k % 4],
        element,
        count: k + 1,
        strains: element.strains().to_vec(),
        tip: (k % 2 == 1).then_some(tip),
    };
    ContinuumElement::ALL.into_iter().enumerate().map(of).collect()
}

fn bits(continua: &[Continuum]) -> Vec<u64> {
    let mut numbers = Vec::new();
    for continuum in continua {
        numbers.extend(continuum.placement.rotation.into_iter().chain(continuum.placement.translation).chain([continuum.length]));
        let ContinuumMaterial { young, poisson, density, damping } = continuum.material;
        numbers.extend([young, poisson, density, damping]);
        match continuum.section {
            ContinuumSection::Circle { radius } => numbers.push(radius),
            ContinuumSection::Tube { inner, outer } => numbers.extend([inner, outer]),
            ContinuumSection::Rectangle { width, height } => numbers.extend([width, height]),
            ContinuumSection::General { area, second_moments: [y, z], torsion, shear_factor } => {
                numbers.extend([area, y, z, torsion, shear_factor]);
            }
        }
        let of_tip = continuum.tip.map(|tip| [tip.mass].into_iter().chain(tip.com).chain(tip.inertia).collect::<Vec<_>>());
        numbers.extend(of_tip.into_iter().flatten());
    }
    numbers.into_iter().map(f64::to_bits).collect()
}

fn assert_round_trip(robot: &Description) {
    let text = neutral::to_string(robot).unwrap_or_else(|error| panic!("{error}"));
    let again = neutral::parse(&text, "robot.json").unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(&again, robot);
    assert_eq!(bits(&again.continua), bits(&robot.continua));
    assert_eq!(neutral::to_string(&again).as_ref(), Ok(&text), "the same bytes for the same robot");
}

#[test]
fn every_element_round_trips_in_the_neutral_format() {
    for continuum in every_continuum() {
        assert_round_trip(&Description { continua: vec![continuum], ..chain() });
    }
    assert_round_trip(&Description { continua: every_continuum(), ..chain() });
    assert!(!neutral::to_string(&chain()).unwrap().contains("continua"), "a file without continua has no such section");
}

/// An oracle computes with rigid trees, and gets no robot that deforms.
#[test]
fn oracles_urdf_and_mjcf_get_none() {
    let robot = Description { continua: every_continuum(), ..chain() };
    let names: Vec<String> = robot.continua.iter().map(|continuum| continuum.name.clone()).collect();
    assert_eq!(neutral::to_line(&robot), Err(Malformed::Deforms { names }));
    for on_loss in [OnLoss::Refuse, OnLoss::LeaveOut] {
        for refused in [urdf::to_string(&robot, on_loss), mjcf::to_string(&robot, on_loss)] {
            let error = refused.expect_err("without them it is another robot");
            assert!(!error.can_be_left_out());
            assert!(
                error.to_string().contains("continua[7] 'a \"string_links\" one'")
                    && error.to_string().contains(&Reason::Deforms.to_string())
            );
        }
    }
}

const GOOD: &str = r#"{"format":1,"name":"r","gravity":[0,0,-9.81],
 "bodies":[
  {"name":"a","mass":1,"com":[0,0,0],"inertia":[1,0,0,1,0,1],"parent":-1,"joint":{"name":"h","type":"revolute","axis":[0,1,0],"placement":P}}
 ],
 "continua":[
  {"name":"beam","body":0,"placement":P,"length":1.5,"material":{"young":2e11,"poisson":0.3,"density":7850,"damping":0},
   "section":{"type":"rectangle","width":0.01,"height":0.02},"element":"links_middle","count":16,"strains":["bend_y"]},
  {"name":"finger","body":-1,"placement":P,"length":0.1,"material":{"young":1e6,"poisson":0.48,"density":1070,"damping":0.01},
   "section":{"type":"tube","inner":0.002,"outer":0.008},"element":"sections","count":8,"strains":["bend_y","bend_z"],
   "tip":{"mass":0.1,"com":[0,0,0],"inertia":[1,0,0,1,0,1]}}
 ]}"#;

fn good() -> String {
    GOOD.replace(":P", r#":{"rotation":[1,0,0,0,1,0,0,0,1],"translation":[0,0,0]}"#)
}

#[test]
fn bad_continua_are_named_by_file_field_and_index() {
    assert_eq!(neutral::parse(&good(), "good.json").unwrap().continua.len(), 2);
    let cases: &[(&str, &str, &[&str])] = &[
        (r#""name":"beam","#, "", &["field 'continua[0]'", "missing field `name`"]),
        (r#""name":"finger""#, r#""name":"beam""#, &["continua[1] 'beam': another continuum has the same name"]),
        (r#""young":2e11"#, r#""young":-2e11"#, &["f.json:6:11: continua[0] 'beam': material.young is -200000000000; it must be positive"]),
        (r#""young":2e11"#, r#""young":"steel""#, &["continua[0].material.young", "expected f64"]),
        (r#""young":2e11,"#, "", &["continua[0].material", "missing field `young`"]),
        (r#""poisson":0.3"#, r#""poisson":0.51"#, &["continua[0] 'beam': material.poisson is 0.51"]),
        (r#""poisson":0.3"#, r#""shear":0.3"#, &["continua[0].material.shear", "unknown field `shear`"]),
        (r#""density":7850"#, r#""density":1e999"#, &["out of range"]),
        (r#""width":0.01"#, r#""width":0"#, &["continua[0] 'beam': section.width is 0; it must be positive"]),
        (r#""width":0.01"#, r#""radius":0.01"#, &["continua[0].section", "a section of type rectangle has 'radius'"]),
        (r#""width":0.01,"#, "", &["continua[0].section", "has no 'width'; it needs width, height"]),
        (r#""type":"tube""#, r#""type":"pipe""#, &["continua[1].section", "unknown type 'pipe'; choose one of circle"]),
        (r#""inner":0.002"#, r#""inner":0.02"#, &["continua[1] 'finger': section.inner is 0.02 m"]),
        (r#""links_middle""#, r#""cable""#, &["continua[0].element", "'cable' is no element; choose one of links_start"]),
        (r#""links_middle""#, r#""string_links","nodes":2"#, &["continua[0].nodes", "unknown field `nodes`"]),
        (r#""count":16"#, r#""count":0"#, &["continua[0] 'beam': count is 0"]),
        (r#""count":16"#, r#""count":-1"#, &["continua[0].count", "expected usize"]),
        (r#"["bend_y"]"#, r#"["bend"]"#, &["continua[0].strains[0]", "'bend' is no strain; choose from twist"]),
        (
            r#""links_middle","count":16,"strains":["bend_y"]"#,
            r#""modes","count":16,"strains":["shear_y"]"#,
            &["continua[0] 'beam': strains: 'shear_y' is none of a continuum of element 'modes'; it has twist, bend_y"],
        ),
        (r#"["bend_y"]"#, "[]", &["continua[0] 'beam': strains: the list is empty"]),
        (r#""body":-1"#, r#""body":-2"#, &["continua[1].body", "-2 is no body; the world is -1"]),
        (r#""body":-1"#, r#""body":1"#, &["continua[1] 'finger': body: it is clamped to nothing"]),
        (r#""tip":{"mass":0.1,"#, r#""tip":{"#, &["continua[1].tip", "missing field `mass`"]),
        (r#""tip":{"mass":0.1"#, r#""tip":{"mass":-0.1"#, &["continua[1] 'finger': tip.mass is -0.1"]),
    ];
    for (from, to, parts) in cases {
        assert!(good().contains(from), "{from}");
        let error = neutral::parse(&good().replacen(from, to, 1), "f.json").expect_err(to).to_string();
        assert!(error.starts_with("f.json"), "{error}");
        for part in *parts {
            assert!(error.contains(part), "{to}\n  {error}\n  lacks {part}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2048 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// A file with bytes changed, removed or doubled in its continua is read or gives an error, never a panic; what is read is written.
    #[test]
    fn mutated_continua_never_panic(edits in proptest::collection::vec((any::<proptest::sample::Index>(), any::<proptest::sample::Index>(), 0..4, any::<char>()), 1..4)) {
        let good = good();
        let (bodies, continua) = good.split_at(good.find("\"continua\"").unwrap());
        let mut text: Vec<char> = continua.chars().collect();
        for (at, to, kind, with) in edits {
            if text.is_empty() {
                break;
            }
            let (at, to) = (at.index(text.len()), to.index(text.len()));
            match kind {
                0 => text[at] = with,
                1 => text[at] = char::from(b'0' + (with as u32 % 10) as u8),
                2 => { text.drain(at.min(to)..at.max(to)); }
                _ => { let copy = text[at.min(to)..at.max(to)].to_vec(); text.splice(at..at, copy); }
            }
        }
        let text: String = bodies.chars().chain(text).collect();
        match neutral::parse(&text, "mutated.json") {
            Ok(robot) => assert_round_trip(&robot),
            Err(error) => prop_assert!(error.to_string().starts_with("mutated.json")),
        }
    }
}
