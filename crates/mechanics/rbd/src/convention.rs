//! The coordinates of Pinocchio, MuJoCo and Drake, and back: the ledger `CONVENTIONS.md` as functions.
//!
//! An engine's own numbers have the index e. Joint by joint,
//!
//! ```text
//! v_e = T v      a_e = T a + b      τ_e = T⁻ᵀ τ
//! ```
//!
//! | engine | joint | q_e | T | b |
//! |---|---|---|---|---|
//! | Pinocchio | planar | x, y, cos θ, sin θ | diag(R₂(θ)ᵀ, 1) | (θ̇ w_y, −θ̇ w_x, 0) with w = R₂ᵀ (ẋ, ẏ) |
//! | MuJoCo | free | origin in the world, quaternion wxyz in the world | diag(R, 1) | (R (ω × v), 0) |
//! | | spherical | quaternion wxyz | 1 | 0 |
//! | Drake | free | quaternion wxyz, origin | [[0, R], [R, 0]] | (0, R (ω × v)) |
//! | | spherical | roll, pitch, yaw | R | 0 |
//! | all | others | q | 1 | 0 |
//!
//! R takes body axes to those of the joint's frame, in MuJoCo of the world. Each T is orthogonal, so T⁻ᵀ = T and T⁻¹ = Tᵀ.
//!
//! The joints stand in the order of this robot. A parser may give another one: those built on urdfdom, as Pinocchio's, sort siblings by
//! name. Pinocchio's parser also gives `continuous` joints cos θ and sin θ in place of θ. The functions here are for an engine's model with this
//! order, and with θ.

use crate::Error;
use crate::robot::Joint;
use featherbench_model::JointType;
use featherbench_spatial::{Mat3, Quaternion, Vec3};
use std::fmt;

/// An engine whose coordinates are known.
///
/// ```
/// use featherbench_rbd::{Convention, Robot};
///
/// // A free body, turned by a quarter about z, moves along its own x axis.
/// let robot = Robot::generated("chain:n=1,base=free")?;
/// let half = 0.5_f64.sqrt();
/// let q = [1.0, 2.0, 3.0, 0.0, 0.0, half, half, 0.0];
/// let v = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let theirs = robot.velocity_to(Convention::MuJoCo, &q, &v)?;
/// assert!((theirs[1] - 1.0).abs() < 1e-15, "MuJoCo's linear velocity is in world axes: along y");
/// assert_eq!(robot.to_mujoco(&q)?[3..7], [half, 0.0, 0.0, half], "the scalar first");
/// # Ok::<(), featherbench_rbd::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Convention {
    /// Pinocchio.
    Pinocchio,
    /// MuJoCo.
    MuJoCo,
    /// Drake.
    Drake,
}

impl fmt::Display for Convention {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Pinocchio => "Pinocchio",
            Self::MuJoCo => "MuJoCo",
            Self::Drake => "Drake",
        })
    }
}

impl Convention {
    /// The length of a joint's part of the engine's q.
    pub(crate) fn nq(self, joint: &Joint) -> usize {
        match (self, joint.kind) {
            (Self::Pinocchio, JointType::Planar) => 4,
            (Self::Drake, JointType::Spherical) => 3,
            (_, kind) => kind.nq(),
        }
    }

    /// An error, if the engine does not have the joint.
    pub(crate) fn check(self, joint: &Joint) -> Result<(), Error> {
        let reason = match (self, joint.kind) {
            (Self::MuJoCo, JointType::Helical { .. }) => "it has no helical joint",
            (Self::MuJoCo, JointType::Free) if joint.parent.is_some() => "its free joints stand on the world only",
            _ => return Ok(()),
        };
        Err(Error::NoCoordinates { convention: self, joint: joint.name.clone(), kind: joint.kind.name(), reason })
    }

