//! Programs in MuJoCo's Python interface. A joint of several degrees of freedom is slides and hinges in one body, and so is a massless body that is
//! only a joint before its child, as our oracle builds them.

use super::{Interface, Theirs, list};
use featherbench_model::{BodyDescription, JointType, Placement};
use featherbench_rbd::Convention;
use featherbench_spatial::{Mat3, Vec3};

pub const MUJOCO: Interface = Interface {
    begin: "import mujoco
import numpy as np

HINGE, SLIDE, BALL, FREE = (getattr(mujoco.mjtJoint, f\"mjJNT_{name}\") for name in (\"HINGE\", \"SLIDE\", \"BALL\", \"FREE\"))
X, Y, Z = np.eye(3)
spec = mujoco.MjSpec()
spec.compiler.degree = spec.compiler.autolimits = spec.compiler.balanceinertia = spec.compiler.fusestatic = spec.compiler.alignfree = False
spec.compiler.boundmass = spec.compiler.boundinertia = 0
spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
spec.option.gravity = {gravity}
bodies = [spec.worldbody]


def quaternion(rotation):
    \"\"\"Convert a rotation to a quaternion, w first.\"\"\"
    out = np.zeros(4)
    mujoco.mju_mat2Quat(out, np.array(rotation).ravel())
    return out


def principal(inertia):
    \"\"\"Compute principal moments, and the quaternion of their axes. MuJoCo takes axes near the body's for these: they are given in another order.\"\"\"
    moments, axes = np.linalg.eigh(np.array(inertia))
    axes = axes * np.sign(np.linalg.det(axes))
    if (np.diag(np.diag(inertia)) == inertia).all():
        moments, axes = np.diag(inertia), np.eye(3)
    elif np.abs(axes - np.eye(3)).max() < 1e-5:
        moments, axes = np.roll(moments, 1), np.roll(axes, 1, axis=1)
    return moments, quaternion(axes)


def add(parent, joints, name, rotation, translation, mass, com, inertia):
    \"\"\"Add a body with its joints.\"\"\"
    body = bodies[parent].add_body(name=name, pos=translation, quat=quaternion(rotation))
    for kind, axis, place in joints:
        body.add_joint(type=kind, axis=axis, pos=place)
    moments, turn = principal(inertia)
    body.explicitinertial, body.mass, body.ipos, body.inertia, body.iquat = True, mass, com, moments, turn
    bodies.append(body)


",
    body,
    end: "model = spec.compile()
{armature}data = mujoco.MjData(model)


def at():
    \"\"\"Set the state, and compute what depends on it.\"\"\"
    data.qpos, data.qvel, data.qfrc_applied = q, v, tau
    mujoco.mj_forward(model, data)
    return data


def mass_matrix():
    \"\"\"Compute M.\"\"\"
    out = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, at(), out)
    return out


def inverse(acceleration):
    \"\"\"Compute the forces of an acceleration.\"\"\"
    at().qacc = acceleration
    mujoco.mj_inverse(model, data)
    return data.qfrc_inverse.copy()


def recursive(acceleration):
    \"\"\"Compute the same by the recursion alone, which leaves armature out.\"\"\"
    at().qacc = acceleration
    out = np.zeros(model.nv)
    mujoco.mj_rne(model, data, 1, out)
    return out + model.dof_armature * acceleration
",
    armature: "model.dof_armature = {armature}\nmujoco.mj_setConst(model, mujoco.MjData(model))\n",
    answers: &[
        ("id", "inverse", "inverse(a)"),
        ("id", "rne", "recursive(a)"),
        ("bias", "inverse", "inverse(0 * v)"),
        ("bias", "qfrc_bias", "at().qfrc_bias.copy()"),
        ("mass_matrix", "crb", "mass_matrix()"),
        ("fd", "forward", "at().qacc.copy()"),
    ],
    theirs: |robot| Theirs::of(robot, Convention::MuJoCo),
};

fn body(bodies: &[BodyDescription], at: usize) -> Option<String> {
    if folds(bodies, at) {
        return Some("bodies.append(None)\n".into());
    }
    // The massless bodies before it are joints of this one.
    let first = (0..at).rev().take_while(|&before| folds(bodies, before)).last().unwrap_or(at);
    let (chain, body) = (bodies.get(first..=at)?, bodies.get(at)?);
    // Its compiler refuses a moving body without mass.
    if body.mass == 0.0 {
        return None;
    }
    let joints: Option<Vec<String>> = chain.iter().enumerate().map(|(k, part)| joints(part, chain.get(k + 1..)?)).collect();
    let place = chain.first()?.joint.placement;
    let way = Mat3::from_array(place.rotation) * Vec3::from_array(way(chain.get(1..)?));
    let position = (Vec3::from_array(place.translation) + way).to_array();
    Some(super::add(chain.first()?, &format!("[{}]", joints?.join(", ")), body, &position, ""))
}

/// Whether a body is only a joint before its one child, with the same axes.
fn folds(bodies: &[BodyDescription], at: usize) -> bool {
    let (Some(body), Some(child)) = (bodies.get(at), bodies.get(at + 1)) else { return false };
    let nothing = body.mass == 0.0 && body.com.iter().chain(&body.inertia).all(|number| *number == 0.0);
    let only = child.parent == Some(at) && bodies.iter().filter(|other| other.parent == Some(at)).count() == 1;
    let floats = [body, child].iter().any(|body| body.joint.kind == JointType::Free);
    nothing && only && !floats && child.joint.placement.rotation == Placement::default().rotation
}

/// The sum of the translations of some joints, which have the same axes.
fn way(bodies: &[BodyDescription]) -> [f64; 3] {
    bodies.iter().fold([0.0; 3], |sum, body| std::array::from_fn(|k| sum[k] + body.joint.placement.translation[k]))
}

/// The joints of a body, at their place in the last body of the chain; the others follow it there.
fn joints(body: &BodyDescription, others: &[BodyDescription]) -> Option<String> {
    let z = "Z".to_owned();
    let parts = match body.joint.kind {
        JointType::Fixed | JointType::Helical { .. } => return None,
        JointType::Free if body.parent.is_some() || body.joint.armature.iter().any(|armature| *armature != 0.0) => return None,
        JointType::Revolute { axis } => vec![("HINGE", list(&axis))],
        JointType::Prismatic { axis } => vec![("SLIDE", list(&axis))],
        JointType::Spherical => vec![("BALL", z)],
        JointType::Free => vec![("FREE", z)],
        row => row.row().iter().map(|one| (if one.turns { "HINGE" } else { "SLIDE" }, super::axis(&one.axis))).collect(),
    };
    // No negative zeros.
    let place = list(&way(others).map(|x| 0.0 - x));
    Some(parts.iter().map(|(kind, axis)| format!("({kind}, {axis}, {place})")).collect::<Vec<_>>().join(", "))
}
