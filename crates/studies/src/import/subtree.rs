//! What the differences found do not explain, narrowed down to the smallest sub-trees that still show it.
//!
//! The mass matrix belongs to sub-trees: the diagonal block of a body is the composite inertia of everything that hangs on it, seen along
//! its own joint. So a body is where an error begins when its block differs and the blocks of all its children agree.

use super::replay::Replay;
use featherbench_model::Description;

/// What our kernels may be apart from an engine on the very robot that it says to hold, of some depth (joints from the world to a tip):
/// 1e-12, and 1e-14 for each joint beyond a hundred.
///
/// Algorithms differ by 1e-13 and less on robots of a few ten joints; MuJoCo alone loses up to 2e-12 far from the whole robot's centre of mass,
/// which `ci/deviations.toml` names. Each joint of a chain rounds once more, and its error is carried to the world: 1e-14 is 45 ε a joint, and at
/// a thousand joints MuJoCo leaves 7.8e-12. Whatever a parser does to a number shows at 1e-9 and above.
pub fn bound(depth: usize) -> f64 {
    const SHALLOW: f64 = 1e-12;
    const PER_JOINT: f64 = 1e-14;
    SHALLOW.max(PER_JOINT * depth as f64)
}

/// A part of a robot that its reading does not explain.
#[derive(Clone, Debug, PartialEq)]
pub struct SubTree {
    /// The largest error in it.
    pub error: f64,
    /// `mass_matrix`, or `id` where the mass matrix agrees.
    pub quantity: &'static str,
    /// The robot cut down to it: the body where the error begins, standing on the world, and everything that hangs on it.
    pub robot: Description,
}

/// The smallest sub-trees of a reading whose answers are not those of the robot that it describes.
pub(super) fn unexplained(description: &Description, replay: &Replay) -> Vec<SubTree> {
    let bound = bound(description.depth());
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
    // A block beside the diagonal couples a body with one below it: the error begins at the upper one.
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

/// The sub-tree that hangs on a body, the body itself standing on the world.
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
        ..description.clone()
    }
}
