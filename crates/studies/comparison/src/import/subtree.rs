//! The smallest sub-trees whose answers the known differences do not explain.
//!
//! The mass matrix belongs to sub-trees. The diagonal block of a body is the composite inertia of everything that it supports, seen along
//! its own joint. So an error begins at a body if its block differs and the blocks of all its children agree.

use super::fields::Precision;
use super::replay::Replay;
use featherbench_model::Description;

/// The largest distance of our kernels from an engine on the robot that it reports: 1e-12 up to a depth of a hundred, and 1e-14 more for
/// each further joint. Here the depth is the number of joints from the world to a tip.
///
/// - Algorithms differ by 1e-13 and less on robots of a few ten joints. MuJoCo alone loses up to 2e-12 far from the whole robot's centre of
///   mass, which `ci/deviations/mujoco.toml` names.
/// - Each joint of a chain adds a rounding error, which is carried to the world: 1e-14 is 45 ε a joint. At a thousand joints MuJoCo's
///   error is 7.8e-12.
/// - An edit by a parser causes 1e-9 and more.
///
/// In single precision it is 2²⁹ times that, as the unit of rounding is.
pub fn bound(depth: usize, precision: Precision) -> f64 {
    const SHALLOW: f64 = 1e-12;
    const PER_JOINT: f64 = 1e-14;
    precision.factor() * SHALLOW.max(PER_JOINT * depth as f64)
}

/// A part of a robot that its import result does not explain.
#[derive(Clone, Debug, PartialEq)]
pub struct SubTree {
    /// The largest error in it.
    pub error: f64,
    /// `mass_matrix`, or `id` where the mass matrix agrees.
    pub quantity: &'static str,
    /// The robot cut down to it: the body where the error begins, with the world as its parent, and everything that it supports.
    pub robot: Description,
}

/// The smallest sub-trees of an import result whose answers are not those of the described robot.
pub(super) fn unexplained(description: &Description, replay: &Replay, precision: Precision) -> Vec<SubTree> {
    let bound = bound(description.depth(), precision);
    let agrees = |error: f64| error <= bound;
    let mut next = 0;
    let dofs: Vec<std::ops::Range<usize>> = description
        .bodies
        .iter()
        .map(|body| {
            let start = next;
            next += body.joint.kind.nv();
            start..next
        })
        .collect();
    let nv = next;
    let largest = |errors: &mut dyn Iterator<Item = f64>| errors.fold(0.0, featherbench_bench::measure::worst);
    let block = |i: usize, j: usize| {
        largest(&mut dofs[i].clone().flat_map(|m| dofs[j].clone().map(move |n| (m, n))).map(|(m, n)| replay.entry[m * nv + n]))
    };
    let own: Vec<f64> = (0..dofs.len()).map(|i| block(i, i)).collect();
    // A block off the diagonal couples a body with one below it: the error begins at the upper one.
    let coupled = || (0..dofs.len()).map(|i| largest(&mut (i..dofs.len()).map(|j| block(i, j)))).collect::<Vec<f64>>();
    let torque = || dofs.iter().map(|range| largest(&mut range.clone().map(|m| replay.torque[m]))).collect::<Vec<f64>>();
    let wrong = |errors: &[f64]| errors.iter().any(|&error| !agrees(error));
    let (errors, quantity) = if wrong(&own) {
        (own, "mass_matrix")
    } else if !agrees(replay.effect.mass_matrix) {
        (coupled(), "mass_matrix")
    } else if wrong(&torque()) {
        (torque(), "id")
    } else {
        return Vec::new();
    };
    let children_agree = |i: usize| (0..errors.len()).filter(|&c| description.bodies[c].parent == Some(i)).all(|c| agrees(errors[c]));
    let begins = (0..errors.len()).filter(|&i| !agrees(errors[i]) && children_agree(i));
    begins.map(|i| SubTree { error: errors[i], quantity, robot: cut(description, i) }).collect()
}

/// The sub-tree of a body, without loops; the world is the body's parent.
fn cut(description: &Description, root: usize) -> Description {
    let mut place = vec![None; description.bodies.len()];
    let mut bodies = Vec::new();
    for (i, body) in description.bodies.iter().enumerate() {
        let parent = body.parent.and_then(|parent| place[parent]);
        if i == root || parent.is_some() {
            place[i] = Some(bodies.len());
            bodies.push(featherbench_model::BodyDescription { parent, ..body.clone() });
        }
    }
    Description {
        name: format!("{}/{}", description.name, description.bodies[root].name),
        bodies,
        frames: Vec::new(),
        loops: Vec::new(),
        residuals: Vec::new(),
        uncertain: featherbench_model::Uncertain::default(),
        ..description.clone()
    }
}
