//! Derivatives of steps and differences on the tangent spaces: the Jacobians of `q ⊕ v` and of `q₁ ⊖ q₀`.
//!
//! A tangent vector δ at q stands for the configuration q ⊕ δ. The maps, with ξ = v and ξ = q₁ ⊖ q₀:
//!
//! | of | with respect to | map | for a one-dof joint |
//! |---|---|---|---|
//! | q ⊕ v | q | Ad(exp ξ)⁻¹, which transports tangent vectors from q to q ⊕ v | 1 |
//! | q ⊕ v | v | J(ξ), the right Jacobian | 1 |
//! | q₁ ⊖ q₀ | q₁ | J(ξ)⁻¹ | 1 |
//! | q₁ ⊖ q₀ | q₀ | −J(−ξ)⁻¹ | −1 |
//!
//! Each is block-diagonal: a block of nv × nv numbers per joint, as [`TangentMap`] keeps it. None depends on q itself.
//! The first follows from `exp(δ) exp(ξ) = exp(ξ) exp(Ad(exp ξ)⁻¹ δ)`, the last from `(q₀ exp δ)⁻¹ q₁ = exp(−δ) exp(ξ)`.
//!
//! Source: J. Solà, J. Deray and D. Atchuthan, *A micro Lie theory for state estimation in robotics* (2018), equations 80–83.
//! Shapes: vectors have `nv` numbers; free joints [linear; angular]. Units: radians and metres. Cost: O(n). Only `new` and
//! [`TangentMap::to_dense`] allocate.

use crate::configuration::{motion, vector};
use crate::{DimensionError, JointKind, Topology, difference};
use featherbench_spatial::{Angle, Dual, Mat3, Motion, Quaternion, Real, TangentBlock, Vec3};

/// A block-diagonal linear map between tangent spaces: one nv × nv block per joint.
///
/// ```
/// use featherbench_model::{JointKind, TangentMap, Topology};
/// let ball = Topology::new(&[(None, JointKind::Spherical)]).unwrap();
/// // After a quarter of a turn about z, what was x is −y of the body.
/// let mut map = TangentMap::new(&ball);
/// map.d_integrate_q(&[0.0, 0.0, std::f64::consts::FRAC_PI_2])?;
/// let mut carried = [0.0; 3];
/// map.mul(&[1.0, 0.0, 0.0], &mut carried)?;
/// assert!(carried[0].abs() < 1e-15 && (carried[1] + 1.0).abs() < 1e-15);
/// # Ok::<(), featherbench_model::DimensionError>(())
/// ```
#[derive(Clone, Debug)]
pub struct TangentMap<T> {
    /// Kind and first dof of each joint.
    joints: Vec<(JointKind, usize)>,
    /// The blocks one after another, each row after row.
    values: Vec<T>,
    nv: usize,
}

impl<T: Real> TangentMap<T> {
    /// The identity on the tangent spaces of a tree.
    pub fn new(topology: &Topology) -> Self {
        let joints: Vec<_> = topology.joints().iter().map(|joint| (joint.kind, joint.v)).collect();
        let numbers = joints.iter().map(|(kind, _)| kind.nv() * kind.nv()).sum();
        let mut map = Self { joints, values: vec![T::zero(); numbers], nv: topology.nv() };
        map.each(|kind, _, block| (0..kind.nv()).for_each(|k| block[k * (kind.nv() + 1)] = T::one()));
        map
    }

    /// The block of a joint, row after row.
    pub fn block(&self, joint: usize) -> &[T] {
        let size = |(kind, _): &(JointKind, usize)| kind.nv() * kind.nv();
        let start = self.joints[..joint].iter().map(size).sum::<usize>();
        &self.values[start..start + size(&self.joints[joint])]
    }

    /// `result = map · x`.
    pub fn mul(&self, x: &[T], result: &mut [T]) -> Result<(), DimensionError> {
        self.product(x, result, |row, column, n| row * n + column)
    }

    /// `result = mapᵀ · x`: what a cost's gradient takes on its way back.
    pub fn transpose_mul(&self, x: &[T], result: &mut [T]) -> Result<(), DimensionError> {
        self.product(x, result, |row, column, n| column * n + row)
    }

    /// The full nv × nv matrix, row after row; it allocates.
    pub fn to_dense(&self) -> Vec<T> {
        let mut all = vec![T::zero(); self.nv * self.nv];
        let mut start = 0;
        for &(kind, v) in &self.joints {
            let n = kind.nv();
            for row in 0..n {
                all[(v + row) * self.nv + v..][..n].copy_from_slice(&self.values[start + row * n..][..n]);
            }
            start += n * n;
        }
        all
    }

    fn product(&self, x: &[T], result: &mut [T], entry: impl Fn(usize, usize, usize) -> usize) -> Result<(), DimensionError> {
        DimensionError::expect("tangent vector", self.nv, x.len())?;
        DimensionError::expect("result", self.nv, result.len())?;
        let mut start = 0;
        for &(kind, v) in &self.joints {
            let n = kind.nv();
            for row in 0..n {
                let sum = |sum: T, column: usize| self.values[start + entry(row, column, n)].mul_add(x[v + column], sum);
                result[v + row] = (0..n).fold(T::zero(), sum);
            }
            start += n * n;
        }
        Ok(())
    }

    /// Calls a function with the kind, the first dof and the block of each joint.
    fn each(&mut self, mut set: impl FnMut(JointKind, usize, &mut [T])) {
        let mut rest = self.values.as_mut_slice();
        for &(kind, v) in &self.joints {
            let (block, after) = rest.split_at_mut(kind.nv() * kind.nv());
            set(kind, v, block);
            rest = after;
        }
    }
}

