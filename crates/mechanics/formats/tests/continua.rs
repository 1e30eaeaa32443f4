//! Continua in files: exact round trips in the neutral format, errors that name the place, and formats that have no such bodies.

use crate::share::one_of;
use crate::support::{Change, assert_named, assert_round_trip, chain, edited, edits, placed, refused};
use featherbench_formats::{OnLoss, Reason, mjcf, neutral, urdf};
use featherbench_model::{
    Continuum, ContinuumElement, ContinuumMaterial, ContinuumSection, ContinuumTip, Description, Malformed, Placement,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

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

#[test]
fn every_element_round_trips_in_the_neutral_format() {
    for continuum in every_continuum() {
        assert_round_trip(&Description { continua: vec![continuum], ..chain(3) });
    }
    assert_round_trip(&Description { continua: every_continuum(), ..chain(3) });
    assert!(!neutral::to_string(&chain(3)).unwrap().contains("continua"), "a file without continua has no such section");
}

/// An oracle computes with rigid trees, and gets no robot that deforms.
#[test]
fn oracles_urdf_and_mjcf_get_none() {
    let robot = Description { continua: every_continuum(), ..chain(3) };
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

#[test]
fn bad_continua_are_named_by_file_field_and_index() {
    let good = placed(GOOD);
    assert_eq!(neutral::parse(&good, "good.json").unwrap().continua.len(), 2);
    let changes: &[Change<'_>] = &[
        (r#""name":"beam","#, "", &["field 'continua[0]'", "missing field `name`"]),
        (r#""young":2e11"#, r#""young":-2e11"#, &["f.json:6:11: continua[0] 'beam': material.young is -200000000000; it must be positive"]),
        (r#""young":2e11"#, r#""young":"steel""#, &["continua[0].material.young", "expected f64"]),
        (r#""young":2e11,"#, "", &["continua[0].material", "missing field `young`"]),
        (r#""poisson":0.3"#, r#""shear":0.3"#, &["continua[0].material.shear", "unknown field `shear`"]),
        (r#""density":7850"#, r#""density":1e999"#, &["out of range"]),
        (r#""width":0.01"#, r#""radius":0.01"#, &["continua[0].section", "unknown field `radius`, expected `width` or `height`"]),
        (r#""width":0.01,"#, "", &["continua[0].section", "missing field `width`"]),
        (r#""type":"tube""#, r#""type":"pipe""#, &["continua[1].section", "unknown variant `pipe`, expected one of `circle`"]),
        (r#""links_middle""#, r#""cable""#, &["continua[0].element", "'cable' is no element; choose one of links_start"]),
        (r#""links_middle""#, r#""string_links","nodes":2"#, &["continua[0].nodes", "unknown field `nodes`"]),
        (r#""count":16"#, r#""count":-1"#, &["continua[0].count", "expected usize"]),
        (r#"["bend_y"]"#, r#"["bend"]"#, &["continua[0].strains[0]", "'bend' is no strain; choose from twist"]),
        (r#""body":-1"#, r#""body":-2"#, &["continua[1].body", "-2 is no body; the world is -1"]),
        (r#""tip":{"mass":0.1,"#, r#""tip":{"#, &["continua[1].tip", "missing field `mass`"]),
    ];
    assert_named(&good, changes, refused);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2048 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// A file with bytes changed, removed or doubled in its continua is read or gives an error, never a panic; what is read is written.
    #[test]
    fn mutated_continua_never_panic(edits in edits(4)) {
        let good = placed(GOOD);
        let (bodies, continua) = good.split_at(good.find("\"continua\"").unwrap());
        let text = bodies.to_owned() + &edited(continua, edits, usize::MAX);
        match neutral::parse(&text, "mutated.json") {
            Ok(robot) => assert_round_trip(&robot),
            Err(error) => prop_assert!(error.to_string().starts_with("mutated.json")),
        }
    }
}
