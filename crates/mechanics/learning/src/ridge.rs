//! Ridge regression: min |A x − b|² + λ |A|² |x|², by an orthogonal factorization.
//!
//! The factorization of [A; √λ |A| I] has the condition of A, not its square as AᵀA has. |A|² is the mean square of the columns of A: so λ has no
//! unit. Cost: O(rows · columns²).

use crate::ResidualError;
use nalgebra::DMatrix;

/// The solutions for each column of `b`.
///
/// # Errors
/// [`ResidualError::Learning`] if a number is not finite, λ is not positive, or there is no equation.
pub(crate) fn ridge(a: &DMatrix<f64>, b: &DMatrix<f64>, lambda: f64) -> Result<DMatrix<f64>, ResidualError> {
    let refuse = |reason: &str| Err(ResidualError::Learning(reason.into()));
    let (rows, columns) = a.shape();
    if rows == 0 || columns == 0 || b.nrows() != rows {
        return refuse("there are no equations");
    }
    if !(lambda.is_finite() && lambda > 0.0) {
        return refuse("the weight λ of the ridge must be positive and finite");
    }
    if !a.iter().chain(b.iter()).all(|x| x.is_finite()) {
        return refuse("a number of the samples is not finite");
    }
    let weight = (lambda / columns as f64).sqrt() * a.norm();
    let mut left = DMatrix::zeros(rows + columns, columns);
    left.view_mut((0, 0), (rows, columns)).copy_from(a);
    (0..columns).for_each(|k| left[(rows + k, k)] = weight);
    let mut right = DMatrix::zeros(rows + columns, b.ncols());
    right.view_mut((0, 0), (rows, b.ncols())).copy_from(b);
    let factors = left.qr();
    factors.q_tr_mul(&mut right);
    let solution = factors.r().solve_upper_triangular(&right.rows(0, columns).into_owned());
    solution.ok_or_else(|| ResidualError::Learning("the equations of the ridge are singular; is a column zero and λ too small?".into()))
}
