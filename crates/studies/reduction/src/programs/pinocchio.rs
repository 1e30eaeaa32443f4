//! Programs in Pinocchio's Python interface. A joint about an axis of its frame has the aligned form, as our oracle builds it.

use super::{Interface, Theirs, list, number};
use featherbench_model::{BodyDescription, JointType, OneDof};
use featherbench_rbd::Convention;

pub const PINOCCHIO: Interface = Interface {
    begin: "import numpy as np
import pinocchio as pin

model = pin.Model()
model.gravity = pin.Motion(np.array({gravity}), np.zeros(3))
bodies = [0]


def add(parent, joint, name, rotation, translation, mass, com, inertia):
    \"\"\"Add a body. Its inertia is set part by part: the constructor refuses what no body can have.\"\"\"
    place = pin.SE3(np.array(rotation), np.array(translation))
    held = pin.Inertia.Zero()
    held.mass, held.lever, held.inertia = mass, np.array(com), np.array(inertia)
    bodies.append(model.addJoint(bodies[parent], joint, place, name))
    model.appendBodyToJoint(bodies[-1], held, pin.SE3.Identity())


def chain(*joints):
    \"\"\"Make one joint of several.\"\"\"
    composite = pin.JointModelComposite(len(joints))
    for joint in joints:
        composite.addJoint(joint, pin.SE3.Identity())
    return composite


",
    body,
    end: "{armature}data = model.createData()


def full(upper):
    \"\"\"Mirror the upper triangle.\"\"\"
    upper = np.triu(upper)
    return upper + np.triu(upper, 1).T
",
    armature: "model.armature = np.array({armature})\n",
    answers: &[
        ("id", "rnea", "pin.rnea(model, data, q, v, a)"),
        ("bias", "rnea", "pin.rnea(model, data, q, v, 0 * v)"),
        ("bias", "nonlinear_effects", "pin.nonLinearEffects(model, data, q, v)"),
        ("mass_matrix", "crba_local", "full(pin.crba(model, data, q, pin.Convention.LOCAL))"),
        ("mass_matrix", "crba_world", "full(pin.crba(model, data, q, pin.Convention.WORLD))"),
        ("fd", "aba_local", "pin.aba(model, data, q, v, tau, pin.Convention.LOCAL)"),
        ("fd", "aba_world", "pin.aba(model, data, q, v, tau, pin.Convention.WORLD)"),
        ("fd", "minverse", "full(pin.computeMinverse(model, data, q)) @ (tau - pin.nonLinearEffects(model, data, q, v))"),
        ("fd", "crba_cholesky", "np.linalg.solve(full(pin.crba(model, data, q)), tau - pin.nonLinearEffects(model, data, q, v))"),
        ("kinetic_energy", "kinetic_energy", "pin.computeKineticEnergy(model, data, q, v)"),
        ("id_dq", "rnea_derivatives", "pin.computeRNEADerivatives(model, data, q, v, a)[0]"),
        ("id_dv", "rnea_derivatives", "pin.computeRNEADerivatives(model, data, q, v, a)[1]"),
        ("fd_dq", "aba_derivatives", "pin.computeABADerivatives(model, data, q, v, tau)[0]"),
        ("fd_dv", "aba_derivatives", "pin.computeABADerivatives(model, data, q, v, tau)[1]"),
        ("coriolis_matrix", "coriolis_matrix", "pin.computeCoriolisMatrix(model, data, q, v)"),
    ],
    theirs: |robot| Theirs::of(robot, Convention::Pinocchio),
};

fn body(bodies: &[BodyDescription], at: usize) -> Option<String> {
    let body = bodies.get(at)?;
    let joint = match body.joint.kind {
        JointType::Fixed => return None,
        JointType::Revolute { axis } => about("Revolute", &axis, ""),
        JointType::Prismatic { axis } => about("Prismatic", &axis, ""),
        JointType::Helical { axis, pitch } => about("Helical", &axis, &number(pitch)),
        JointType::Universal => "pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))".into(),
        JointType::Spherical => "pin.JointModelSpherical()".into(),
        JointType::Free => "pin.JointModelFreeFlyer()".into(),
        // Its armature would act in body axes.
        JointType::Planar if body.joint.armature.iter().any(|armature| *armature != 0.0) => return None,
        JointType::Planar => "pin.JointModelPlanar()".into(),
        JointType::Translation => "pin.JointModelTranslation()".into(),
        JointType::EulerZyx => "pin.JointModelSphericalZYX()".into(),
        row => {
            let one = |one: OneDof| about(if one.turns { "Revolute" } else { "Prismatic" }, &one.axis, "");
            format!("chain({})", row.row().into_iter().map(one).collect::<Vec<_>>().join(", "))
        }
    };
    Some(super::add(body, &joint, body, &body.joint.placement.translation, ""))
}

/// A joint of one degree of freedom about or along an axis: the aligned form where the axis is exactly one of the frame's.
fn about(kind: &str, axis: &[f64; 3], pitch: &str) -> String {
    const UNITS: [(&str, [f64; 3]); 3] = [("X", [1.0, 0.0, 0.0]), ("Y", [0.0, 1.0, 0.0]), ("Z", [0.0, 0.0, 1.0])];
    match UNITS.iter().find(|(_, unit)| unit == axis) {
        Some((along, _)) => format!("pin.JointModel{}{along}({pitch})", &kind[..1]),
        None if pitch.is_empty() => format!("pin.JointModel{kind}Unaligned(np.array({}))", list(axis)),
        None => format!("pin.JointModel{kind}Unaligned(np.array({}), {pitch})", list(axis)),
    }
}
