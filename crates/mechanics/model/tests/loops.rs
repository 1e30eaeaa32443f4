//! Loops of descriptions: what fixed bodies do to them, and what is refused.

use featherbench_model::{
    BodyDescription, Description, JointDescription, JointType, Loop, LoopDefect, LoopEnd, LoopKind, LoopMotion, Malformed, Model,
    Placement, Warning,
};

const Z: [f64; 3] = [0.0, 0.0, 1.0];

pub fn body(name: &str, parent: Option<usize>, kind: JointType, translation: [f64; 3]) -> BodyDescription {
    // A quarter turn about z: x of the child is y of the parent.
    let rotation = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let joint =
        JointDescription { name: format!("{name} joint"), kind, placement: Placement { rotation, translation }, ..Default::default() };
    BodyDescription { name: name.into(), parent, mass: 1.0, com: [0.0; 3], inertia: [0.1, 0.0, 0.0, 0.1, 0.0, 0.1], joint }
}

/// A plate is fixed to an arm, a bracket to the world; the arm comes last in the file.
fn robot(kind: LoopKind) -> Description {
    let bodies = vec![
        body("plate", Some(3), JointType::Fixed, [1.0, 0.0, 0.0]),
        body("bracket", None, JointType::Fixed, [0.0, 2.0, 0.0]),
        body("ball", Some(3), JointType::Spherical, [0.0, 0.0, 1.0]),
        body("arm", None, JointType::Revolute { axis: Z }, [0.0; 3]),
        body("slide", None, JointType::Prismatic { axis: Z }, [0.0; 3]),
    ];
    Description { name: "robot".into(), bodies, loops: vec![Loop { name: "tie".into(), kind }], ..Description::default() }
}

fn on(body: Option<usize>, translation: [f64; 3]) -> LoopEnd {
    LoopEnd { body, placement: Placement { translation, ..Placement::default() } }
}

fn joint(first: LoopEnd, second: LoopEnd) -> LoopKind {
    LoopKind::Joint { ends: [first, second], motion: LoopMotion::Revolute }
}

#[test]
fn ends_on_fixed_bodies_are_on_what_carries_them() {
    let given = robot(joint(on(Some(1), [0.5, 0.0, 0.0]), on(Some(0), [0.0, 0.25, 0.0])));
    let canonical = given.canonical().unwrap();
    assert_eq!(canonical.bodies.iter().map(|body| body.name.as_str()).collect::<Vec<_>>(), ["arm", "ball", "slide"]);
    let [first, second] = canonical.loops[0].ends().unwrap();
    // (0, 2, 0) and half a metre along the bracket's x, which is the world's y. (1, 0, 0) and a quarter along the plate's y: −x.
    assert_eq!((first.body, first.placement.translation), (None, [0.0, 2.5, 0.0]));
    assert_eq!((second.body, second.placement.translation), (Some(0), [0.75, 0.0, 0.0]));
    assert_eq!(second.placement.rotation, given.bodies[0].joint.placement.rotation);
    assert_eq!(canonical.canonical().as_ref(), Ok(&canonical), "a canonical description is its own canonical form");
}

#[test]
fn coordinates_follow_their_bodies() {
    let canonical = robot(LoopKind::Mimic { follower: 4, leader: 3, polynomial: [0.0; 5] }).canonical().unwrap();
    assert!(matches!(canonical.loops[0].kind, LoopKind::Mimic { follower: 2, leader: 0, .. }));
    let canonical = robot(LoopKind::Gear { terms: vec![(3, 1.0), (4, -2.0)], offset: 0.5 }).canonical().unwrap();
    assert_eq!(canonical.loops[0].kind, LoopKind::Gear { terms: vec![(0, 1.0), (2, -2.0)], offset: 0.5 });
}

