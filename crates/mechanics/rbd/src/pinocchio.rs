//! What Pinocchio's own URDF parser does to coordinates.

use crate::robot::Joint;
use featherbench_model::JointType;

/// Why that parser gives the joints of a URDF other numbers, or another order; `None` if it does not.
///
/// It is built on urdfdom, whose order `sorted` is. A continuous joint has a cosine and a sine in place of its angle.
pub(crate) fn otherwise(joints: &[Joint], sorted: &[String]) -> Option<String> {
    let unlimited = |joint: &&Joint| {
        matches!(joint.kind, JointType::Revolute { .. }) && joint.limits.iter().all(|(low, high)| low.is_infinite() && high.is_infinite())
    };
    if let Some(joint) = joints.iter().find(unlimited) {
        return Some(format!("it gives the continuous joint '{}' a cosine and a sine in place of an angle", joint.name));
    }
    // A floating base that no joint of the file is comes first in both.
    let of_file = joints.iter().skip(joints.len().saturating_sub(sorted.len()));
    let (ours, theirs) = of_file.zip(sorted).find(|(joint, name)| joint.name != **name)?;
    Some(format!("it sorts siblings by the names of their joints, so '{theirs}' stands where '{}' stands here", ours.name))
}