    /// The engine's numbers of a joint's configuration.
    pub(crate) fn write_q(self, joint: &Joint, q: &[f64], theirs: &mut [f64]) {
        match (self, joint.kind) {
            (Self::Pinocchio, JointType::Planar) => theirs.copy_from_slice(&[q[0], q[1], q[2].cos(), q[2].sin()]),
            (Self::MuJoCo, JointType::Spherical) => theirs.copy_from_slice(&wxyz(unit(q))),
            (Self::MuJoCo, JointType::Free) => {
                let turn = quaternion_of(joint.placement.rotation) * unit(&q[3..]);
                theirs[..3].copy_from_slice(&joint.placement.point(vector(q)).to_array());
                theirs[3..].copy_from_slice(&wxyz(turn.normalised()));
            }
            (Self::Drake, JointType::Spherical) => theirs.copy_from_slice(&roll_pitch_yaw(unit(q).to_rotation())),
            (Self::Drake, JointType::Free) => {
                theirs[..4].copy_from_slice(&wxyz(unit(&q[3..])));
                theirs[4..].copy_from_slice(&q[..3]);
            }
            _ => theirs.copy_from_slice(q),
        }
    }

    /// A joint's configuration from the engine's numbers.
    pub(crate) fn read_q(self, joint: &Joint, theirs: &[f64], q: &mut [f64]) {
        match (self, joint.kind) {
            (Self::Pinocchio, JointType::Planar) => q.copy_from_slice(&[theirs[0], theirs[1], theirs[3].atan2(theirs[2])]),
            (Self::MuJoCo, JointType::Spherical) => q.copy_from_slice(&xyzw(theirs).normalised().to_array()),
            (Self::MuJoCo, JointType::Free) => {
                let back = joint.placement.inverse();
                let turn = quaternion_of(back.rotation) * xyzw(&theirs[3..]);
                q[..3].copy_from_slice(&back.point(vector(theirs)).to_array());
                q[3..].copy_from_slice(&turn.normalised().to_array());
            }
            (Self::Drake, JointType::Spherical) => q.copy_from_slice(&from_roll_pitch_yaw(vector(theirs)).to_array()),
            (Self::Drake, JointType::Free) => {
                q[..3].copy_from_slice(&theirs[4..]);
                q[3..].copy_from_slice(&xyzw(theirs).normalised().to_array());
            }
            _ => q.copy_from_slice(theirs),
        }
    }

    /// What T does to a joint's numbers.
    pub(crate) fn turn(self, joint: &Joint, q: &[f64]) -> Turn {
        match (self, joint.kind) {
            (Self::Pinocchio, JointType::Planar) => {
                let (s, c) = q[2].sin_cos();
                // R₂ᵀ on the first two of three numbers
                Turn::First(Mat3::from_array([c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0]))
            }
            (Self::MuJoCo, JointType::Free) => Turn::First(joint.placement.rotation * unit(&q[3..]).to_rotation()),
            (Self::Drake, JointType::Spherical) => Turn::First(unit(q).to_rotation()),
            (Self::Drake, JointType::Free) => Turn::Exchanged(unit(&q[3..]).to_rotation()),
            _ => Turn::None,
        }
    }

    /// b of a joint.
    pub(crate) fn bias(self, joint: &Joint, q: &[f64], v: &[f64]) -> [f64; 6] {
        let mut b = [0.0; 6];
        match (self, joint.kind, self.turn(joint, q)) {
            (Self::Pinocchio, JointType::Planar, Turn::First(r)) => {
                let w = r * vector(v);
                (b[0], b[1]) = (v[2] * w.y, -v[2] * w.x);
            }
            (Self::MuJoCo, JointType::Free, Turn::First(r)) => b[..3].copy_from_slice(&(r * vector(&v[3..]).cross(vector(v))).to_array()),
            (Self::Drake, JointType::Free, Turn::Exchanged(r)) => {
                b[3..].copy_from_slice(&(r * vector(&v[3..]).cross(vector(v))).to_array())
            }
            _ => {}
        }
        b
    }
}

