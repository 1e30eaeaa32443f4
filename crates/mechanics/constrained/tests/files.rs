//! Robots with loops from files: the four-bar of `systems` out of JSON and URDF.

use crate::common::assert_within;
use featherbench_constrained::systems::{Biped, Bricard, Ladder, Squeezer};
use featherbench_constrained::{Attachment, BadMechanism, Constrained, Kkt, Law, LoopMotion, Mechanism, Mobility};
use featherbench_formats::{neutral, urdf};
use featherbench_model::{Description, Loop, LoopEnd, LoopKind, Placement};
use featherbench_robots::{Family, Random};
use featherbench_spatial::largest;

/// The largest error against the closed form, at random states on the loop.
fn assert_moves_as(ladder: &Ladder, mechanism: &Mechanism, what: &str) {
    let random = &mut Random::new(11, 2);
    let mut cases = 0;
    for _ in 0..10 {
        let (theta, rate) = (random.uniform(-1.2, 1.2), random.uniform(-2.0, 2.0));
        let (q, v) = (ladder.spread(theta), ladder.spread(rate));
        let due = ladder.spread(ladder.acceleration(theta));
        let mut dynamics = Constrained::new(&mechanism.model, &mechanism.constraints).unwrap();
        let found = dynamics.run(&q, &v, &vec![0.0; v.len()], &Kkt::default()).unwrap().acceleration;
        // The bars' moments differ by some 10 N·m, and the worst angle divides by cos 1.2.
        assert_within(&format!("θ̈ of {what}"), largest(found.iter().zip(&due).map(|(a, due)| a - due)), 1e-11 * (1.0 + rate * rate));
        cases += 1;
    }
    assert_eq!(cases, 10);
}

/// The description is written, read, and moves as the closed form says.
#[test]
fn a_four_bar_in_json_moves_as_the_closed_form() {
    for ladder in [Ladder::default(), Ladder { windows: 3, crank: 0.7, coupler: 1.3, crank_mass: 2.0, ..Ladder::default() }] {
        let text = neutral::to_string(&ladder.description()).unwrap();
        let read = neutral::parse(&text, "four-bar.json").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(read, ladder.description());
        let mechanism = Mechanism::of(&read).unwrap();
        assert_eq!((mechanism.graph.loops(), mechanism.graph.gruebler(3)), (ladder.windows, 1));
        assert_eq!(mechanism.constraints, ladder.mechanism().unwrap().constraints);
        let mobility = Mobility::at(&mechanism.model, &mechanism.constraints, &ladder.spread(0.5)).unwrap();
        assert_eq!(mobility.freedom(), 1);
        assert_moves_as(&ladder, &mechanism, "a ladder in JSON");
    }
}

