//! Programs in MuJoCo's Python interface. A joint of several degrees of freedom is slides and hinges in one body, as our oracle builds it.

use super::{Interface, Theirs, list, number, rows};
use featherbench_bench::Robot;
use featherbench_library::Convention;
use featherbench_model::{BodyDescription, JointType};

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
    for kind, axis in joints:
        body.add_joint(type=kind, axis=axis)
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
    theirs,
};

fn theirs(robot: &Robot) -> Option<Theirs> {
    Theirs::of(robot, Convention::MuJoCo)
}

fn body(body: &BodyDescription) -> Option<String> {
    let joints = match body.joint.kind {
        JointType::Fixed | JointType::Helical { .. } => return None,
        JointType::Free if body.parent.is_some() || body.joint.armature.iter().any(|armature| *armature != 0.0) => return None,
        JointType::Revolute { axis } => format!("(HINGE, {})", list(&axis)),
        JointType::Prismatic { axis } => format!("(SLIDE, {})", list(&axis)),
        JointType::Cylindrical { axis } => format!("(HINGE, {0}), (SLIDE, {0})", list(&axis)),
        JointType::Spherical => "(BALL, Z)".into(),
        JointType::Free => "(FREE, Z)".into(),
        JointType::Planar => "(SLIDE, X), (SLIDE, Y), (HINGE, Z)".into(),
        JointType::Universal => "(HINGE, X), (HINGE, Y)".into(),
        JointType::Translation => "(SLIDE, X), (SLIDE, Y), (SLIDE, Z)".into(),
        JointType::EulerZyx => "(HINGE, Z), (HINGE, Y), (HINGE, X)".into(),
    };
    // Its compiler refuses a moving body without mass.
    if body.mass == 0.0 {
        return None;
    }
    let place = &body.joint.placement;
    Some(format!(
        "add({}, [{joints}], {:?}, {}, {}, {}, {}, {})\n",
        super::parent(body),
        body.name,
        rows(&place.rotation),
        list(&place.translation),
        number(body.mass),
        list(&body.com),
        rows(&super::full(body.inertia))
    ))
}