/// The orthogonal matrix T of a joint.
pub(crate) enum Turn {
    /// The identity.
    None,
    /// It turns the first three numbers.
    First(Mat3<f64>),
    /// It turns both halves of six numbers and exchanges them.
    Exchanged(Mat3<f64>),
}

impl Turn {
    /// T x into `result`.
    pub(crate) fn apply(&self, x: &[f64], result: &mut [f64]) {
        result.copy_from_slice(x);
        match self {
            Self::None => {}
            Self::First(r) => result[..3].copy_from_slice(&(*r * vector(x)).to_array()),
            Self::Exchanged(r) => {
                result[..3].copy_from_slice(&(*r * vector(&x[3..])).to_array());
                result[3..].copy_from_slice(&(*r * vector(x)).to_array());
            }
        }
    }

    /// T⁻¹ x into `result`.
    pub(crate) fn undo(&self, x: &[f64], result: &mut [f64]) {
        result.copy_from_slice(x);
        match self {
            Self::None => {}
            Self::First(r) => result[..3].copy_from_slice(&r.transpose_mul(vector(x)).to_array()),
            Self::Exchanged(r) => {
                result[..3].copy_from_slice(&r.transpose_mul(vector(&x[3..])).to_array());
                result[3..].copy_from_slice(&r.transpose_mul(vector(x)).to_array());
            }
        }
    }
}

fn vector(x: &[f64]) -> Vec3<f64> {
    Vec3::new(x[0], x[1], x[2])
}

/// The quaternion (x, y, z, w) that begins a slice, with length one.
fn unit(q: &[f64]) -> Quaternion<f64> {
    // Its square is a normal number, but may be below the one that `normalised` takes for none.
    let length = q[..4].iter().map(|x| x * x).sum::<f64>().sqrt();
    Quaternion::from_array([q[0], q[1], q[2], q[3]].map(|x| x / length))
}

/// The quaternion whose numbers (w, x, y, z) begin a slice, with length one.
fn xyzw(q: &[f64]) -> Quaternion<f64> {
    unit(&[q[1], q[2], q[3], q[0]])
}

fn wxyz(quaternion: Quaternion<f64>) -> [f64; 4] {
    let [x, y, z, w] = quaternion.to_array();
    [w, x, y, z]
}

/// The quaternion of a rotation: from the largest of its four numbers, whose square is the least cancelled (S. W. Shepperd, 1978).
fn quaternion_of(rotation: Mat3<f64>) -> Quaternion<f64> {
    let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = rotation.to_array();
    // four times the squares of x, y, z and w
    let squares = [1.0 + xx - yy - zz, 1.0 - xx + yy - zz, 1.0 - xx - yy + zz, 1.0 + xx + yy + zz];
    let largest = (1..4).fold(0, |largest, k| if squares[k] > squares[largest] { k } else { largest });
    let numbers = match largest {
        0 => [squares[0], xy + yx, xz + zx, zy - yz],
        1 => [xy + yx, squares[1], yz + zy, xz - zx],
        2 => [xz + zx, yz + zy, squares[2], yx - xy],
        _ => [zy - yz, xz - zx, yx - xy, squares[3]],
    };
    Quaternion::from_array(numbers).normalised()
}

/// The angles of R = Rz(yaw) Ry(pitch) Rx(roll), with the pitch in [−π/2, π/2].
fn roll_pitch_yaw(rotation: Mat3<f64>) -> [f64; 3] {
    let [xx, _, _, yx, _, _, zx, zy, zz] = rotation.to_array();
    [zy.atan2(zz), (-zx).atan2(xx.hypot(yx)), yx.atan2(xx)]
}

fn from_roll_pitch_yaw(angles: Vec3<f64>) -> Quaternion<f64> {
    let about = |x: f64, y: f64, z: f64| Quaternion::exp(Vec3::new(x, y, z));
    (about(0.0, 0.0, angles.z) * about(0.0, angles.y, 0.0) * about(angles.x, 0.0, 0.0)).normalised()
}
