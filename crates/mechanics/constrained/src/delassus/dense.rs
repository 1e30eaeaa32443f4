//! The Delassus matrix by a dense factorization of M, in any scalar.
//!
//! Computes `M = L Lᵀ`, `Y = L⁻¹ Jᵀ`, `G = Yᵀ Y`. Source: Golub and Van Loan, *Matrix Computations* (4th edition), sections 4.2 (Cholesky) and 3.1
//! (triangular systems). It knows nothing of the tree: no zero is used. It allocates.

use crate::error::Error;
use featherbench_dynamics::{DimensionError, NotPositiveDefinite, TreeSparse};
use featherbench_spatial::Real;
use nalgebra::{DMatrix, Scalar};

/// G from J (m rows of n numbers, row after row) and M.
///
/// # Errors
/// [`Error`]: J is no whole number of rows, or M is not positive definite.
pub fn dense<T: Real + Scalar>(jacobian: &[T], mass: &TreeSparse<T>) -> Result<DMatrix<T>, Error> {
    let n = mass.size();
    let rows = jacobian.len().checked_div(n).unwrap_or(0);
    DimensionError::expect("numbers of the Jacobian", rows * n, jacobian.len())?;
    let lower = cholesky(mass)?;
    // A row of J is a column of Jᵀ.
    let mut half = DMatrix::from_column_slice(n, rows, jacobian);
    half.column_iter_mut().for_each(|mut column| forward(&lower, column.as_mut_slice()));
    Ok(gram(&half))
}

/// L with L Lᵀ = M, in the lower triangle.
pub(crate) fn cholesky<T: Real + Scalar>(mass: &TreeSparse<T>) -> Result<DMatrix<T>, Error> {
    let n = mass.size();
    let mut lower = DMatrix::from_element(n, n, T::zero());
    for column in 0..n {
        for row in column..n {
            let sum = (0..column).fold(mass.get(row, column), |sum, k| (-lower[(row, k)]).mul_add(lower[(column, k)], sum));
            if row == column {
                let pivot = sum.min_lane();
                if pivot.is_nan() || pivot <= 0.0 {
                    return Err(NotPositiveDefinite { dof: column, pivot }.into());
                }
                lower[(row, column)] = sum.sqrt();
            } else {
                lower[(row, column)] = sum / lower[(column, column)];
            }
        }
    }
    Ok(lower)
}

/// x ← L⁻¹x.
pub(crate) fn forward<T: Real + Scalar>(lower: &DMatrix<T>, x: &mut [T]) {
    for row in 0..x.len() {
        let sum = (0..row).fold(x[row], |sum, k| (-lower[(row, k)]).mul_add(x[k], sum));
        x[row] = sum / lower[(row, row)];
    }
}

/// `YᵀY`, each pair of columns once.
pub(super) fn gram<T: Real + Scalar>(half: &DMatrix<T>) -> DMatrix<T> {
    let rows = half.ncols();
    let mut g = DMatrix::from_element(rows, rows, T::zero());
    for a in 0..rows {
        for b in 0..=a {
            let sum = half.column(a).iter().zip(half.column(b).iter()).fold(T::zero(), |sum, (x, y)| x.mul_add(*y, sum));
            (g[(a, b)], g[(b, a)]) = (sum, sum);
        }
    }
    g
}
