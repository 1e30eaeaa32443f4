//! What these robots are made of: rods, hinges and loop hinges.

use featherbench_model::{BodyDescription, JointDescription, JointType, Loop, LoopEnd, LoopKind, LoopMotion, Placement};

/// A placement without rotation.
pub(super) fn at(translation: [f64; 3]) -> Placement {
    Placement { translation, ..Placement::default() }
}

/// A placement whose z axis is y of the body.
pub(super) fn about_y(translation: [f64; 3]) -> Placement {
    Placement { rotation: [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0], translation }
}

/// A uniform slender rod from the origin of its frame to `end`, on a hinge about `axis` at `place` of its parent. Its inertia about the
/// centre is m/12 (l² 1 − l lᵀ).
pub(super) fn rod(name: &str, parent: Option<usize>, place: [f64; 3], axis: [f64; 3], end: [f64; 3], mass: f64) -> BodyDescription {
    let [x, y, z] = end;
    let square = x * x + y * y + z * z;
    let share = mass / 12.0;
    let inertia = [square - x * x, -x * y, -x * z, square - y * y, -y * z, square - z * z].map(|entry| share * entry);
    body(name, parent, place, axis, mass, end.map(|x| 0.5 * x), inertia)
}

/// A body on a hinge about `axis` at `place` of its parent.
pub(super) fn body(
    name: &str,
    parent: Option<usize>,
    place: [f64; 3],
    axis: [f64; 3],
    mass: f64,
    com: [f64; 3],
    inertia: [f64; 6],
) -> BodyDescription {
    let kind = JointType::Revolute { axis };
    let joint = JointDescription { kind, placement: at(place), ..JointDescription::default() };
    BodyDescription { name: name.into(), parent, mass, com, inertia, joint }
}

/// A loop joint between frames on two bodies of a description, `None` for the world.
pub(super) fn closed(name: String, ends: [(Option<usize>, Placement); 2], motion: LoopMotion) -> Loop {
    let ends = ends.map(|(body, placement)| LoopEnd { body, placement });
    Loop { name, kind: LoopKind::Joint { ends, motion } }
}
