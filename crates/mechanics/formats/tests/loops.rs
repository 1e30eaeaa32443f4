//! Loops in files: exact round trips in the neutral format, mimics in URDF, equality constraints in MJCF, and errors that name the place.

use crate::share::one_of;
use crate::support::{Change, assert_named, assert_round_trip, chain, edited, edits, placed, refused};
use featherbench_formats::urdf::Options;
use featherbench_formats::{ExportError, OnLoss, Reason, mjcf, neutral, urdf};
use featherbench_model::{Description, Loop, LoopEnd, LoopKind, LoopMotion, Placement};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// A quarter turn, and numbers that need all digits.
fn end(body: Option<usize>) -> LoopEnd {
    let rotation = [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0];
    LoopEnd { body, placement: Placement { rotation, translation: [0.1 + 0.2, -0.0, 1e-300] } }
}

fn named(name: &str, kind: LoopKind) -> Loop {
    Loop { name: name.into(), kind }
}

/// A loop of every kind.
fn every_loop() -> Vec<Loop> {
    let ends = [end(None), end(Some(3))];
    let mut loops: Vec<Loop> = LoopMotion::ALL
        .into_iter()
        .map(|motion| named(&format!("a \"{}\" one", motion.name()), LoopKind::Joint { ends, motion }))
        .collect();
    loops.push(named("point", LoopKind::Point { ends: [end(Some(5)), end(Some(1))], axes: [true, false, true] }));
    loops.push(named("rod", LoopKind::Distance { ends, length: 0.1 + 0.7 }));
    loops.push(named("gear", LoopKind::Gear { terms: vec![(0, 1.0), (2, -1.0 / 3.0), (4, 1e-12)], offset: -0.0 }));
    loops.push(named("mimic", LoopKind::Mimic { follower: 1, leader: 4, polynomial: [0.1, -1.0, 1.0 / 3.0, 0.0, 5e-324] }));
    loops
}

#[test]
fn every_kind_round_trips_in_the_neutral_format() {
    for tie in every_loop() {
        assert_round_trip(&Description { loops: vec![tie], ..chain(6) });
    }
    assert_round_trip(&Description { loops: every_loop(), ..chain(6) });
}

/// So content hashes, and what oracles get, are those of the tree. A file without loops has no such section.
#[test]
fn the_line_for_oracles_is_that_of_the_tree() {
    let (tree, tied) = (chain(6), Description { loops: every_loop(), ..chain(6) });
    assert_eq!(neutral::to_line(&tied), neutral::to_line(&tree));
    assert!(!neutral::to_string(&tree).unwrap().contains("loops"));
    let empty = neutral::to_string(&tree).unwrap().replacen("\"bodies\"", "\"loops\":[],\n \"bodies\"", 1);
    assert_eq!(neutral::parse(&empty, "f.json").unwrap(), tree);
}

const GOOD: &str = r#"{"format":1,"name":"r","gravity":[0,0,-9.81],
 "bodies":[
  {"name":"a","mass":1,"com":[0,0,0],"inertia":[1,0,0,1,0,1],"parent":-1,"joint":{"name":"h","type":"revolute","axis":[0,1,0],"placement":P}},
  {"name":"b","mass":1,"com":[0,0,0],"inertia":[1,0,0,1,0,1],"parent":0,"joint":{"name":"k","type":"spherical","placement":P}},
  {"name":"c","mass":1,"com":[0,0,0],"inertia":[1,0,0,1,0,1],"parent":0,"joint":{"name":"l","type":"prismatic","axis":[0,1,0],"placement":P}}
 ],
 "loops":[
  {"name":"pin","type":"revolute","first":{"body":-1,"placement":P},"second":{"body":1,"placement":P}},
  {"name":"held","type":"point","first":{"body":0,"placement":P},"second":{"body":1,"placement":P},"axes":[true,true,false]},
  {"name":"rod","type":"distance","first":{"body":0,"placement":P},"second":{"body":1,"placement":P},"length":1.5},
  {"name":"gear","type":"gear","terms":[{"body":0,"coefficient":1},{"body":2,"coefficient":2}],"offset":0},
  {"name":"finger","type":"mimic","follower":2,"leader":0,"polynomial":[0,1,0,0,0]}
 ]}"#;

