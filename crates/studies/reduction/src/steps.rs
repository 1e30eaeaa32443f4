//! The steps that make a case simpler, the largest first.

use super::{JointState, Step, Subject, neutral, subtree};
use featherbench_model::{BodyDescription, JointDescription, JointType, Placement};
use featherbench_robots::{Case as StateCase, Random};
use std::f64::consts::PI;

/// The numbers of significant digits that are tried, the fewest first.
const DIGITS: [i32; 3] = [1, 2, 4];
/// Configurations that are drawn for each smaller robot.
const DRAWS: u64 = 50;
/// The axes of joints that are tried.
const AXES: [[f64; 3]; 3] = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
/// The diagonal of a tensor (xx, xy, xz, yy, yz, zz).
const DIAGONAL: [usize; 3] = [0, 3, 5];

/// A subtree less.
pub fn fewer_bodies(case: &Subject) -> Vec<Step> {
    let of = |root: usize| -> Step { Box::new(move |case| cut(case, root)) };
    (0..case.description.bodies.len()).map(of).collect()
}

fn cut(case: &mut Subject, root: usize) {
    let gone = subtree(&case.description.bodies, root);
    let count = gone.len();
    case.description.bodies.drain(gone.clone());
    for body in &mut case.description.bodies {
        body.parent = body.parent.map(|parent| if parent >= gone.end { parent - count } else { parent });
    }
}

/// A subtree less, or a joint, at another configuration: an error that is barely beyond its bound is so at few of them.
pub fn fewer_bodies_elsewhere(case: &Subject) -> Vec<Step> {
    // The others are what they are by their configuration.
    if !matches!(case.kind, StateCase::Random | StateCase::Fast) {
        return Vec::new();
    }
    let acts: [fn(&mut Subject, usize); 2] = [cut, |case, at| weld(&mut case.description.bodies, at)];
    let mut steps: Vec<Step> = Vec::new();
    for root in 0..case.description.bodies.len() {
        for (act, draw) in acts.into_iter().flat_map(|act| (0..DRAWS).map(move |draw| (act, draw))) {
            steps.push(Box::new(move |case| {
                act(case, root);
                let mut random = Random::named(draw, "reduced");
                each_joint(case, None, |state, kind| {
                    if !matches!(kind, JointType::Spherical | JointType::Free) {
                        state.q.iter_mut().for_each(|q| *q = random.uniform(-PI, PI));
                    }
                });
            }));
        }
    }
    steps
}

/// A joint less: its body becomes a part of its parent, or of the world.
pub fn fewer_joints(case: &Subject) -> Vec<Step> {
    let of = |at: usize| -> Step { Box::new(move |case| weld(&mut case.description.bodies, at)) };
    (0..case.description.bodies.len()).map(of).collect()
}

fn weld(bodies: &mut [BodyDescription], at: usize) {
    if let Some(body) = bodies.get_mut(at) {
        body.joint = JointDescription { name: body.joint.name.clone(), placement: body.joint.placement, ..JointDescription::default() };
    }
}

/// Coordinates, velocities, accelerations or forces that are zero: of all joints, then of each.
pub fn simpler_state(case: &Subject) -> Vec<Step> {
    let zero: [fn(&mut JointState, JointType); 4] =
        [|at, kind| at.q = neutral(kind), |at, _| at.v.fill(0.0), |at, _| at.a.fill(0.0), |at, _| at.tau.fill(0.0)];
    let mut steps: Vec<Step> = Vec::new();
    for act in zero {
        steps.push(Box::new(move |case| each_joint(case, None, act)));
    }
    for at in 0..case.description.bodies.len() {
        for act in zero {
            steps.push(Box::new(move |case| each_joint(case, Some(at), act)));
        }
    }
    steps
}

/// Acts on the state of all joints, or of one.
fn each_joint(case: &mut Subject, only: Option<usize>, mut act: impl FnMut(&mut JointState, JointType)) {
    for (_, body) in case.description.bodies.iter().enumerate().filter(|(at, _)| only.is_none_or(|only| only == *at)) {
        if let Some(state) = case.state.get_mut(&body.name) {
            act(state, body.joint.kind);
        }
    }
}

