//! A nominal model with a residual: its inverse and forward dynamics.
//!
//! - Inverse: τ = ID(q, v, a) + r(q, v, a).
//! - Forward, if r does not depend on a: a = FD(q, v, τ − r). One call.
//! - Forward, if it does: with a₀ = FD(q, v, τ) the equation is M (a − a₀) + r(q, v, a) = 0. Newton's method solves it with W = M + ∂r/∂a. An
//!   affine r takes one step, and a second that confirms it.
//!
//! Where r is exactly zero, the nominal model's answer is returned to the bit: nothing is added to it. So −0 stays −0.

use crate::error::{expect, finite};
use crate::residual::check;
use crate::{Nominal, Residual, ResidualError, State};
use nalgebra::{DMatrix, DVector};

/// The least reciprocal condition of the scaled W = M + ∂r/∂a that is accepted.
///
/// W is scaled by the diagonal of M, D^-½ W D^-½, so that units do not count. A solution loses log₁₀ of the inverse of this number of its 16
/// digits. At 10⁻¹² some four are left; below that the acceleration is made of rounding errors.
pub const WELL_POSED: f64 = 1e-12;

/// Newton steps before it gives up. It doubles the digits in each, so a start that converges takes fewer than ten.
const STEPS: usize = 50;

/// A step this small relative to the acceleration ends the iteration. The next would be its square, which is below rounding.
const LAST_STEP: f64 = 1e-11;

/// How well M + ∂r/∂a determines the acceleration at a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WellPosed {
    /// Smallest singular value of the scaled matrix, over the largest or 1 (that of M's scaled diagonal), whichever is more.
    pub reciprocal_condition: f64,
    /// The smallest eigenvalue of the symmetric part of the scaled matrix. If it is positive everywhere, the acceleration is unique.
    pub smallest_eigenvalue: f64,
}

impl WellPosed {
    /// Of a nominal mass matrix and ∂r/∂a.
    ///
    /// # Errors
    /// [`ResidualError::NotFinite`], [`ResidualError::Indefinite`] for an M without positive diagonal, [`ResidualError::IllPosed`] below
    /// [`WELL_POSED`].
    pub fn of(mass: &DMatrix<f64>, by_acceleration: &DMatrix<f64>) -> Result<Self, ResidualError> {
        let n = mass.nrows();
        expect("columns of M", n, mass.ncols())?;
        expect("rows of ∂r/∂a", n, by_acceleration.nrows())?;
        expect("columns of ∂r/∂a", n, by_acceleration.ncols())?;
        finite("the mass matrix M", mass.as_slice())?;
        finite("∂r/∂a", by_acceleration.as_slice())?;
        if let Some(smallest) = (0..n).map(|k| mass[(k, k)]).find(|&entry| entry <= 0.0) {
            return Err(ResidualError::Indefinite { what: "the mass matrix M", smallest });
        }
        let scale = |i: usize, j: usize| (mass[(i, i)] * mass[(j, j)]).sqrt();
        let scaled = DMatrix::from_fn(n, n, |i, j| (mass[(i, j)] + by_acceleration[(i, j)]) / scale(i, j));
        let symmetric = (&scaled + scaled.transpose()) * 0.5;
        let singular = scaled.svd(false, false).singular_values;
        let reciprocal_condition = if n == 0 { 1.0 } else { singular.min() / singular.max().max(1.0) };
        let smallest_eigenvalue = if n == 0 { 1.0 } else { symmetric.symmetric_eigenvalues().min() };
        if reciprocal_condition.is_nan() || reciprocal_condition < WELL_POSED {
            return Err(ResidualError::IllPosed { reciprocal_condition, threshold: WELL_POSED });
        }
        Ok(Self { reciprocal_condition, smallest_eigenvalue })
    }
}

/// A nominal model and its residual. The example is on the [crate page](crate).
#[derive(Clone, Debug)]
pub struct Corrected<N, R> {
    nominal: N,
    residual: R,
}

impl<N: Nominal, R: Residual> Corrected<N, R> {
    /// The nominal model, corrected.
    ///
    /// # Errors
    /// [`ResidualError::Dimension`] if the residual is for robots of another size.
    pub fn new(nominal: N, residual: R) -> Result<Self, ResidualError> {
        expect("dofs of the residual", nominal.nv(), residual.nv())?;
        if let Some(nq) = residual.nq() {
            expect("length of q of the residual", nominal.nq(), nq)?;
        }
        Ok(Self { nominal, residual })
    }

    /// The residual.
    pub fn residual(&self) -> &R {
        &self.residual
    }

    /// The nominal model.
    pub fn nominal(&mut self) -> &mut N {
        &mut self.nominal
    }