/// The model is that of the tree, and says so.
#[test]
fn a_model_leaves_loops_out_with_a_warning() {
    let tied = robot(LoopKind::Mimic { follower: 4, leader: 3, polynomial: [0.0; 5] });
    let warning = Warning::Loops { names: vec!["tie".into()] };
    let model: Model<f64> = Model::build(&tied).unwrap();
    let tree: Model<f64> = Model::build(&Description { loops: Vec::new(), ..tied.clone() }).unwrap();
    assert_eq!(model.warnings.iter().filter(|found| **found == warning).count(), 1);
    assert!(!tree.warnings.contains(&warning));
    assert_eq!((model.topology, model.placements), (tree.topology, tree.placements));
}

#[test]
fn malformed_loops_are_refused_by_name_and_index() {
    let (world, arm, plate, slide) = (on(None, [0.0; 3]), on(Some(3), [0.0; 3]), on(Some(0), [0.0; 3]), on(Some(4), [0.0; 3]));
    let mirror = Placement { rotation: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0], ..Placement::default() };
    let mimic = |follower, leader, offset| LoopKind::Mimic { follower, leader, polynomial: [offset, 1.0, 0.0, 0.0, 0.0] };
    let gear = |terms: &[(usize, f64)], offset| LoopKind::Gear { terms: terms.to_vec(), offset };
    let distance = |length| LoopKind::Distance { ends: [world, arm], length };
    let cases: Vec<(LoopKind, &str)> = vec![
        (joint(world, on(Some(9), [0.0; 3])), "second: body 9 does not exist (there are 5 bodies"),
        (joint(world, on(Some(3), [0.0, f64::NAN, 0.0])), "placement.translation is NaN"),
        (joint(LoopEnd { placement: mirror, ..world }, arm), "first: its rotation misses orthonormality"),
        (joint(world, world), "both ends are on one body"),
        (joint(arm, plate), "both ends are on one body (or on bodies fixed to each other)"),
        (LoopKind::Point { ends: [world, arm], axes: [false; 3] }, "axes: the point is held along no axis"),
        (distance(0.0), "length is 0 m"),
        (distance(-1.0), "length is -1 m"),
        (distance(f64::INFINITY), "length is inf"),
        (gear(&[(3, 1.0)], 0.0), "terms: there are 1"),
        (gear(&[(3, 1.0), (4, 0.0)], 0.0), "terms: the coefficient of body 4 is zero"),
        (gear(&[(3, 1.0), (3, 1.0)], 0.0), "terms: the joint of body 3 is named twice"),
        (gear(&[(3, 1.0), (2, 1.0)], 0.0), "terms: the joint of body 2 is spherical"),
        (gear(&[(3, 1.0), (4, f64::NAN)], 0.0), "coefficient is NaN"),
        (gear(&[(3, 1.0), (4, 1.0)], f64::NAN), "offset is NaN"),
        (mimic(4, 4, 0.0), "leader: the joint of body 4 is named twice"),
        (mimic(0, 4, 0.0), "follower: the joint of body 0 is fixed"),
        (mimic(4, 7, 0.0), "leader: body 7 does not exist"),
        (mimic(4, 3, f64::NEG_INFINITY), "polynomial is -inf"),
    ];
    for (kind, part) in cases {
        let mut robot = robot(joint(world, slide));
        robot.loops.push(Loop { name: "bad".into(), kind });
        let error = robot.canonical().expect_err(part);
        let text = error.to_string();
        assert!(text.starts_with("loops[1] 'bad': ") && text.contains(part), "{text}\n  lacks {part}");
        assert_eq!(error.about(), Some("bad"));
    }
    let mut twice = robot(joint(world, slide));
    twice.loops.push(twice.loops[0].clone());
    let due = Malformed::Loop { name: "tie".into(), index: 1, defect: LoopDefect::DuplicateName };
    assert_eq!(twice.validate(), Err(due));
}

#[test]
fn motions_leave_what_they_do_not_hold() {
    let freedoms = LoopMotion::ALL.map(|motion| (motion.name(), motion.freedom()));
    assert_eq!(freedoms, [("fixed", 0), ("revolute", 1), ("prismatic", 1), ("cylindrical", 2), ("spherical", 3), ("planar", 3)]);
}
