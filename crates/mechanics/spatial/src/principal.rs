//! Principal axes of a symmetric matrix.

use crate::{Mat3, Sym3};

/// Sweeps over the three pairs of axes: each squares what is left off the diagonal, so that five reach rounding from anywhere.
const SWEEPS: usize = 12;

impl Sym3<f64> {
    /// Moments and axes: `S = R diag(moments) Rᵀ`, where the columns of the rotation `R` are the axes. Of a diagonal matrix they are its
    /// own, in its order. By Jacobi's rotations (Golub & Van Loan, *Matrix Computations*, 4th ed., algorithm 8.5.3).
    ///
    /// ```
    /// use featherbench_spatial::Sym3;
    /// let (moments, axes) = Sym3::from_array([2.0, 1.0, 0.0, 2.0, 0.0, 5.0]).principal();
    /// assert!((moments[0] - 1.0).abs() < 1e-15 && (moments[1] - 3.0).abs() < 1e-15 && moments[2] == 5.0);
    /// assert!((axes.x.x * axes.x.x - 0.5).abs() < 1e-15);
    /// ```
    pub fn principal(self) -> ([f64; 3], Mat3<f64>) {
        let mut a = [[self.xx, self.xy, self.xz], [self.xy, self.yy, self.yz], [self.xz, self.yz, self.zz]];
        let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for _ in 0..SWEEPS {
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                if a[p][q] == 0.0 {
                    continue;
                }
                let half = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let tangent = half.signum() / (half.abs() + half.hypot(1.0));
                let (cosine, sine) = (1.0 / tangent.hypot(1.0), tangent / tangent.hypot(1.0));
                let turn = |x: f64, y: f64| [cosine * x - sine * y, sine * x + cosine * y];
                for row in a.iter_mut().chain(&mut axes) {
                    [row[p], row[q]] = turn(row[p], row[q]);
                }
                let (upper, lower) = (a[p], a[q]);
                for (k, (x, y)) in upper.into_iter().zip(lower).enumerate() {
                    [a[p][k], a[q][k]] = turn(x, y);
                }
                (a[p][q], a[q][p]) = (0.0, 0.0);
            }
        }
        ([a[0][0], a[1][1], a[2][2]], Mat3::from_array(std::array::from_fn(|k| axes[k / 3][k % 3])))
    }
}
