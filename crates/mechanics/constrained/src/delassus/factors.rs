//! The Delassus matrix by the tree-sparse factors of M.
//!
//! Computes `M = RᵀR` with `R = D^½ L`, then `Y = R⁻ᵀ Jᵀ` by one half of a solution per row, then `G = Yᵀ Y`.
//! Source: the book, section 6.5 (branch-induced sparsity), and chapter 8. It allocates Y and G.

use super::dense::gram;
use crate::error::Error;
use featherbench_dynamics::{DimensionError, Ltdl};
use featherbench_spatial::Real;
use nalgebra::{DMatrix, Scalar};

/// `Y = R⁻ᵀ Jᵀ`: one column of n numbers per row of J. Its columns have the lengths and angles of the rows in the metric of M⁻¹.
///
/// # Errors
/// [`Error::Dimension`] when J is no whole number of rows.
pub fn half_solved<T: Real + Scalar>(jacobian: &[T], factors: &Ltdl<T>) -> Result<DMatrix<T>, Error> {
    let n = factors.factors().size();
    let rows = jacobian.len().checked_div(n).unwrap_or(0);
    DimensionError::expect("numbers of the Jacobian", rows * n, jacobian.len())?;
    // A row of J is a column of Jᵀ, and columns are contiguous.
    let mut half = DMatrix::from_column_slice(n, rows, jacobian);
    for column in half.as_mut_slice().chunks_exact_mut(n.max(1)) {
        factors.solve_root_transposed(column)?;
    }
    Ok(half)
}

/// G from J (m rows of n numbers, row after row) and the factors of M.
///
/// # Errors
/// [`Error::Dimension`] when J is no whole number of rows.
pub fn by_factors<T: Real + Scalar>(jacobian: &[T], factors: &Ltdl<T>) -> Result<DMatrix<T>, Error> {
    Ok(gram(&half_solved(jacobian, factors)?))
}
