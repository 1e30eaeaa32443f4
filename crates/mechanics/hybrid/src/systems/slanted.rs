//! A ball between slanted walls, in the plane.

use crate::system::Hybrid;
use featherbench_spatial::Real;

/// A point between straight walls: x = (p_x, p_y in m, v_x, v_y in m/s), θ = (g, e, then φ, d of each wall).
///
/// A wall has the normal n = (cos φ, sin φ) towards the inside, and its points obey n·p = d. Gravity acts along −y.
///
/// ```text
/// ṗ = v, v̇ = (0, −g)     n·p − d falls through 0     v⁺ = H v⁻,  H = 1 − (1 + e) n nᵀ
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlantedBox {
    /// The number of walls.
    pub walls: usize,
}

impl SlantedBox {
    /// Ξ at a wall of direction φ where the velocity before is v, row by row: with a = (0, −g)
    ///
    /// ```text
    /// f₊ − DR f₋ = (H v − v; a − H a) = (1 + e)(−(n·v) n; (n·a) n)    ∇g = (nᵀ, 0)    ġ = n·v
    /// Ξ = [[H, 0], [(1 + e) (n·a)/(n·v) n nᵀ, H]]
    /// ```
    pub fn saltation<T: Real>(gravity: T, restitution: T, direction: T, velocity: [T; 2]) -> [[T; 4]; 4] {
        let (sine, cosine) = direction.sin_cos();
        let n = [cosine, sine];
        let jump = T::one() + restitution;
        let ratio = -(gravity * n[1]) / (n[0] * velocity[0] + n[1] * velocity[1]);
        let mut matrix = [[T::zero(); 4]; 4];
        for row in 0..2 {
            for column in 0..2 {
                let product = jump * n[row] * n[column];
                let reflection = if row == column { T::one() - product } else { -product };
                matrix[row][column] = reflection;
                matrix[row + 2][column + 2] = reflection;
                matrix[row + 2][column] = ratio * product;
            }
        }
        matrix
    }
}

impl Hybrid for SlantedBox {
    fn states(&self) -> usize {
        4
    }

    fn parameters(&self) -> usize {
        2 + 2 * self.walls
    }

    fn guards(&self, _: usize) -> usize {
        self.walls
    }

    fn flow<T: Real>(&self, _: usize, _: T, x: &[T], theta: &[T], rate: &mut [T]) {
        (rate[0], rate[1], rate[2], rate[3]) = (x[2], x[3], T::zero(), -theta[0]);
    }

    fn guard<T: Real>(&self, _: usize, wall: usize, _: T, x: &[T], theta: &[T]) -> T {
        let (sine, cosine) = theta[2 + 2 * wall].sin_cos();
        cosine.mul_add(x[0], sine.mul_add(x[1], -theta[3 + 2 * wall]))
    }

    fn reset<T: Real>(&self, _: usize, wall: usize, _: T, x: &[T], theta: &[T], after: &mut [T]) {
        let (sine, cosine) = theta[2 + 2 * wall].sin_cos();
        let jump = (T::one() + theta[1]) * (cosine * x[2] + sine * x[3]);
        (after[0], after[1], after[2], after[3]) = (x[0], x[1], x[2] - jump * cosine, x[3] - jump * sine);
    }
}