#[test]
fn bad_loops_are_named_by_file_field_and_index() {
    let good = placed(GOOD);
    assert_eq!(neutral::parse(&good, "good.json").unwrap().loops.len(), 5);
    let changes: &[Change<'_>] = &[
        (r#""name":"pin","#, "", &["field 'loops[0]'", "missing field `name`"]),
        (
            r#""type":"mimic""#,
            r#""type":"tendon""#,
            &["field 'loops[4]'", "loop 'finger' has the unknown type 'tendon'; choose one of fixed"],
        ),
        (r#""type":"mimic","#, "", &["field 'loops[4]'", "missing field `type`"]),
        (r#","length":1.5"#, "", &["field 'loops[2]'", "distance loop 'rod' has no 'length'; it needs first, second, length"]),
        (r#","axes":[true,true,false]"#, "", &["field 'loops[1]'", "point loop 'held' has no 'axes'"]),
        ("[true,true,false]", "[true,true]", &["loops[1].axes", "invalid length 2"]),
        ("[true,true,false]", "[1,1,0]", &["loops[1].axes", "expected a boolean"]),
        ("\"length\":1.5", "\"length\":-1.5", &["f.json:10:11: loops[2] 'rod': length is -1.5 m"]),
        ("\"length\":1.5", "\"length\":NaN", &["not valid JSON"]),
        ("\"length\":1.5", "\"length\":1e999", &["out of range"]),
        ("\"length\":1.5", "\"length\":1.5,\"stiffness\":1", &["loops[2].stiffness", "unknown field `stiffness`"]),
        ("\"length\":1.5", "\"length\":1.5,\"offset\":1", &["distance loop 'rod' has 'offset', which such a loop has not"]),
        (r#""first":{"body":-1"#, r#""first":{"body":-2"#, &["loops[0].first.body", "-2 is no body; the world is -1"]),
        (r#""type":"revolute","first":"#, r#""type":"revolute","start":"#, &["loops[0].start", "unknown field `start`"]),
        (r#""follower":2"#, r#""follower":-1"#, &["loops[4].follower", "expected usize"]),
        (r#""leader":0,"#, "", &["mimic loop 'finger' has no 'leader'"]),
        ("[0,1,0,0,0]", "[0,1]", &["loops[4].polynomial", "invalid length 2"]),
        (r#"{"body":2,"coefficient":2}"#, r#"{"body":2}"#, &["loops[3].terms[1]", "missing field `coefficient`"]),
    ];
    assert_named(&good, changes, refused);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2048 / one_of(4) as u32, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// A file with bytes changed, removed or doubled in its loops is read or gives an error, never a panic; what is read is written.
    #[test]
    fn mutated_loops_never_panic(edits in edits(4)) {
        let good = placed(GOOD);
        let (bodies, loops) = good.split_at(good.find("\"loops\"").unwrap());
        let text = bodies.to_owned() + &edited(loops, edits, usize::MAX);
        match neutral::parse(&text, "mutated.json") {
            Ok(robot) => assert_round_trip(&robot),
            Err(error) => prop_assert!(error.to_string().starts_with("mutated.json")),
        }
    }
}

/// A rail carries a slider, and a finger follows it.
fn gripper(mimic: &str, finger: &str) -> String {
    let link = |name: &str| {
        format!(
            r#"<link name="{name}"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>"#
        )
    };
    let joint = |name: &str, kind: &str, parent: &str, child: &str, more: &str| {
        format!(r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 0 1"/>{more}</joint>"#)
    };
    let links = ["base", "palm", "slider", "finger"].map(link).concat();
    let (palm, slide) = (joint("palm_joint", "fixed", "base", "palm", ""), joint("slide", "continuous", "palm", "slider", ""));
    format!("<robot name=\"gripper\">{links}\n{}\n{palm}\n{slide}\n</robot>", joint("grip", finger, "palm", "finger", mimic))
}

/// The joint stays a joint of the tree, and a loop of its name ties it. The tree, its order and its numbers are those of independent mimics.
#[test]
fn a_urdf_mimic_is_a_loop() {
    let text = gripper(r#"<mimic joint="slide" multiplier="-0.5" offset="0.25"/>"#, "continuous");
    let (robot, notes) = urdf::import(&text, "g.urdf", &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(notes, [], "nothing was left out");
    let polynomial = [0.25, -0.5, 0.0, 0.0, 0.0];
    assert_eq!(robot.loops, [named("grip", LoopKind::Mimic { follower: 0, leader: 1, polynomial })]);
    let free = Options { independent_mimics: true, ..Options::default() };
    let (independent, notes) = urdf::import(&text, "g.urdf", &free).unwrap();
    assert_eq!(independent, Description { loops: Vec::new(), ..robot.clone() });
    assert!(notes[0].text.contains("is read as a joint of its own"));

    // Again as URDF: the same text from then on.
    let (written, losses) = urdf::to_string(&robot, OnLoss::Refuse).unwrap();
    assert_eq!(losses, []);
    let (again, _) = urdf::import(&written, "again.urdf", &Options::default()).unwrap();
    assert_eq!(again.loops, robot.loops);
    assert_eq!(urdf::to_string(&again, OnLoss::Refuse).unwrap().0, written);
    // Without numbers it follows one to one.
    let (robot, _) = urdf::import(&gripper(r#"<mimic joint="slide"/>"#, "continuous"), "g.urdf", &Options::default()).unwrap();
    assert!(matches!(robot.loops[0].kind, LoopKind::Mimic { polynomial: [0.0, 1.0, 0.0, 0.0, 0.0], .. }));
}

#[test]
fn a_mimic_that_cannot_follow_is_refused_by_name() {
    let slide = r#"<mimic joint="slide"/>"#;
    for (mimic, finger, part) in [
        (r#"<mimic joint="nowhere"/>"#, "continuous", "joint 'grip' mimics joint 'nowhere', which is not there"),
        (r#"<mimic joint="grip"/>"#, "continuous", "which is itself"),
        (r#"<mimic joint="palm_joint"/>"#, "continuous", "which has not one degree of freedom"),
        (slide, "fixed", "and has not one degree of freedom itself"),
        (slide, "planar", "and has not one degree of freedom itself"),
        (r#"<mimic joint="slide" multiplier="twice"/>"#, "continuous", "twice"),
        (r#"<mimic joint="slide" offset="nan"/>"#, "continuous", "nan"),
    ] {
        let text = gripper(mimic, finger);
        let error = urdf::import(&text, "g.urdf", &Options::default()).expect_err(part).to_string();
        assert!(error.starts_with("g.urdf:2:") && error.contains(part), "{error}\n  lacks {part}");
        let free = Options { independent_mimics: true, ..Options::default() };
        assert!(urdf::import(&text, "g.urdf", &free).is_ok(), "{mimic}: as an independent joint it is read as before");
    }
}

/// Joints that follow each other in a circle are tied; the note says that nothing drives them.
#[test]
fn a_circle_of_mimics_is_read_with_a_note() {
    let text = gripper(r#"<mimic joint="slide"/>"#, "continuous");
    let text = text.replace(r#"<child link="slider"/>"#, r#"<child link="slider"/><mimic joint="grip"/>"#);
    let (robot, notes) = urdf::import(&text, "g.urdf", &Options::default()).unwrap();
    assert_eq!(robot.loops.len(), 2);
    assert!(notes.iter().any(|note| note.text.contains("in a circle")), "{notes:?}");
}

#[test]
fn what_a_format_has_no_place_for_is_a_loss_by_name() {
    let robot = Description { loops: every_loop(), ..chain(6) };
    let lost = |result: Result<(String, Vec<featherbench_formats::Loss>), ExportError>| {
        let (_, losses) = result.unwrap_or_else(|error| panic!("{error}"));
        let of_loops = losses.into_iter().filter(|loss| matches!(loss.reason, Reason::Loop { .. }));
        of_loops.map(|loss| loss.about).collect::<Vec<_>>()
    };
    let all: Vec<String> = every_loop().iter().enumerate().map(|(k, tie)| format!("loops[{k}] '{}'", tie.name)).collect();
    assert_eq!(lost(urdf::to_string(&robot, OnLoss::LeaveOut)), all, "of fourth degree, the mimic is none of URDF");
    // Fixed, spherical, and the mimic are MJCF's.
    let held = [0, 4, 9];
    let without: Vec<String> = all.iter().enumerate().filter(|(k, _)| !held.contains(k)).map(|(_, name)| name.clone()).collect();
    assert_eq!(lost(mjcf::to_string(&robot, OnLoss::LeaveOut)), without);
    for refused in [urdf::to_string(&robot, OnLoss::Refuse), mjcf::to_string(&robot, OnLoss::Refuse)] {
        let error = refused.expect_err("a loss");
        assert!(error.can_be_left_out() && error.to_string().contains("a loop of type distance"), "{error}");
    }
}

/// A connect, a weld and a joint, on sites of their own. MuJoCo reads them back in the tests of the command.
#[test]
fn mjcf_has_equality_constraints() {
    let loops: Vec<Loop> = every_loop().into_iter().filter(|tie| ["fixed", "spherical", "mimic"].contains(&tie.kind.name())).collect();
    let robot = Description { loops, ..chain(6) };
    let (text, _) = mjcf::to_string(&robot, OnLoss::LeaveOut).unwrap();
    for line in [
        r#"<site name="a &quot;fixed&quot; one first" pos="0.30000000000000004 -0.0 1e-300" quat="-0.5 0.5 0.5 0.5"/>"#,
        r#"<weld name="a &quot;fixed&quot; one" site1="a &quot;fixed&quot; one first" site2="a &quot;fixed&quot; one second"/>"#,
        r#"<connect name="a &quot;spherical&quot; one" "#,
        r#"polycoef="0.1 -1.0 0.3333333333333333 0.0 5e-324"/>"#,
    ] {
        assert!(text.contains(line), "{text}\n  lacks {line}");
    }
    assert!(text.find("</worldbody>") < text.find("<equality>"));
    let (tree, _) = mjcf::to_string(&Description { loops: Vec::new(), ..robot }, OnLoss::LeaveOut).unwrap();
    assert!(!tree.contains("equality") && !tree.contains("site"));
}
