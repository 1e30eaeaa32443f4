//! The configuration space of a tree: steps along velocities, and differences of configurations.
//!
//! The space is the product of the joints' spaces. `q ⊕ v` is [`Topology::integrate`], `q₁ ⊖ q₀` is [`Topology::difference`]:
//!
//! | joint | q ⊕ v | q₁ ⊖ q₀ |
//! |---|---|---|
//! | revolute, prismatic, helical | q + v | q₁ − q₀ |
//! | spherical | q exp(ω) | log(q₀⁻¹ q₁) |
//! | free | p + R exp(ξ)ₚ, quaternion · exp(ω) | log of the pose 1 seen from the pose 0 |
//!
//! A spherical joint has the group SO(3), a free joint SE(3). Velocities are in body axes, so that increments stand on the right.
//! A revolute joint's angle is a number that does not wrap. Composed joints are chains of these ([`crate::JointKind`]).
//!
//! Source: J. Solà, J. Deray and D. Atchuthan, *A micro Lie theory for state estimation in robotics* (2018); the names are those of
//! Pinocchio's manual. Exponentials, their derivatives and what holds near 0, π and 2π: `crates/mechanics/spatial/src/exponential.rs`.
//!
//! Shapes: q has `nq` numbers, v has `nv`. Units: SI, angles in radians. Cost: O(n). Nothing here allocates, except the functions that return
//! a `Vec`.

use crate::{DimensionError, JointKind, Topology};
use featherbench_spatial::{Angle, Motion, Quaternion, Real, Vec3};

impl Topology {
    /// The neutral configuration into `q`: zeros, and quaternions without rotation.
    pub fn neutral<T: Real>(&self, q: &mut [T]) -> Result<(), DimensionError> {
        self.expect_q(q)?;
        q.fill(T::zero());
        for quaternion in self.quaternions() {
            q[quaternion + 3] = T::one();
        }
        Ok(())
    }

    /// `result = q ⊕ v`: where the velocity `v` leads from `q` in a unit of time. Quaternions come out with length one.
    ///
    /// ```
    /// use featherbench_model::{JointKind, Topology};
    /// let ball = Topology::new(&[(None, JointKind::Spherical)]).unwrap();
    /// let (mut q, mut v) = ([0.0; 4], [0.0; 3]);
    /// ball.integrate(&[0.0, 0.0, 0.0, 1.0], &[0.0, 0.0, std::f64::consts::PI], &mut q)?;
    /// assert!((q[2] - 1.0).abs() < 1e-15 && q[3].abs() < 1e-15, "half a turn about z");
    /// ball.difference(&[0.0, 0.0, 0.0, 1.0], &q, &mut v)?;
    /// assert!((v[2] - std::f64::consts::PI).abs() < 1e-15);
    /// # Ok::<(), featherbench_model::DimensionError>(())
    /// ```
    pub fn integrate<T: Angle>(&self, q: &[T], v: &[T], result: &mut [T]) -> Result<(), DimensionError> {
        self.expect_q(q)?;
        self.expect_v(v)?;
        self.expect_q(result)?;
        for joint in self.joints() {
            joint.kind.integrate(&q[joint.q..], &v[joint.v..], &mut result[joint.q..]);
        }
        Ok(())
    }

    /// `v = to ⊖ from`: the velocity that leads from `from` to `to` in a unit of time. Rotations take the shortest way, of at most π.
    pub fn difference<T: Angle>(&self, from: &[T], to: &[T], v: &mut [T]) -> Result<(), DimensionError> {
        self.expect_q(from)?;
        self.expect_q(to)?;
        self.expect_v(v)?;
        for joint in self.joints() {
            joint.kind.difference(&from[joint.q..], &to[joint.q..], &mut v[joint.v..]);
        }
        Ok(())
    }

    /// The configuration at the share `part` of the way between two: `from ⊕ part·(to ⊖ from)`.
    pub fn interpolate<T: Angle>(&self, from: &[T], to: &[T], part: T, result: &mut [T]) -> Result<(), DimensionError> {
        self.expect_q(from)?;
        self.expect_q(to)?;
        self.expect_q(result)?;
        for joint in self.joints() {
            let mut way = [T::zero(); 6];
            joint.kind.difference(&from[joint.q..], &to[joint.q..], &mut way);
            joint.kind.integrate(&from[joint.q..], &way.map(|x| x * part), &mut result[joint.q..]);
        }
        Ok(())
    }

    /// The length of `to ⊖ from`, radians and metres taken as equal.
    pub fn distance<T: Angle>(&self, from: &[T], to: &[T]) -> Result<T, DimensionError> {
        self.expect_q(from)?;
        self.expect_q(to)?;
        let mut square = T::zero();
        for joint in self.joints() {
            let mut way = [T::zero(); 6];
            joint.kind.difference(&from[joint.q..], &to[joint.q..], &mut way);
            square = way[..joint.kind.nv()].iter().fold(square, |square, x| x.mul_add(*x, square));
        }
        Ok(square.sqrt())
    }