    /// The joint forces of an acceleration, without commands and inner state.
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit, or r has no single value.
    pub fn inverse(&mut self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<f64>, ResidualError> {
        self.inverse_of(&State::new(q, v, a))
    }

    /// The joint forces of a state.
    ///
    /// # Errors
    /// As [`Corrected::inverse`].
    pub fn inverse_of(&mut self, state: &State<'_>) -> Result<Vec<f64>, ResidualError> {
        expect("configuration q", self.nominal.nq(), state.q.len())?;
        let r = self.residual.value(state)?;
        let mut tau = vec![0.0; self.nominal.nv()];
        self.nominal.inverse(state.q, state.v, state.a, &mut tau)?;
        add_unless_zero(&mut tau, &r, 1.0);
        finite("joint forces τ", &tau)?;
        Ok(tau)
    }

    /// The acceleration under joint forces, which are also the command; without inner state.
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit, r has no single value, or the acceleration is not determined.
    pub fn forward(&mut self, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Vec<f64>, ResidualError> {
        self.forward_of(q, v, tau, &[])
    }

    /// The acceleration under joint forces, which are also the command, with an inner state.
    ///
    /// # Errors
    /// As [`Corrected::forward`].
    pub fn forward_of(&mut self, q: &[f64], v: &[f64], tau: &[f64], inner: &[f64]) -> Result<Vec<f64>, ResidualError> {
        let n = self.nominal.nv();
        expect("configuration q", self.nominal.nq(), q.len())?;
        expect("joint forces τ", n, tau.len())?;
        let still = vec![0.0; n];
        forward_under(&mut self.nominal, &self.residual, tau, &State::new(q, v, &still).with_command(tau).with_inner(inner))
    }

    /// How well the acceleration is determined at a state.
    ///
    /// # Errors
    /// [`ResidualError::IllPosed`] if it is not, and as [`Corrected::inverse`].
    pub fn well_posed(&mut self, state: &State<'_>) -> Result<WellPosed, ResidualError> {
        let by_acceleration = self.residual.by_acceleration(state)?;
        WellPosed::of(&self.nominal.mass_matrix(state.q)?, &by_acceleration)
    }
}

/// a with M a + h + r(q, v, a) = forces. The command of the state may be other forces: further residuals were taken off. Its `a` is not read.
pub(crate) fn forward_under<N: Nominal, R: Residual>(
    nominal: &mut N,
    residual: &R,
    forces: &[f64],
    state: &State<'_>,
) -> Result<Vec<f64>, ResidualError> {
    let mut a = vec![0.0; nominal.nv()];
    let state = State { a: &vec![0.0; nominal.nv()], ..*state };
    if !residual.has_acceleration() {
        let mut rest = forces.to_vec();
        add_unless_zero(&mut rest, &residual.value(&state)?, -1.0);
        nominal.forward(state.q, state.v, &rest, &mut a)?;
        finite("acceleration a", &a)?;
        return Ok(a);
    }
    check(residual, &state)?;
    nominal.forward(state.q, state.v, forces, &mut a)?;
    finite("acceleration a", &a)?;
    let mass = nominal.mass_matrix(state.q)?;
    corrected_acceleration(residual, &mass, &a, &state)
}

/// The acceleration with a residual, from that of the nominal model: solves M (a − a₀) + r(q, v, a) = 0 by Newton's method from a₀, `free`.
///
/// So a residual can correct any engine that tells its forward dynamics a₀ and its mass matrix M. Where r(a₀) is zero, a₀ comes back to the bit. Of
/// the state, `a` is not read.
///
/// # Errors
/// [`ResidualError`] when an argument does not fit, r has no single value, or the acceleration is not determined or not found.
pub fn corrected_acceleration<R: Residual + ?Sized>(
    residual: &R,
    mass: &DMatrix<f64>,
    free: &[f64],
    state: &State<'_>,
) -> Result<Vec<f64>, ResidualError> {
    let mut a = free.to_vec();
    let free = DVector::from_column_slice(free);
    let mut left = 0.0;
    for _ in 0..STEPS {
        let state = State { a: &a, ..*state };
        let r = DVector::from_vec(residual.value(&state)?);
        let by_acceleration = residual.by_acceleration(&state)?;
        WellPosed::of(mass, &by_acceleration)?;
        let now = DVector::from_column_slice(&a);
        // a₀ solves it exactly where r is zero.
        let inertial = mass * (&now - &free);
        let error = &inertial + &r;
        if error.iter().all(|&x| x == 0.0) {
            return Ok(a);
        }
        left = error.amax() / inertial.amax().max(r.amax());
        let Some(step) = (mass + by_acceleration).lu().solve(&error) else {
            return Err(ResidualError::IllPosed { reciprocal_condition: 0.0, threshold: WELL_POSED });
        };
        a.iter_mut().zip(&step).for_each(|(a, step)| *a -= step);
        finite("acceleration a", &a)?;
        if step.amax() <= LAST_STEP * now.amax().max(free.amax()) {
            return Ok(a);
        }
    }
    Err(ResidualError::NotConverged { iterations: STEPS, residual: left })
}

/// A corrected model is one again, for a further residual such as dry friction. Its mass matrix is M + ∂r/∂a at rest; so r must be affine in a,
/// and ∂r/∂a must not depend on the velocity.
impl<N: Nominal, R: Residual> Nominal for Corrected<N, R> {
    fn nq(&self) -> usize {
        self.nominal.nq()
    }

    fn nv(&self) -> usize {
        self.nominal.nv()
    }

    fn inverse(&mut self, q: &[f64], v: &[f64], a: &[f64], tau: &mut [f64]) -> Result<(), ResidualError> {
        expect("joint forces τ", self.nominal.nv(), tau.len())?;
        tau.copy_from_slice(&Corrected::inverse(self, q, v, a)?);
        Ok(())
    }

    fn forward(&mut self, q: &[f64], v: &[f64], tau: &[f64], a: &mut [f64]) -> Result<(), ResidualError> {
        expect("acceleration a", self.nominal.nv(), a.len())?;
        a.copy_from_slice(&Corrected::forward(self, q, v, tau)?);
        Ok(())
    }

    fn mass_matrix(&mut self, q: &[f64]) -> Result<DMatrix<f64>, ResidualError> {
        let rest = vec![0.0; self.nominal.nv()];
        Ok(self.nominal.mass_matrix(q)? + self.residual.by_acceleration(&State::new(q, &rest, &rest))?)
    }
}

/// Adds `sign · r` to `forces`, and leaves their bits where r is zero: −0 + 0 would be +0.
pub fn add_unless_zero(forces: &mut [f64], r: &[f64], sign: f64) {
    for (force, &r) in forces.iter_mut().zip(r).filter(|(_, r)| **r != 0.0) {
        *force += sign * r;
    }
}
