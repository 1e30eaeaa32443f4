//! Singular values by one-sided Jacobi rotations.
//!
//! Computes the singular values of a matrix, largest first: columns are turned in pairs until each pair is orthogonal; their lengths are
//! the singular values. Small ones are found to rounding of the largest, and often much better, so a rank can be read from them.
//! Source: Golub and Van Loan, *Matrix Computations* (4th edition), section 8.6; Demmel and Veselić (1992) for the accuracy.
//! Cost: about 6 sweeps of n² m multiply-adds for n columns. It allocates.

use nalgebra::DMatrix;

/// Sweeps: convergence is quadratic, and sixty are never needed for finite numbers.
const SWEEPS: usize = 60;

/// The singular values of a matrix, largest first: as many as its shorter side has. NaN where the matrix has NaN.
///
/// ```
/// use nalgebra::DMatrix;
/// let values = featherbench_constrained::singular_values(&DMatrix::from_row_slice(2, 3, &[3.0, 0.0, 0.0, 0.0, 0.0, 4.0]));
/// assert_eq!(values, [4.0, 3.0]);
/// ```
pub fn singular_values(matrix: &DMatrix<f64>) -> Vec<f64> {
    let mut a = if matrix.ncols() > matrix.nrows() { matrix.transpose() } else { matrix.clone() };
    let n = a.ncols();
    for _ in 0..SWEEPS {
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                let (alpha, beta, gamma) = (a.column(p).norm_squared(), a.column(q).norm_squared(), a.column(p).dot(&a.column(q)));
                if gamma == 0.0 || gamma.abs() <= f64::EPSILON * (alpha * beta).sqrt() {
                    continue;
                }
                turned = true;
                let zeta = (beta - alpha) / (2.0 * gamma);
                let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                let cosine = 1.0 / tangent.hypot(1.0);
                let sine = cosine * tangent;
                for row in 0..a.nrows() {
                    let (x, y) = (a[(row, p)], a[(row, q)]);
                    a[(row, p)] = cosine * x - sine * y;
                    a[(row, q)] = sine * x + cosine * y;
                }
            }
        }
        if !turned {
            break;
        }
    }
    let mut values: Vec<f64> = a.column_iter().map(|column| column.norm()).collect();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}