    /// Gives each quaternion of `q` the length one. One shorter than 10⁻¹⁸ stands for no rotation, and becomes the identity.
    pub fn normalise<T: Angle>(&self, q: &mut [T]) -> Result<(), DimensionError> {
        self.expect_q(q)?;
        for at in self.quaternions() {
            let unit = quaternion(&q[at..]).normalised();
            q[at..at + 4].copy_from_slice(&unit.to_array());
        }
        Ok(())
    }

    /// Where the quaternions begin in q.
    pub fn quaternions(&self) -> impl Iterator<Item = usize> + '_ {
        self.joints().iter().filter_map(|joint| match joint.kind {
            JointKind::Spherical => Some(joint.q),
            JointKind::Free => Some(joint.q + 3),
            JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => None,
        })
    }

    pub(crate) fn expect_q<T>(&self, q: &[T]) -> Result<(), DimensionError> {
        DimensionError::expect("configuration q", self.nq(), q.len())
    }

    pub(crate) fn expect_v<T>(&self, v: &[T]) -> Result<(), DimensionError> {
        DimensionError::expect("velocity v", self.nv(), v.len())
    }
}

impl JointKind {
    /// `result = q ⊕ v` on this joint's numbers alone, which begin the slices.
    #[inline]
    pub fn integrate<T: Angle>(self, q: &[T], v: &[T], result: &mut [T]) {
        match self {
            Self::Revolute(_) | Self::Prismatic(_) | Self::Helical => result[0] = q[0] + v[0],
            Self::Spherical => {
                let turned = quaternion(q) * Quaternion::exp(vector(v));
                result[..4].copy_from_slice(&turned.normalised().to_array());
            }
            Self::Free => {
                let (turn, shift) = motion(v).exp();
                let before = quaternion(&q[3..]);
                let origin = before.to_rotation().mul_vec_add(shift, vector(q));
                result[..3].copy_from_slice(&origin.to_array());
                result[3..7].copy_from_slice(&(before * turn).normalised().to_array());
            }
        }
    }

    /// `v = to ⊖ from` on this joint's numbers alone, which begin the slices.
    #[inline]
    pub fn difference<T: Angle>(self, from: &[T], to: &[T], v: &mut [T]) {
        match self {
            Self::Revolute(_) | Self::Prismatic(_) | Self::Helical => v[0] = to[0] - from[0],
            Self::Spherical => {
                let turn = quaternion(from).conjugate() * quaternion(to);
                v[..3].copy_from_slice(&turn.log().to_array());
            }
            Self::Free => {
                let before = quaternion(&from[3..]);
                let shift = before.to_rotation().transpose_mul(vector(to) - vector(from));
                let way = Motion::log(before.conjugate() * quaternion(&to[3..]), shift);
                v[..3].copy_from_slice(&way.lin.to_array());
                v[3..6].copy_from_slice(&way.ang.to_array());
            }
        }
    }
}

/// The quaternion whose four numbers begin a slice.
#[inline(always)]
fn quaternion<T: Real>(q: &[T]) -> Quaternion<T> {
    Quaternion::from_array([q[0], q[1], q[2], q[3]])
}

/// The vector whose three numbers begin a slice.
#[inline(always)]
pub(crate) fn vector<T: Real>(v: &[T]) -> Vec3<T> {
    Vec3::new(v[0], v[1], v[2])
}

/// The motion of a free joint's velocity [linear; angular].
#[inline(always)]
pub(crate) fn motion<T: Real>(v: &[T]) -> Motion<T> {
    Motion::new(vector(&v[3..]), vector(v))
}

/// The neutral configuration of a tree; it allocates.
pub fn neutral<T: Real>(topology: &Topology) -> Vec<T> {
    let mut q = vec![T::zero(); topology.nq()];
    for at in topology.quaternions() {
        q[at + 3] = T::one();
    }
    q
}

/// `q ⊕ v` ([`Topology::integrate`]); it allocates.
pub fn integrate<T: Angle>(topology: &Topology, q: &[T], v: &[T]) -> Result<Vec<T>, DimensionError> {
    let mut result = vec![T::zero(); topology.nq()];
    topology.integrate(q, v, &mut result)?;
    Ok(result)
}

/// `to ⊖ from` ([`Topology::difference`]); it allocates.
pub fn difference<T: Angle>(topology: &Topology, from: &[T], to: &[T]) -> Result<Vec<T>, DimensionError> {
    let mut v = vec![T::zero(); topology.nv()];
    topology.difference(from, to, &mut v)?;
    Ok(v)
}

/// `from ⊕ part·(to ⊖ from)` ([`Topology::interpolate`]); it allocates.
pub fn interpolate<T: Angle>(topology: &Topology, from: &[T], to: &[T], part: T) -> Result<Vec<T>, DimensionError> {
    let mut result = vec![T::zero(); topology.nq()];
    topology.interpolate(from, to, part, &mut result)?;
    Ok(result)
}
