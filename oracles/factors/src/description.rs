//! The description of the robot that comes through the C interface.

use featherbench_interface::{Body, Given, JOINTS, Refusal};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Placement};

/// The description, for our own model.
///
/// # Errors
/// [`Refusal::Failed`] for a joint type that the interface does not have.
pub(crate) fn description(given: &Given) -> Result<Description, Refusal> {
    let bodies = given.bodies.iter().enumerate().map(|(k, body)| described(k, body)).collect::<Result<_, _>>()?;
    Ok(Description { name: "robot".into(), gravity: given.gravity, bodies, ..Description::default() })
}

fn described(k: usize, body: &Body) -> Result<BodyDescription, Refusal> {
    let &Body { axis, pitch, .. } = body;
    let name = usize::try_from(body.joint).ok().and_then(|joint| JOINTS.get(joint));
    let kind = match name.copied().unwrap_or_default() {
        "revolute" => JointType::Revolute { axis },
        "prismatic" => JointType::Prismatic { axis },
        "helical" => JointType::Helical { axis, pitch },
        "spherical" => JointType::Spherical,
        "free" => JointType::Free,
        "planar" => JointType::Planar,
        "universal" => JointType::Universal,
        _ => return Err(Refusal::Failed(format!("body {k}: there is no joint type {}", body.joint))),
    };
    let joint = JointDescription {
        name: format!("j{k}"),
        kind,
        placement: Placement { rotation: body.rotation, translation: body.translation },
        armature: body.armature[..kind.nv()].to_vec(),
        ..JointDescription::default()
    };
    let parent = usize::try_from(body.parent).ok();
    Ok(BodyDescription { name: format!("b{k}"), parent, mass: body.mass, com: body.com, inertia: body.inertia, joint })
}

/// What is held of each body: 22 numbers, as our model was made of them.
pub(crate) fn read_back(bodies: &[Body], readback: &mut [f64]) {
    for (value, body) in readback.chunks_exact_mut(22).zip(bodies) {
        value[0] = body.mass;
        value[1..4].copy_from_slice(&body.com);
        value[4..10].copy_from_slice(&body.inertia);
        value[10..19].copy_from_slice(&body.rotation);
        value[19..].copy_from_slice(&body.translation);
    }
}