/// In URDF a parallelogram is two mimics: the coupler turns back by what its crank turns, and the other crank turns as far.
#[test]
fn a_four_bar_of_urdf_mimics_moves_as_the_closed_form() {
    let ladder = Ladder::default();
    // Uniform rods of 1 kg and 1 m: 1/12 kg·m² about the centre, and nothing about their own axis.
    let link = |name: &str, com: &str, inertia: [&str; 3]| {
        let [ixx, iyy, izz] = inertia;
        format!(
            r#"<link name="{name}"><inertial><origin xyz="{com}"/><mass value="1"/>
            <inertia ixx="{ixx}" ixy="0" ixz="0" iyy="{iyy}" iyz="0" izz="{izz}"/></inertial></link>"#
        )
    };
    let joint = |name: &str, parent: &str, child: &str, place: &str, more: &str| {
        format!(
            r#"<joint name="{name}" type="continuous"><origin xyz="{place}"/><parent link="{parent}"/><child link="{child}"/>
            <axis xyz="0 1 0"/>{more}</joint>"#
        )
    };
    let (twelfth, hangs, lies) = ("0.08333333333333333", "0 0 -0.5", "0.5 0 0");
    let text = [
        r#"<robot name="four_bar"><link name="ground"/>"#.to_owned(),
        link("crank0", hangs, [twelfth, twelfth, "0"]),
        link("coupler", lies, ["0", twelfth, twelfth]),
        link("crank1", hangs, [twelfth, twelfth, "0"]),
        joint("a", "ground", "crank0", "0 0 0", ""),
        joint("b", "crank0", "coupler", "0 0 -1", r#"<mimic joint="a" multiplier="-1"/>"#),
        joint("c", "ground", "crank1", "1 0 0", r#"<mimic joint="a"/>"#),
        "</robot>".to_owned(),
    ];
    let (robot, _) = urdf::import(&text.concat(), "four_bar.urdf", &urdf::Options::default()).unwrap_or_else(|error| panic!("{error}"));
    let mechanism = Mechanism::of(&robot).unwrap();
    assert_eq!((mechanism.graph.loops(), mechanism.constraints.rows()), (0, 2), "a gear is no joint between links");
    assert_moves_as(&ladder, &mechanism, "a four-bar of mimics");

    // As independent joints, as in comparisons, it is a tree: a double pendulum beside another one.
    let free = urdf::Options { independent_mimics: true, ..urdf::Options::default() };
    let (tree, _) = urdf::import(&text.concat(), "four_bar.urdf", &free).unwrap();
    assert!(Mechanism::of(&tree).unwrap().constraints.list().is_empty());
}

/// Every kind of a description's loops becomes the constraint of its numbers, on the bodies and dofs of the model.
#[test]
fn every_kind_becomes_its_constraint() {
    let mut robot = Family::parse("joints:kind=all,base=free").unwrap().generate().unwrap();
    let hinges: Vec<usize> = (0..robot.bodies.len()).filter(|&body| robot.bodies[body].joint.kind.nv() == 1).collect();
    let placement = Placement { rotation: [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0], translation: [0.1, 0.2, 0.3] };
    let ends = [LoopEnd::default(), LoopEnd { body: Some(4), placement }];
    let polynomial = [0.1, 0.2, 0.3, 0.4, 0.5];
    let kinds = [
        LoopKind::Point { ends, axes: [true, false, true] },
        LoopKind::Joint { ends, motion: LoopMotion::Planar },
        LoopKind::Distance { ends, length: 0.5 },
        LoopKind::Gear { terms: vec![(hinges[0], 2.0), (hinges[2], -1.0)], offset: 0.5 },
        LoopKind::Mimic { follower: hinges[1], leader: hinges[0], polynomial },
    ];
    robot.loops = kinds.into_iter().enumerate().map(|(k, kind)| Loop { name: format!("tie {k}"), kind }).collect();
    let Mechanism { graph, model, constraints } = Mechanism::of(&robot).unwrap();
    let names: Vec<&str> = constraints.list().iter().map(|constraint| constraint.name.as_str()).collect();
    assert_eq!(names, ["tie 1", "tie 0", "tie 2", "tie 3", "tie 4"], "joints come first");
    assert_eq!(graph.loops(), 1);
    let first = Attachment::world([0.0; 3]);
    let second = Attachment { body: Some(model.described[4]), placement: placement.to_transform() };
    let dof = |body: usize| robot.bodies[..body].iter().map(|body| body.joint.kind.nv()).sum::<usize>();
    let due = [
        Law::Joint { first, second, motion: LoopMotion::Planar },
        Law::Point { first, second, axes: [true, false, true] },
        Law::Distance { first, second, length: 0.5 },
        Law::Gear { terms: vec![(dof(hinges[0]), 2.0), (dof(hinges[2]), -1.0)], offset: 0.5 },
        Law::Mimic { follower: dof(hinges[1]), leader: dof(hinges[0]), polynomial },
    ];
    assert_eq!(constraints.list().iter().map(|constraint| &constraint.law).collect::<Vec<_>>(), due.iter().collect::<Vec<_>>());
}

#[test]
fn bad_loops_are_refused_by_name() {
    // A loop joint of the name of a joint of the tree.
    let mut robot = Ladder::default().description();
    robot.loops[0].name = robot.bodies[0].name.clone();
    let found = Mechanism::of(&robot).unwrap_err();
    assert!(matches!(found, BadMechanism::Graph(featherbench_constrained::BadGraph::DuplicateName { .. })), "{found}");
    // A loop that the description itself refuses.
    robot.loops[0].kind = LoopKind::Distance { ends: [LoopEnd::default(); 2], length: 1.0 };
    let found = Mechanism::of(&robot).unwrap_err();
    assert!(matches!(found, BadMechanism::Tree(_)) && found.to_string().contains("loops[0]"), "{found}");
    assert!(Mechanism::of(&Description::default()).is_err());
}

/// The line that an engine is asked with has the loops, and the one of a tree has none.
#[test]
fn lines_have_loops_where_they_are_asked_for() {
    let robots = [
        Ladder::default().description(),
        Bricard::default().description(),
        Squeezer::default().description(),
        Biped::default().description(),
    ];
    for robot in robots {
        let line = neutral::to_line_with_loops(&robot).unwrap();
        assert!(!line.contains('\n'));
        assert_eq!(neutral::parse(&line, "a line").unwrap().loops, robot.canonical().unwrap().loops, "{}", robot.name);
        assert!(neutral::parse(&neutral::to_line(&robot).unwrap(), "a line").unwrap().loops.is_empty());
    }
}
