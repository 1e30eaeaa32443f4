//! Programs in DART's Python interface, and DART's coordinates, which the library does not have (CONVENTIONS.md).

use super::{Interface, Theirs, list, number, rows};
use featherbench_bench::Robot;
use featherbench_model::{BodyDescription, JointType};
use featherbench_spatial::{Mat3, Quaternion, Vec3};

pub const DART: Interface = Interface {
    begin: "import numpy as np
from dartpy import dynamics
from dartpy.math import Isometry3

robot = dynamics.Skeleton(\"robot\")
robot.setGravity({gravity})
bodies = [None]
# DART's order of Euler angles is x, y, z: these axes take it to z, -y, x.
EULER = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])


def add(parent, kind, rotation, translation, mass, com, inertia, turn=np.eye(3), **axes):
    \"\"\"Add a body on a joint.\"\"\"
    joint, body = getattr(robot, f\"create{kind}JointAndBodyNodePair\")(bodies[parent])
    for name, value in axes.items():
        getattr(joint, f\"set{name}\")(*value)
    joint.setTransformFromParentBodyNode(Isometry3(np.array(rotation) @ turn, np.array(translation)))
    joint.setTransformFromChildBodyNode(Isometry3(turn, np.zeros(3)))
    body.setInertia(dynamics.Inertia(mass, np.array(com), np.array(inertia)))
    bodies.append(body)


",
    body,
    end: "

def at():
    \"\"\"Set the state.\"\"\"
    robot.setPositions(q)
    robot.setVelocities(v)
    return robot


def forward():
    \"\"\"Compute the acceleration.\"\"\"
    at().setForces(tau)
    robot.computeForwardDynamics()
    return robot.getAccelerations()


def inverse(acceleration):
    \"\"\"Compute the forces of an acceleration.\"\"\"
    at().setAccelerations(acceleration)
    robot.computeInverseDynamics()
    return robot.getForces()
",
    armature: "",
    answers: &[
        ("id", "inverse_dynamics", "inverse(a)"),
        ("bias", "inverse_dynamics", "inverse(0 * v)"),
        ("bias", "coriolis_and_gravity", "at().getCoriolisAndGravityForces()"),
        ("mass_matrix", "mass_matrix", "at().getMassMatrix()"),
        ("fd", "aba", "forward()"),
        ("fd", "inverse_mass_matrix", "at().getInvMassMatrix() @ (tau - robot.getCoriolisAndGravityForces())"),
    ],
    theirs,
};

/// q_e, T and b: a free joint's velocity is [angular; linear] in the axes of the parent body, and Euler angles are z, −y, x.
fn theirs(robot: &Robot) -> Option<Theirs> {
    let (q, v, nv) = (robot.states.q(0), robot.states.v(0), robot.states.nv);
    let mut theirs = Theirs { q: Vec::new(), t: vec![vec![0.0; nv]; nv], b: vec![0.0; nv] };
    let (mut at_q, mut at_v) = (0, 0);
    for body in &robot.description.bodies {
        let kind = body.joint.kind;
        let q = q.get(at_q..at_q + kind.nq())?;
        for k in at_v..at_v + kind.nv() {
            theirs.t[k][k] = 1.0;
        }
        match kind {
            JointType::Spherical => theirs.q.extend(logarithm(q)),
            JointType::EulerZyx => {
                theirs.q.extend([q[0], -q[1], q[2]]);
                theirs.t[at_v + 1][at_v + 1] = -1.0;
            }
            JointType::Free => {
                theirs.q.extend(logarithm(&q[3..]));
                theirs.q.extend(&q[..3]);
                let turned = Mat3::from_array(body.joint.placement.rotation) * unit(&q[3..]).to_rotation();
                let entries = turned.to_array();
                let rows = &mut theirs.t[at_v..at_v + 6];
                rows.iter_mut().for_each(|row| row[at_v..at_v + 6].fill(0.0));
                for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                    rows[i][at_v + 3 + j] = entries[3 * i + j];
                    rows[3 + i][at_v + j] = entries[3 * i + j];
                }
                let [linear, angular] = [0, 3].map(|at| Vec3::new(v[at_v + at], v[at_v + at + 1], v[at_v + at + 2]));
                theirs.b[at_v + 3..at_v + 6].copy_from_slice(&(turned * angular.cross(linear)).to_array());
            }
            _ => theirs.q.extend(q),
        }
        (at_q, at_v) = (at_q + kind.nq(), at_v + kind.nv());
    }
    Some(theirs)
}

fn unit(q: &[f64]) -> Quaternion<f64> {
    Quaternion::from_array([q[0], q[1], q[2], q[3]]).normalised()
}

/// The rotation vector of a quaternion (x, y, z, w).
fn logarithm(q: &[f64]) -> [f64; 3] {
    let sign = if q[3] < 0.0 { -1.0 } else { 1.0 };
    let sine = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]).sqrt();
    let factor = if sine > 0.0 { 2.0 * sine.atan2(sign * q[3]) / sine * sign } else { 0.0 };
    [q[0] * factor, q[1] * factor, q[2] * factor]
}

fn body(bodies: &[BodyDescription], at: usize) -> Option<String> {
    let body = bodies.get(at)?;
    let place = &body.joint.placement;
    let held = format!("{}, {}, {}", number(body.mass), list(&body.com), rows(&super::full(body.inertia)));
    let add = |kind: &str, more: &str| {
        let (parent, turn, shift) = (super::parent(body), rows(&place.rotation), list(&place.translation));
        format!("add({parent}, \"{kind}\", {turn}, {shift}, {held}{more})\n")
    };
    // It has no armature.
    if body.joint.armature.iter().any(|armature| *armature != 0.0) {
        return None;
    }
    Some(match body.joint.kind {
        JointType::Revolute { axis } => add("Revolute", &format!(", Axis=[{}]", list(&axis))),
        JointType::Prismatic { axis } => add("Prismatic", &format!(", Axis=[{}]", list(&axis))),
        JointType::Helical { axis, pitch } => add("Screw", &format!(", Axis=[{}], Pitch=[2 * np.pi * {}]", list(&axis), number(pitch))),
        JointType::Spherical => add("Ball", ""),
        JointType::Free => add("Free", ""),
        JointType::Planar => add("Planar", ", XYPlane=[]"),
        JointType::Universal => add("Universal", ", Axis1=[[1.0, 0.0, 0.0]], Axis2=[[0.0, 1.0, 0.0]]"),
        JointType::Translation => add("Translational", ""),
        JointType::EulerZyx => add("Euler", ", turn=EULER"),
        // Joints in a row would shift the numbers of the bodies.
        _ => return None,
    })
}
