//! The tangent stiffness: the derivative of the static residual r(s) = inverse dynamics at rest, less the loads.
//!
//! K_T = ∂r/∂s on the tangent space of s, by dual numbers: exact to rounding, gravity and loads included. Dead loads and gravity have a
//! potential, and K_T is then symmetric; follower loads have none.

use crate::{Continuum, Load, SolveError, Solver};
use featherbench_spatial::{Angle, DoubleDouble, Dual, Lift};
use nalgebra::{DMatrix, DVector};

/// The residual of an equilibrium, r(s).
///
/// # Errors
/// [`SolveError`] as [`Solver::inverse`].
pub fn residual(continuum: &Continuum, s: &[f64], loads: &[Load]) -> Result<DVector<f64>, SolveError> {
    let zeros = vec![0.0; continuum.topology().nv()];
    let mut result = DVector::zeros(zeros.len());
    Solver::new(continuum).inverse(continuum, s, &zeros, &zeros, loads, result.as_mut_slice())?;
    Ok(result)
}

/// The tangent stiffness matrix K_T at `s`; it allocates.
///
/// # Errors
/// [`SolveError`] as [`Solver::inverse`].
pub fn tangent_stiffness(continuum: &Continuum, s: &[f64], loads: &[Load]) -> Result<DMatrix<f64>, SolveError> {
    let nv = continuum.topology().nv();
    let mut solver: Solver<Dual<f64>> = Solver::new(continuum);
    let mut matrix = DMatrix::zeros(nv, nv);
    let mut direction = vec![0.0; nv];
    for j in 0..nv {
        direction[j] = 1.0;
        let column = along(&mut solver, continuum, s, &direction, loads)?;
        direction[j] = 0.0;
        matrix.column_mut(j).copy_from(&DVector::from_vec(column));
    }
    Ok(matrix)
}

/// The mass matrix at `s`, dense; it allocates.
///
/// # Errors
/// [`SolveError`] when `s` does not fit.
pub fn mass_matrix(continuum: &Continuum, s: &[f64]) -> Result<DMatrix<f64>, SolveError> {
    Ok(Solver::new(continuum).mass(continuum, s)?.to_dense())
}

/// K_T times a direction.
fn along<T: Angle>(
    solver: &mut Solver<Dual<T>>,
    continuum: &Continuum,
    s: &[f64],
    direction: &[T],
    loads: &[Load],
) -> Result<Vec<T>, SolveError>
where
    f64: Lift<Dual<T>>,
{
    let topology = continuum.topology();
    let base: Vec<Dual<T>> = s.iter().map(|s| Dual::constant(T::from_f64(*s))).collect();
    let step: Vec<Dual<T>> = direction.iter().map(|d| Dual::new(T::zero(), *d)).collect();
    let zeros = vec![Dual::constant(T::zero()); topology.nv()];
    let (mut moved, mut out) = (base.clone(), zeros.clone());
    topology.integrate(&base, &step, &mut moved)?;
    solver.inverse(continuum, &moved, &zeros, &zeros, loads, &mut out)?;
    Ok(out.into_iter().map(|out| out.derivative).collect())
}

/// Rayleigh's quotient φᵀ K_T φ / φᵀ M φ of directions, in double-double: of an eigenvector with an error ε its error is of order ε².
pub(crate) struct Rayleigh {
    stiff: Solver<Dual<DoubleDouble>>,
    heavy: Solver<DoubleDouble>,
}

impl Rayleigh {
    pub(crate) fn new(continuum: &Continuum) -> Self {
        Self { stiff: Solver::new(continuum), heavy: Solver::new(continuum) }
    }

    pub(crate) fn quotient(&mut self, continuum: &Continuum, s: &[f64], direction: &[f64], loads: &[Load]) -> Result<f64, SolveError> {
        let direction: Vec<DoubleDouble> = direction.iter().map(|x| DoubleDouble::from(*x)).collect();
        let wide: Vec<DoubleDouble> = s.iter().map(|x| DoubleDouble::from(*x)).collect();
        let stiff = along(&mut self.stiff, continuum, s, &direction, loads)?;
        let mut heavy = stiff.clone();
        self.heavy.mass_times(continuum, &wide, &direction, &mut heavy)?;
        let product = |x: &[DoubleDouble]| direction.iter().zip(x).fold(DoubleDouble::from(0.0), |sum, (d, x)| sum + *d * *x);
        Ok((product(&stiff) / product(&heavy)).to_f64())
    }
}