impl<T: Angle> TangentMap<T> {
    /// The derivative of `q ⊕ v` with respect to q. It transports tangent vectors from q to q ⊕ v.
    pub fn d_integrate_q(&mut self, v: &[T]) -> Result<(), DimensionError> {
        let turned = |omega| Quaternion::exp(omega).to_rotation().transpose();
        self.fill(v, T::one(), T::one(), turned, Motion::carried)
    }

    /// The derivative of `q ⊕ v` with respect to v.
    pub fn d_integrate_v(&mut self, v: &[T]) -> Result<(), DimensionError> {
        self.fill(v, T::one(), T::one(), Vec3::right_jacobian, Motion::right_jacobian)
    }

    /// The derivative of `v = q₁ ⊖ q₀` with respect to q₁, from v.
    pub fn d_difference_to(&mut self, v: &[T]) -> Result<(), DimensionError> {
        self.fill(v, T::one(), T::one(), Vec3::inverse_right_jacobian, Motion::inverse_right_jacobian)
    }

    /// The derivative of `v = q₁ ⊖ q₀` with respect to q₀, from v.
    pub fn d_difference_from(&mut self, v: &[T]) -> Result<(), DimensionError> {
        self.fill(v, -T::one(), -T::one(), Vec3::inverse_right_jacobian, Motion::inverse_right_jacobian)
    }

    /// The derivative of [`Topology::step_rate`] with respect to the step, for this step and velocity; by dual numbers, block by block.
    pub fn d_step_rate(&mut self, step: &[T], v: &[T]) -> Result<(), DimensionError> {
        DimensionError::expect("step", self.nv, step.len())?;
        DimensionError::expect("velocity v", self.nv, v.len())?;
        self.each(|kind, dof, block| {
            let n = kind.nv();
            let mut constant = [Dual::constant(T::zero()); 6];
            for (constant, v) in constant[..n].iter_mut().zip(&v[dof..]) {
                *constant = Dual::constant(*v);
            }
            for column in 0..n {
                let (mut moving, mut rate) = ([Dual::constant(T::zero()); 6], [Dual::constant(T::zero()); 6]);
                for (k, (moving, step)) in moving[..n].iter_mut().zip(&step[dof..]).enumerate() {
                    *moving = Dual::new(*step, if k == column { T::one() } else { T::zero() });
                }
                kind.step_rate(&moving, &constant, &mut rate);
                for row in 0..n {
                    block[row * n + column] = rate[row].derivative;
                }
            }
        });
        Ok(())
    }

    /// Fills the blocks: `factor` for one-dof joints, and `factor` times the matrices of `sign · v` for the others.
    fn fill(
        &mut self,
        v: &[T],
        factor: T,
        sign: T,
        of_turn: impl Fn(Vec3<T>) -> Mat3<T>,
        of_motion: impl Fn(Motion<T>) -> TangentBlock<T>,
    ) -> Result<(), DimensionError> {
        DimensionError::expect("velocity v", self.nv, v.len())?;
        self.each(|kind, dof, block| {
            match kind {
                JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => block[0] = T::one(),
                JointKind::Spherical => block.copy_from_slice(&of_turn(vector(&v[dof..]) * sign).to_array()),
                JointKind::Free => block.copy_from_slice(&of_motion(motion(&v[dof..]) * sign).to_array()),
            }
            block.iter_mut().for_each(|x| *x *= factor);
        });
        Ok(())
    }
}

impl Topology {
    /// The rate of a step ξ whose end q ⊕ ξ moves with velocity v: `ξ̇ = J(ξ)⁻¹ v`. Integrators solve this equation for ξ, which lives in a
    /// vector space.
    pub fn step_rate<T: Angle>(&self, step: &[T], v: &[T], rate: &mut [T]) -> Result<(), DimensionError> {
        self.expect_v(step)?;
        self.expect_v(v)?;
        self.expect_v(rate)?;
        for joint in self.joints() {
            joint.kind.step_rate(&step[joint.v..], &v[joint.v..], &mut rate[joint.v..]);
        }
        Ok(())
    }
}

impl JointKind {
    /// [`Topology::step_rate`] of this joint, whose numbers begin the slices.
    #[inline]
    fn step_rate<T: Angle>(self, step: &[T], v: &[T], rate: &mut [T]) {
        match self {
            Self::Revolute(_) | Self::Prismatic(_) | Self::Helical => rate[0] = v[0],
            Self::Spherical => {
                let omega = vector(step).inverse_right_jacobian_mul(vector(v));
                rate[..3].copy_from_slice(&omega.to_array());
            }
            Self::Free => {
                let m = motion(step).inverse_right_jacobian_mul(motion(v));
                rate[..3].copy_from_slice(&m.lin.to_array());
                rate[3..6].copy_from_slice(&m.ang.to_array());
            }
        }
    }
}

/// The derivatives of `q ⊕ v` with respect to q and to v; it allocates.
pub fn d_integrate<T: Angle>(topology: &Topology, v: &[T]) -> Result<[TangentMap<T>; 2], DimensionError> {
    let (mut by_q, mut by_v) = (TangentMap::new(topology), TangentMap::new(topology));
    by_q.d_integrate_q(v)?;
    by_v.d_integrate_v(v)?;
    Ok([by_q, by_v])
}

/// The derivatives of `to ⊖ from` with respect to `from` and to `to`; it allocates.
pub fn d_difference<T: Angle>(topology: &Topology, from: &[T], to: &[T]) -> Result<[TangentMap<T>; 2], DimensionError> {
    let v = difference(topology, from, to)?;
    let (mut by_from, mut by_to) = (TangentMap::new(topology), TangentMap::new(topology));
    by_from.d_difference_from(&v)?;
    by_to.d_difference_to(&v)?;
    Ok([by_from, by_to])
}
