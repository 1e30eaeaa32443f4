//! The neutral file: exact round trips, and errors that name the place.

use crate::share::one_of;
use crate::support::{Change, assert_named, assert_round_trip, edited, edits, refused};
use featherbench_formats::neutral::{self, NeutralProblem};
use featherbench_model::{BodyDescription, Description, Frame, JointDescription, Malformed, Placement, Provenance};
use featherbench_robots::{Base, Family, Joints, Kind, Mix, Tree};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn generate(spec: &str) -> Description {
    Family::parse(spec).and_then(|family| family.generate()).unwrap_or_else(|error| panic!("{spec}: {error}"))
}

#[test]
fn generated_robots_round_trip() {
    let families = ["chain:n=30,layout=spatial,tip_scale=1e6", "binary_tree", "star", "humanoid", "quadruped", "hand"];
    families.into_iter().for_each(|spec| assert_round_trip(&generate(spec)));
    for &kind in Kind::ALL {
        for &base in Base::ALL {
            assert_round_trip(&Family::Joints(Joints { kind, base, ..Joints::default() }).generate().expect("every combination exists"));
        }
    }
}

/// A robot with every feature: fixed bodies, frames, provenance, quotes and line breaks in names, extreme numbers.
fn everything() -> Description {
    let mut robot = generate("tree:n=6,joints=all,armature=true");
    robot.name = "quotes \" and \\ and\nlines, ünïcode \u{1F916}".to_owned();
    let joint = JointDescription { name: "weld".to_owned(), ..JointDescription::default() };
    robot.bodies.push(BodyDescription {
        name: "\"plate\"".to_owned(),
        parent: Some(2),
        mass: 0.0,
        com: [0.0; 3],
        inertia: [0.0; 6],
        joint,
    });
    robot.frames.push(Frame { name: "tool".to_owned(), body: Some(3), placement: Placement::default() });
    robot.frames.push(Frame {
        name: "origin".to_owned(),
        body: None,
        placement: Placement { translation: [1e-300, -0.0, 1e22], ..Placement::default() },
    });
    robot.provenance = Some(Provenance {
        source: "package 1.0, robots/a.urdf".to_owned(),
        licence: "BSD-3-Clause".to_owned(),
        header: "says \"nothing\"".to_owned(),
        readme: "license: BSD-3-Clause".to_owned(),
        notes: vec!["line 3: merged".to_owned(), String::new()],
    });
    robot.bodies[0].com = [f64::MIN_POSITIVE, f64::MAX, 5e-324];
    robot.bodies[1].com = [0.1 + 0.2, -0.0, 123_456_789.123_456_79];
    robot
}

#[test]
fn everything_round_trips() {
    assert_round_trip(&everything());
    let mut bare = everything();
    bare.provenance = Some(Provenance::default());
    bare.frames.clear();
    assert_round_trip(&bare);
    assert_round_trip(&Description { name: String::new(), ..Description::default() });
}

#[test]
fn a_line_is_what_an_oracle_takes() {
    let robot = everything();
    let line = neutral::to_line(&robot).expect("a tree");
    assert!(!line.contains('\n') && !line.contains("provenance") && !line.contains("frames"));
    let read = neutral::parse(&line, "line").expect("the same format");
    assert_eq!(read.bodies.len(), 6, "the fixed body is merged");
    for body in &read.bodies {
        let nv = body.joint.kind.nv();
        assert_eq!([body.joint.armature.len(), body.joint.damping.len(), body.joint.friction.len()], [nv; 3]);
    }
    assert!(neutral::to_line(&Description::default()).is_err());
}

#[test]
fn files_are_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("robot.json");
    let robot = everything();
    neutral::write(&robot, &path).expect("writable");
    assert_eq!(neutral::read(&path).expect("readable"), robot);

    let mut broken = robot.clone();
    broken.bodies[0].mass = f64::NAN;
    let error = neutral::write(&broken, &path).expect_err("NaN is refused");
    assert!(matches!(*error.problem, NeutralProblem::Malformed(Malformed::NotFinite { field: "mass", .. })));
    assert_eq!(neutral::read(&path).expect("untouched"), robot);
    let names: Vec<_> = std::fs::read_dir(folder.path()).expect("listed").map(|entry| entry.expect("an entry").file_name()).collect();
    assert_eq!(names, ["robot.json"], "nothing is left behind");

    let error = neutral::write(&robot, folder.path().join("no/such/folder.json")).expect_err("no folder");
    assert!(error.to_string().contains("no/such/folder.json: the file cannot be written"), "{error}");
    let error = neutral::read(folder.path().join("absent.json")).expect_err("no file");
    assert!(error.to_string().contains("absent.json: the file cannot be read"), "{error}");
    std::fs::write(&path, [0x7f, b'E', b'L', b'F', 0xff, 0xfe, 0x00]).expect("writable");
    let error = neutral::read(&path).expect_err("binary");
    assert!(error.to_string().contains("is not UTF-8 text (byte 4"), "{error}");
}

