//! A ball on a table that moves: guard and reset depend on time.

use crate::system::Hybrid;
use featherbench_spatial::Real;

/// A point above a table at w(t) = A sin Ωt: x = (height y in m, velocity v in m/s upwards), θ = (g, e, A, Ω).
///
/// ```text
/// ẏ = v, v̇ = −g     y − w falls through 0     v⁺ = −e v⁻ + (1 + e) ẇ
/// ```
///
/// Source: P. J. Holmes, *The dynamics of repeated impacts with a sinusoidally vibrating table* (1982), without its assumption of high
/// flights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MovingTable;

impl MovingTable {
    /// Ξ at an impact at time t with the velocity v⁻, row by row: with u = v⁻ − ẇ
    ///
    /// ```text
    /// f₊ − DR f₋ − ∂R/∂t = −(1 + e)(u, g + ẅ)    ∇g = (1, 0)    ġ = u
    /// Ξ = [[−e, 0], [−(1 + e)(g + ẅ)/u, −e]]
    /// ```
    pub fn saltation<T: Real>(t: T, velocity: T, theta: &[T; 4]) -> [T; 4] {
        let [gravity, e, amplitude, frequency] = *theta;
        let (sine, cosine) = (frequency * t).sin_cos();
        let approach = velocity - amplitude * frequency * cosine;
        let acceleration = -(amplitude * frequency * frequency * sine);
        [-e, T::zero(), -((T::one() + e) * (gravity + acceleration) / approach), -e]
    }
}

impl Hybrid for MovingTable {
    fn states(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        4
    }

    fn flow<T: Real>(&self, _: usize, _: T, x: &[T], theta: &[T], rate: &mut [T]) {
        (rate[0], rate[1]) = (x[1], -theta[0]);
    }

    fn guard<T: Real>(&self, _: usize, _: usize, t: T, x: &[T], theta: &[T]) -> T {
        x[0] - theta[2] * (theta[3] * t).sin_cos().0
    }

    fn reset<T: Real>(&self, _: usize, _: usize, t: T, x: &[T], theta: &[T], after: &mut [T]) {
        let speed = theta[2] * theta[3] * (theta[3] * t).sin_cos().1;
        (after[0], after[1]) = (x[0], (T::one() + theta[1]) * speed - theta[1] * x[1]);
    }
}
