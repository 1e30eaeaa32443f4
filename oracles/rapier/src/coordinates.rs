//! Between neutral coordinates and rapier's, `v_e = T v`, `a_e = T a + b`, T orthogonal.
//!
//! | joint | rapier's free axes | displacement from zero | T | b |
//! |---|---|---|---|---|
//! | revolute | angular x; both frames turned so that x is the axis | angle | identity | 0 |
//! | prismatic | linear x; both frames turned | distance | identity | 0 |
//! | cylindrical | linear and angular x; both frames turned | distance, angle | a swap: the angle comes first in ours | 0 |
//! | planar | linear x and y, angular z | x, y, θ | identity | 0 |
//! | translation | linear x, y, z | x, y, z | identity | 0 |
//! | spherical | angular x, y, z | log R | R: angular velocity in joint-frame axes | 0 |
//! | free | all six | p, log R | diag(R, R): [linear; angular] in joint-frame axes | [R (ω × v); 0] |
//!
//! R turns body axes to joint-frame axes. Some joints are missing:
//! - universal: rapier does not implement two free angular axes (it panics);
//! - helical: it would be a constraint between two joints;
//! - Euler angles: with three free angular axes the velocity is the angular one. Its conversion to rates of Euler angles is not orthogonal, and
//!   singular at a pitch of ±90°.

use crate::refusal::Refusal;
use featherbench_model::{BodyDescription, Description, JointType};
use rapier3d_f64::math::{Matrix, Pose, Rotation, Vector};
use rapier3d_f64::prelude::{GenericJoint, GenericJointBuilder, JointAxesMask};

/// Rapier's joint of the description's kind.
pub fn joint(body: &BodyDescription) -> Result<GenericJoint, Refusal> {
    let kind = body.joint.kind;
    let free = match kind {
        JointType::Revolute { .. } => JointAxesMask::ANG_X,
        JointType::Prismatic { .. } => JointAxesMask::LIN_X,
        JointType::Cylindrical { .. } => JointAxesMask::LIN_X | JointAxesMask::ANG_X,
        JointType::Planar => JointAxesMask::LIN_X | JointAxesMask::LIN_Y | JointAxesMask::ANG_Z,
        JointType::Translation => JointAxesMask::LIN_AXES,
        JointType::Spherical => JointAxesMask::ANG_AXES,
        JointType::Free => JointAxesMask::all(),
        _ => return Err(Refusal::Unsupported(format!("rapier's multibodies have no {} joint ({})", kind.name(), body.joint.name))),
    };
    let turn = kind.axis().map_or(Rotation::IDENTITY, |axis| Rotation::from_rotation_arc(Vector::X, Vector::from(axis).normalize()));
    let placement = placement(body);
    Ok(GenericJointBuilder::new(free.complement())
        .local_frame1(Pose::from_parts(placement.translation, placement.rotation * turn))
        .local_frame2(Pose::from_rotation(turn))
        .build())
}

/// The joint's placement on the parent.
pub fn placement(body: &BodyDescription) -> Pose {
    let place = &body.joint.placement;
    let rotation = Rotation::from_mat3(&Matrix::from_cols_array(&place.rotation).transpose()).normalize();
    Pose::from_parts(Vector::from(place.translation), rotation)
}

/// The placement of the description, read back: the joint's first frame without our turn.
pub fn placement_of(joint: &GenericJoint) -> Pose {
    let turn = joint.local_frame2.rotation;
    Pose::from_parts(joint.local_frame1.translation, joint.local_frame1.rotation * turn.inverse())
}

/// The displacements of rapier's joints from zero.
pub fn displacement(robot: &Description, q: &[f64]) -> Vec<f64> {
    let mut all = Vec::with_capacity(robot.nv());
    let mut at = 0;
    for body in &robot.bodies {
        let q = &q[at..at + body.joint.kind.nq()];
        at += q.len();
        match body.joint.kind {
            JointType::Cylindrical { .. } => all.extend([q[1], q[0]]),
            JointType::Spherical => all.extend(logarithm(q)),
            JointType::Free => {
                all.extend(&q[..3]);
                all.extend(logarithm(&q[3..]));
            }
            _ => all.extend(q),
        }
    }
    all
}

/// The rotation vector, at most π long, of the quaternion (x, y, z, w).
fn logarithm(q: &[f64]) -> [f64; 3] {
    let sign = 1.0_f64.copysign(q[3]);
    let vector = sign * Vector::new(q[0], q[1], q[2]);
    let sine = vector.length();
    let scale = if sine > 0.0 { 2.0 * sine.atan2(sign * q[3]) / sine } else { 2.0 };
    (scale * vector).to_array()
}

/// T and b at one state.
pub struct Change {
    /// The blocks of T that are not identity, and their positions.
    blocks: Vec<(usize, Block)>,
    /// b = (dT/dt) v.
    bias: Vec<f64>,
}

/// A block of T.
enum Block {
    /// A rotation of three numbers.
    Turn(Matrix),
    /// Two numbers in the other order.
    Swap,
}

impl Change {
    /// T and b of the table.
    pub fn new(robot: &Description, q: &[f64], v: &[f64]) -> Self {
        let (mut blocks, mut bias) = (Vec::new(), vec![0.0; v.len()]);
        let (mut at_q, mut at_v) = (0, 0);
        for body in &robot.bodies {
            let kind = body.joint.kind;
            let end = at_q + kind.nq();
            if matches!(kind, JointType::Cylindrical { .. }) {
                blocks.push((at_v, Block::Swap));
            }
            if matches!(kind, JointType::Spherical | JointType::Free) {
                let r = Matrix::from_quat(Rotation::from_slice(&q[end - 4..end]).normalize());
                blocks.push((at_v, Block::Turn(r)));
                if kind == JointType::Free {
                    blocks.push((at_v + 3, Block::Turn(r)));
                    let (linear, angular) = (Vector::from_slice(&v[at_v..]), Vector::from_slice(&v[at_v + 3..]));
                    bias[at_v..at_v + 3].copy_from_slice(&(r * angular.cross(linear)).to_array());
                }
            }
            (at_q, at_v) = (end, at_v + kind.nv());
        }
        Self { blocks, bias }
    }

    /// T x, for velocities and for forces: T is orthogonal.
    pub fn forth(&self, x: &[f64]) -> Vec<f64> {
        let mut y = x.to_vec();
        for (at, block) in &self.blocks {
            block.apply(&mut y[*at..], |r, y| r * y);
        }
        y
    }

    /// Tᵀ x, in place: a force, or a row of a Jacobian.
    pub fn back(&self, x: &mut [f64]) {
        for (at, block) in &self.blocks {
            block.apply(&mut x[*at..], |r, x| r.transpose() * x);
        }
    }

    /// a = Tᵀ (a_e − b), in place.
    pub fn acceleration(&self, a: &mut [f64]) {
        for (a, b) in a.iter_mut().zip(&self.bias) {
            *a -= b;
        }
        self.back(a);
    }
}

impl Block {
    /// Changes the first numbers of `x`, in place; a swap is its own transpose.
    fn apply(&self, x: &mut [f64], turn: impl Fn(&Matrix, Vector) -> Vector) {
        match self {
            Self::Turn(r) => {
                let turned = turn(r, Vector::from_slice(x));
                x[..3].copy_from_slice(&turned.to_array());
            }
            Self::Swap => x.swap(0, 1),
        }
    }
}
