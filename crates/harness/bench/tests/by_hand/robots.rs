//! Three robots with round numbers, each at one state.

use featherbench_bench::Robot;
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Placement};
use featherbench_results::ModelOrigin;

/// A quarter turn about x, row by row: the child's y is the parent's z.
const QUARTER_TURN: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0];
/// Gravity of length 5 m/s².
const GRAVITY: [f64; 3] = [0.0, 3.0, -4.0];

/// A state: q, v, a, τ and the wrenches [moment; force] of each body.
struct State {
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    tau: Vec<f64>,
    wrench: Vec<f64>,
}

fn body(parent: Option<usize>, kind: JointType, translation: [f64; 3], mass: f64, com: [f64; 3], inertia: [f64; 6]) -> BodyDescription {
    let placement = Placement { translation, ..Placement::default() };
    let name = parent.map_or("first", |_| "second");
    let joint = JointDescription { name: format!("{name} joint"), kind, placement, ..JointDescription::default() };
    BodyDescription { name: name.into(), parent, mass, com, inertia, joint }
}

fn robot(gravity: [f64; 3], bodies: Vec<BodyDescription>, state: State) -> Robot {
    let description = Description { name: "by hand".into(), gravity, bodies, ..Description::default() };
    let mut robot = Robot::new(&description, "test", ModelOrigin::Generated, 1, 1).unwrap();
    let State { q, v, a, tau, wrench } = state;
    let states = &mut robot.states;
    (states.q, states.v, states.a, states.tau, states.wrench) = (q, v, a, tau, wrench);
    states.check(&robot.model).unwrap();
    assert_eq!(robot.states.count(), 1);
    robot
}

/// Two helical joints, with armature, inertia products, a rotated placement and wrenches.
///
/// | | first | second |
/// |---|---|---|
/// | placement | (0, 3, 4) m, length 5 | (1, 2, 2) m, length 3, turned |
/// | axis, pitch | z, 0.5 m/rad | u = (0, 0.6, 0.8), 0.25 m/rad |
/// | q, v, a | 1, 3, −2 | 2, −2, 4 |
/// | mass, centre of mass | 2 kg, 0.75 m | 4 kg, 0.5 m |
/// | first moment | 1.5 kg·m | 2 kg·m |
/// | inertia about the origin | xx 1, yy 2.5, zz 2.5, xy 0.1, xz 0.2, yz 0.3 | xx 2, yy 2, zz 1 |
/// | its Frobenius norm | √(1 + 6.25 + 6.25 + 2·(0.01 + 0.04 + 0.09)) = √13.78 | 3 |
/// | wrench | moment 7, force 9 | moment 11, force 5 |
/// | armature | 0.7 | 0.3 |
pub fn two_screws() -> Robot {
    // About the centre of mass: less m·c² = 1.125 in yy and zz of the first, less 1 in xx and yy of the second.
    let first = JointType::Helical { axis: [0.0, 0.0, 1.0], pitch: 0.5 };
    let mut first = body(None, first, [0.0, 3.0, 4.0], 2.0, [0.75, 0.0, 0.0], [1.0, 0.1, 0.2, 1.375, 0.3, 1.375]);
    first.joint.armature = vec![0.7];
    let second = JointType::Helical { axis: [0.0, 0.6, 0.8], pitch: 0.25 };
    let mut second = body(Some(0), second, [1.0, 2.0, 2.0], 4.0, [0.0, 0.0, 0.5], [1.0, 0.0, 0.0, 1.0, 0.0, 1.0]);
    second.joint.placement.rotation = QUARTER_TURN;
    second.joint.armature = vec![0.3];
    let state = State {
        q: vec![1.0, 2.0],
        v: vec![3.0, -2.0],
        a: vec![-2.0, 4.0],
        tau: vec![1.0, -1.0],
        wrench: vec![2.0, 3.0, 6.0, 1.0, -4.0, 8.0, 2.0, -6.0, 9.0, 0.0, -3.0, 4.0],
    };
    robot(GRAVITY, vec![first, second], state)
}

/// A free body that carries another on a spherical joint.
///
/// | | first | second |
/// |---|---|---|
/// | placement | (0, 0, 2) m | (0, 0.5, 0) m |
/// | position | (2, 1, 2) m, length 3 | |
/// | v | linear (0, 0, 2), angular (0, 3, 0) | (0, 0, 4) |
/// | a | linear (1, 0, 0), angular (0, 0, 0.5) | (0, 6, 0) |
/// | mass, centre of mass | 3 kg, at the origin | 2 kg, 1.5 m |
/// | inertia about the origin | xx 2, yy 2, zz 1: norm 3 | xx 1, yy 5, zz 5: norm √51 |
/// | armature | – | 0.1, 0.2, 0.3 |
pub fn free_and_spherical() -> Robot {
    let first = body(None, JointType::Free, [0.0, 0.0, 2.0], 3.0, [0.0; 3], [2.0, 0.0, 0.0, 2.0, 0.0, 1.0]);
    let mut second = body(Some(0), JointType::Spherical, [0.0, 0.5, 0.0], 2.0, [1.5, 0.0, 0.0], [1.0, 0.0, 0.0, 0.5, 0.0, 0.5]);
    second.joint.armature = vec![0.1, 0.2, 0.3];
    let state = State {
        q: vec![2.0, 1.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        v: vec![0.0, 0.0, 2.0, 0.0, 3.0, 0.0, 0.0, 0.0, 4.0],
        a: vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 6.0, 0.0],
        tau: vec![0.0; 9],
        wrench: vec![0.0; 12],
    };
    robot(GRAVITY, vec![first, second], state)
}

/// Two slides along x, 5 kg and `tip` kg, in gravity (−1.5, 0, −2) of length 2.5 m/s², at rest at q = 0.
///
/// With a tip of 4 kg: M = [9 4; 4 4], h = 1.5·(9, 4) = (13.5, 6), and τ = (19.5, 2) gives a = (2, −3), as M a = (6, −4).
pub fn two_slides(tip: f64) -> Robot {
    let slide = JointType::Prismatic { axis: [1.0, 0.0, 0.0] };
    let ball = |mass: f64| [mass, 0.0, 0.0, mass, 0.0, mass];
    let bodies = vec![body(None, slide, [0.0; 3], 5.0, [0.0; 3], ball(5.0)), body(Some(0), slide, [0.0; 3], tip, [0.0; 3], ball(tip))];
    let state = State { q: vec![0.0; 2], v: vec![0.0; 2], a: vec![0.0; 2], tau: vec![19.5, 2.0], wrench: vec![0.0; 12] };
    robot([-1.5, 0.0, -2.0], bodies, state)
}