const GOOD: &str = r#"{"format":1,"name":"r","gravity":[0,0,-9.81],
 "bodies":[
  {"name":"rod","mass":1.0,"com":[0.5,0,0],"inertia":[0.01,0,0,0.08,0,0.08],"parent":-1,
   "joint":{"name":"hinge","type":"revolute","axis":[0,1,0],
    "placement":{"rotation":[1,0,0,0,1,0,0,0,1],"translation":[0,0,0]}}}
 ]}"#;

#[test]
fn bad_files_are_named() {
    assert!(neutral::parse(GOOD, "good.json").is_ok());
    assert!(neutral::parse(&format!("\u{feff}{GOOD}\n"), "good.json").is_ok(), "a byte-order mark is no harm");
    let changes: &[Change<'_>] = &[
        (r#""format":1"#, r#""format":2"#, &["f.json:1:2: format 2 is not known", "\"format\": 1"]),
        (r#""format":1"#, r#""format":"1""#, &["format \"1\" is not known"]),
        (r#""format":1,"#, "", &["missing field `format`"]),
        (r#""mass":1.0,"#, "", &["f.json:5:", "field 'bodies[0]'", "missing field `mass`", "FORMAT.md"]),
        (r#""mass":1.0"#, r#""mass":"heavy""#, &["f.json:3:30", "field 'bodies[0].mass'", "invalid type: string \"heavy\", expected f64"]),
        (r#""mass":1.0"#, r#""mass":NaN"#, &["f.json:3:", "not valid JSON"]),
        (r#""mass":1.0"#, r#""mass":1e999"#, &["f.json:3:", "number out of range"]),
        (r#""mass":1.0"#, r#""mass":-1.0"#, &["f.json:3:11: body 'rod': mass is -1 kg"]),
        (r#""mass":1.0"#, r#""mass":1.0,"colour":"red""#, &["f.json:3:", "bodies[0].colour", "unknown field `colour`"]),
        (r#""mass":1.0"#, r#""mass":1.0,"mass":2.0"#, &["duplicate field `mass`"]),
        ("[0.5,0,0]", "[0.5,0]", &["field 'bodies[0].com", "invalid length 2, expected an array of length 3"]),
        ("[0.5,0,0]", "[0.5,0,0,0]", &["f.json:3:", "field 'bodies[0].com': the list is longer"]),
        (r#""parent":-1"#, r#""parent":-2"#, &["bodies[0].parent", "-2 is no body; the world is -1"]),
        (r#""parent":-1"#, r#""parent":0.5"#, &["bodies[0].parent"]),
        (r#""parent":-1"#, r#""parent":5"#, &["f.json:3:11: body 'rod': parent 5 does not exist"]),
        (r#""parent":-1"#, r#""parent":0"#, &["body 'rod': its chain of parents returns to itself"]),
        ("revolute", "hinge", &["bodies[0].joint", "unknown type 'hinge'; choose one of fixed, revolute"]),
        (r#""axis":[0,1,0],"#, "", &["bodies[0].joint", "revolute joint 'hinge' has no 'axis'"]),
        ("revolute", "spherical", &["spherical joint 'hinge' has an 'axis'"]),
        ("revolute", "helical", &["helical joint 'hinge' has no 'pitch'"]),
        (r#""axis":[0,1,0],"#, r#""axis":[0,1,0],"pitch":0.1,"#, &["has a 'pitch', which only a helical joint has"]),
        ("[0,1,0]", "[0,2,0]", &["the axis of joint 'hinge' has length 2"]),
        (r#""rotation":[1,"#, r#""rotation":[-1,"#, &["the rotation of joint 'hinge' misses orthonormality"]),
        ("\n ]}", "\n ],\"contacts\":[{}]}", &["f.json:6:4: section 'contacts' is not supported by this version"]),
        ("\n ]}", "\n ],\"loops\":{}}", &["field 'loops'", "expected a sequence"]),
        ("\n ]}", "\n ],\"actuation\":1}", &["section 'actuation'"]),
        ("\n ]}", "\n ],\"parameters\":[]}", &["unknown field `parameters`"]),
        ("\n ]}", "\n ],\"sensors\":[]}", &["unknown field `sensors`"]),
        ("\n ]}", "\n ],\"frames\":[{\"name\":\"t\",\"body\":0}]}", &["frames[0]", "missing field `placement`"]),
        ("\n ]}", "\n ],\"provenance\":{}}", &["provenance", "missing field `source`"]),
        ("\n ]}", "\n ]", &["f.json:6:2: this is not valid JSON: EOF"]),
        ("\n ]}", "\n ]} {}", &["f.json:6:5: this is not valid JSON: trailing characters"]),
    ];
    assert_named(GOOD, changes, refused);
    for (text, part) in
        [("", "is empty"), (" \n", "is empty"), ("[]", "invalid"), ("null", "invalid type: null"), ("\u{0}\u{1}", "not valid JSON")]
    {
        let error = refused(text);
        assert!(error.starts_with("f.json") && error.contains(part), "{error}");
    }
}

#[test]
fn deep_nesting_is_an_error() {
    for deep in ["[".repeat(1_000_000), format!("{{\"contacts\":{}", "[".repeat(1_000_000)), "{\"a\":".repeat(1_000_000)] {
        let error = neutral::parse(&deep, "deep.json").expect_err("too deep").to_string();
        assert!(error.starts_with("deep.json:1:"), "{error}");
    }
}

fn any_tree() -> impl Strategy<Value = Description> {
    (1_usize..30, any::<u64>(), 0.0..=1.0, any::<[bool; 3]>()).prop_map(|(n, seed, spread, [all, free, armature])| {
        let tree = Tree {
            n,
            seed,
            spread,
            joints: if all { Mix::All } else { Mix::Revolute },
            base: if free { Base::Free } else { Base::Fixed },
            armature,
            ..Tree::default()
        };
        Family::Tree(tree).generate().expect("in range")
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn random_robots_round_trip(robot in any_tree()) {
        assert_round_trip(&robot);
    }

    /// Any finite bits, in the fields where every number is allowed.
    #[test]
    fn any_number_round_trips(numbers in proptest::collection::vec(any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite()), 12)) {
        let mut robot = generate("chain:n=1");
        let body = &mut robot.bodies[0];
        robot.gravity.copy_from_slice(&numbers[..3]);
        body.com.copy_from_slice(&numbers[3..6]);
        body.joint.placement.translation.copy_from_slice(&numbers[6..9]);
        body.inertia[..3].copy_from_slice(&numbers[9..12]);
        assert_round_trip(&robot);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// A file with bytes changed, removed or doubled is read or gives an error, never a panic.
    #[test]
    fn mutated_files_never_panic(edits in edits(6)) {
        if let Err(error) = neutral::parse(&edited(GOOD, edits, usize::MAX), "mutated.json") {
            prop_assert!(error.to_string().starts_with("mutated.json"));
        }
    }
}

/// Depth 20 000, on a stack that has no room for a call per body: written in pieces, read back to the bit, and dropped.
#[test]
fn a_long_chain_is_written_in_pieces_and_read_back_on_a_small_stack() {
    let test = || {
        let robot = featherbench_robots::Family::parse("chain:n=20000,layout=spatial").unwrap().generate().unwrap();
        let text = neutral::to_string(&robot).unwrap();
        assert!(text.len() > 5_000_000, "several pieces");
        let mut streamed = Vec::new();
        neutral::write_to(&robot, &mut streamed, "memory").unwrap();
        assert!(streamed == text.as_bytes(), "the pieces are the text");

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chain.json");
        neutral::write(&robot, &path).unwrap();
        assert!(std::fs::read(&path).unwrap() == text.as_bytes(), "the file is the text");
        assert!(neutral::read(&path).unwrap() == robot);
    };
    std::thread::Builder::new().stack_size(256 << 10).spawn(test).unwrap().join().expect("the test passes on a small stack");
}

/// An output that takes no more is an error that names it.
#[test]
fn an_output_that_fails_is_named() {
    struct Full(usize);
    impl std::io::Write for Full {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            let taken = bytes.len().min(self.0);
            self.0 -= taken;
            Ok(taken)
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let robot = featherbench_robots::Family::parse("chain:n=1000").unwrap().generate().unwrap();
    for room in [0, 100, 100_000] {
        let error = neutral::write_to(&robot, &mut Full(room), "the pipe").expect_err("no room").to_string();
        assert!(error.starts_with("the pipe: the file cannot be written"), "{error}");
    }
}
