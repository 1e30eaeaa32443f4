//! Vibrations about an equilibrium: K_T φ = ω² M φ.
//!
//! Method: M = L Lᵀ (Cholesky), then the symmetric eigenproblem of L⁻¹ K_T L⁻ᵀ. Each ω² is then Rayleigh's quotient of its φ in
//! double-double. So its error is of second order in that of φ, and small eigenvalues keep their digits beside large ones.

use crate::tangent::{Rayleigh, mass_matrix, tangent_stiffness};
use crate::{Continuum, Load, SolveError};
use nalgebra::{DMatrix, SymmetricEigen};

/// The vibrations about an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// ω², increasing, rad²/s². A free robot has zeros; a negative one means that the equilibrium is unstable.
    pub squares: Vec<f64>,
    /// The shapes φ, as columns, with φᵀ M φ = 1.
    pub shapes: DMatrix<f64>,
}

impl Modes {
    /// The angular frequencies ω, increasing, rad/s; NaN where ω² is negative.
    pub fn frequencies(&self) -> Vec<f64> {
        self.squares.iter().map(|square| square.sqrt()).collect()
    }
}

/// The modes at the equilibrium `s` under loads; it allocates.
///
/// # Errors
/// [`SolveError`]: an argument does not fit, or M is not positive definite.
pub fn modes(continuum: &Continuum, s: &[f64], loads: &[Load]) -> Result<Modes, SolveError> {
    let stiffness = tangent_stiffness(continuum, s, loads)?;
    let mass = mass_matrix(continuum, s)?;
    let (_, shapes) = generalized(&stiffness, &mass)?;
    let mut rayleigh = Rayleigh::new(continuum);
    let columns = shapes.column_iter().map(|shape| rayleigh.quotient(continuum, s, shape.as_slice(), loads));
    let squares = columns.collect::<Result<Vec<f64>, _>>()?;
    Ok(Modes { squares, shapes })
}

/// The eigenvalues, increasing, and eigenvectors of K φ = λ M φ, from the symmetric part of K; it allocates.
///
/// # Errors
/// [`SolveError::NotPositiveDefinite`] when M is not, or a number of a matrix is not finite.
pub fn generalized(stiffness: &DMatrix<f64>, mass: &DMatrix<f64>) -> Result<(Vec<f64>, DMatrix<f64>), SolveError> {
    let indefinite = || {
        let eigenvalue = SymmetricEigen::new(mass.clone()).eigenvalues.min();
        SolveError::NotPositiveDefinite { matrix: "mass", eigenvalue }
    };
    // Iterations on NaN need not end.
    for (matrix, name) in [(mass, "mass"), (stiffness, "stiffness")] {
        if matrix.iter().any(|x| !x.is_finite()) {
            return Err(SolveError::NotPositiveDefinite { matrix: name, eigenvalue: f64::NAN });
        }
    }
    let lower = mass.clone().cholesky().ok_or_else(indefinite)?.l();
    let symmetric = (stiffness + stiffness.transpose()) * 0.5;
    // L⁻¹ K L⁻ᵀ
    let half = lower.solve_lower_triangular(&symmetric).ok_or_else(indefinite)?;
    let both = lower.solve_lower_triangular(&half.transpose()).ok_or_else(indefinite)?;
    let eigen = SymmetricEigen::new((&both + both.transpose()) * 0.5);
    let mut order: Vec<usize> = (0..mass.nrows()).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    let sorted = DMatrix::from_fn(mass.nrows(), mass.nrows(), |i, j| eigen.eigenvectors[(i, order[j])]);
    let shapes = lower.tr_solve_lower_triangular(&sorted).ok_or_else(indefinite)?;
    Ok((order.into_iter().map(|k| eigen.eigenvalues[k]).collect(), shapes))
}
