//! What Pinocchio's own URDF parser does to coordinates.

use crate::robot::Joint;
use featherbench_model::JointType;
use std::collections::HashMap;

/// Why that parser may give the joints of a URDF other numbers, or another order; `None` if it cannot.
///
/// It is built on urdfdom. Siblings are sorted by the names of their joints, those of fixed joints included, which a robot no longer has: so a
/// robot with siblings is not decided here. A continuous joint has a cosine and a sine in place of its angle.
pub(crate) fn otherwise(joints: &[Joint]) -> Option<String> {
    let unlimited = |joint: &&Joint| {
        matches!(joint.kind, JointType::Revolute { .. }) && joint.limits.iter().all(|(low, high)| low.is_infinite() && high.is_infinite())
    };
    if let Some(joint) = joints.iter().find(unlimited) {
        return Some(format!("it gives the continuous joint '{}' a cosine and a sine in place of an angle", joint.name));
    }
    let mut first = HashMap::new();
    let (before, joint) = joints.iter().find_map(|joint| Some((first.insert(&joint.parent, joint)?, joint)))?;
    Some(format!("it sorts siblings by the names of their joints, and '{}' and '{}' are such", before.name, joint.name))
}