/// Bodies and joints without what they need not have: of all, then of each.
pub fn simpler_bodies(case: &Subject) -> Vec<Step> {
    let simpler: [fn(&mut BodyDescription); 9] = [
        |body| {
            let JointDescription { name, kind, placement, armature, .. } = std::mem::take(&mut body.joint);
            body.joint = JointDescription { name, kind, placement, armature, ..JointDescription::default() };
        },
        |body| body.joint.armature.clear(),
        |body| body.com = [0.0; 3],
        |body| body.joint.placement.rotation = Placement::default().rotation,
        |body| body.joint.placement.translation = [0.0; 3],
        |body| {
            let mean = DIAGONAL.iter().map(|&at| body.inertia[at]).sum::<f64>() / 3.0;
            body.inertia = [mean, 0.0, 0.0, mean, 0.0, mean];
        },
        |body| {
            (1..5).filter(|at| !DIAGONAL.contains(at)).for_each(|at| body.inertia[at] = 0.0);
        },
        |body| {
            if let JointType::Revolute { axis } | JointType::Prismatic { axis } | JointType::Helical { axis, .. } = &mut body.joint.kind {
                *axis = [0.0, 0.0, 1.0];
            }
        },
        |body| body.mass = 1.0,
    ];
    let mut steps: Vec<Step> = Vec::new();
    for act in simpler {
        steps.push(Box::new(move |case| case.description.bodies.iter_mut().for_each(act)));
    }
    for at in 0..case.description.bodies.len() {
        for act in simpler {
            steps.push(Box::new(move |case| case.description.bodies.iter_mut().skip(at).take(1).for_each(act)));
        }
        // A joint of one degree of freedom is one that every engine and format has.
        if !matches!(case.description.bodies[at].joint.kind, JointType::Revolute { .. } | JointType::Prismatic { .. }) {
            for axis in AXES {
                for kind in [JointType::Revolute { axis }, JointType::Prismatic { axis }] {
                    steps.push(Box::new(move |case| other_joint(case, at, kind)));
                }
            }
        }
    }
    steps.push(Box::new(|case| case.description.gravity = [0.0; 3]));
    steps.push(Box::new(|case| case.description.gravity = [0.0, 0.0, -10.0]));
    steps
}

/// Another joint of one degree of freedom in place of one; its state is the first numbers of the old one.
fn other_joint(case: &mut Subject, at: usize, kind: JointType) {
    weld(&mut case.description.bodies, at);
    let Some(body) = case.description.bodies.get_mut(at) else { return };
    body.joint.kind = kind;
    if let Some(state) = case.state.get_mut(&body.name) {
        for numbers in [&mut state.q, &mut state.v, &mut state.a, &mut state.tau] {
            numbers.truncate(1);
        }
    }
}

/// Numbers of fewer digits: all, then those of each body, then the state's.
pub fn fewer_digits(case: &Subject) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    for digits in DIGITS {
        steps.push(Box::new(move |case| {
            case.description.bodies.iter_mut().for_each(|body| round_body(body, digits));
            round_all(&mut case.description.gravity, digits);
            each_joint(case, None, |state, kind| round_state(state, kind, digits));
        }));
        steps.push(Box::new(move |case| each_joint(case, None, |state, kind| round_state(state, kind, digits))));
        steps.push(Box::new(move |case| round_all(&mut case.description.gravity, digits)));
        for at in 0..case.description.bodies.len() {
            steps.push(Box::new(move |case| case.description.bodies.iter_mut().skip(at).take(1).for_each(|body| round_body(body, digits))));
            steps.push(Box::new(move |case| each_joint(case, Some(at), |state, kind| round_state(state, kind, digits))));
        }
    }
    steps
}

fn round_body(body: &mut BodyDescription, digits: i32) {
    body.mass = rounded(body.mass, digits);
    round_all(&mut body.com, digits);
    round_all(&mut body.inertia, digits);
    round_all(&mut body.joint.placement.translation, digits);
    round_all(&mut body.joint.armature, digits);
}

fn round_state(state: &mut JointState, kind: JointType, digits: i32) {
    // A quaternion of few digits has no unit length.
    if !matches!(kind, JointType::Spherical | JointType::Free) {
        round_all(&mut state.q, digits);
    }
    [&mut state.v, &mut state.a, &mut state.tau].into_iter().for_each(|numbers| round_all(numbers, digits));
}

fn round_all(numbers: &mut [f64], digits: i32) {
    numbers.iter_mut().for_each(|x| *x = rounded(*x, digits));
}

/// A number to some significant digits; of two decimals equally near the shorter one, as it is read from text.
fn rounded(x: f64, digits: i32) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let places = usize::try_from(digits - 1).unwrap_or_default();
    format!("{x:.places$e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn rounding_keeps_significant_digits() {
        assert_eq!([rounded(0.012_345, 2), rounded(-9876.0, 1), rounded(0.0, 1), rounded(1e6, 1)], [0.012, -1e4, 0.0, 1e6]);
        assert!(rounded(f64::NAN, 1).is_nan());
    }
}
