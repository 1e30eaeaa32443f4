//! The joints of a body in MJCF: one or several for each joint of a description.

use crate::export::Reason;
use featherbench_model::{BodyDescription, JointDescription, JointType, OneDof};
use std::ops::Range;

/// An MJCF joint: a part of a description's joint.
pub(super) struct Part<'a> {
    /// The description's joint.
    pub joint: &'a JointDescription,
    /// The suffix of its name.
    pub suffix: &'static str,
    /// MJCF's word for its type.
    pub kind: &'static str,
    /// The axis, for hinges and slides.
    pub axis: Option<[f64; 3]>,
    /// Which of the joint's degrees of freedom it has.
    pub dofs: Range<usize>,
}

/// The MJCF joints of a joint, from the parent outwards; or why there are none.
pub(super) fn parts(joint: &JointDescription) -> Result<Vec<Part<'_>>, Reason> {
    let whole = |kind, axis| vec![Part { joint, suffix: "", kind, axis, dofs: 0..joint.kind.nv() }];
    Ok(match joint.kind {
        JointType::Fixed => Vec::new(),
        JointType::Revolute { axis } => whole("hinge", Some(axis)),
        JointType::Prismatic { axis } => whole("slide", Some(axis)),
        JointType::Spherical => whole("ball", None),
        JointType::Free => whole("free", None),
        JointType::Helical { .. } => {
            return Err(Reason::JointType { kind: "helical", advice: "keep the robot in the neutral format" });
        }
        row => {
            let part = |(k, OneDof { suffix, turns, axis })| Part {
                joint,
                suffix,
                kind: if turns { "hinge" } else { "slide" },
                axis: Some(axis),
                dofs: k..k + 1,
            };
            row.row().into_iter().enumerate().map(part).collect()
        }
    })
}

/// Whether a body is no more than a joint of the only body that it carries. The parts of a joint are so after an import: massless, on one
/// hinge or slide, with that body's frame in its own.
pub(super) fn is_part_of_child(body: &BodyDescription, child: &BodyDescription) -> bool {
    let one_dof = |body: &BodyDescription| matches!(body.joint.kind, JointType::Revolute { .. } | JointType::Prismatic { .. });
    body.mass == 0.0 && body.inertia == [0.0; 6] && one_dof(body) && one_dof(child) && child.joint.placement == Default::default()
}
