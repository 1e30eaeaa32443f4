//! How fast first-order methods converge: predicted from the matrix, and fitted from the steps of a run.

use crate::problem::Problem;
use nalgebra::{DMatrix, SymmetricEigen};

/// The factor by which the error of Gauss–Seidel falls each sweep while every row stays active: the spectral radius of (D + L)⁻¹ U.
///
/// None if a diagonal entry is not positive.
pub fn gauss_seidel(problem: &Problem) -> Option<f64> {
    let matrix = problem.delassus();
    let size = matrix.nrows();
    if !matrix.diagonal().iter().all(|entry| *entry > 0.0) {
        return None;
    }
    let lower = DMatrix::from_fn(size, size, |row, column| if column <= row { matrix[(row, column)] } else { 0.0 });
    let upper = DMatrix::from_fn(size, size, |row, column| if column > row { matrix[(row, column)] } else { 0.0 });
    let iteration = lower.solve_lower_triangular(&upper)?;
    let sizes = iteration.complex_eigenvalues();
    Some(sizes.iter().map(|value| value.re.hypot(value.im)).fold(0.0, featherbench_spatial::larger))
}

/// The factor by which the error of ADMM falls each iteration while every contact stays inside its cone: ρ/(ρ + λ_min).
///
/// λ_min is the smallest eigenvalue of G divided by the largest diagonal entry, `rho` is in the same unit; see [`crate::Admm::rho`].
/// So this is for contacts without friction, or with μ = 1, where the solver's axes are the problem's.
pub fn admm(problem: &Problem, rho: f64) -> f64 {
    let largest = problem.delassus().diagonal().amax();
    let smallest = SymmetricEigen::new(problem.delassus() / largest).eigenvalues.min();
    rho / (rho + smallest)
}

/// The factor from one step to the next, fitted to the last half of the steps that rounding does not yet disturb.
///
/// The fit is a least-squares line through the logarithms. None if fewer than eight steps are usable.
pub fn fitted(steps: &[f64]) -> Option<f64> {
    let first = steps.first().copied()?;
    // Steps below 1e-12 of the first are rounding.
    let usable = steps.iter().take_while(|step| **step > 1e-12 * first && step.is_finite()).count();
    let window = &steps[usable / 2..usable];
    if window.len() < 8 {
        return None;
    }
    let count = window.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let logs: Vec<f64> = window.iter().map(|step| step.ln()).collect();
    let mean = logs.iter().sum::<f64>() / count;
    let (mut products, mut squares) = (0.0, 0.0);
    for (k, log) in logs.iter().enumerate() {
        let place = k as f64 - middle;
        products += place * (log - mean);
        squares += place * place;
    }
    Some((products / squares).exp())
}
