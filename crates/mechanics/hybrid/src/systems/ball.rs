//! A ball that bounces on the ground, with Newton's restitution, until infinitely many impacts are over.

use crate::system::Hybrid;
use featherbench_spatial::Real;

/// A point above the ground: x = (height y in m, velocity v in m/s upwards, path s in m), θ = (g, e).
///
/// | mode | flow | guard | reset |
/// |---|---|---|---|
/// | 0: going down | ẏ = v, v̇ = −g, ṡ = −v | y falls through 0 | v⁺ = −e v⁻, to mode 1 |
/// | 1: going up | ẏ = v, v̇ = −g, ṡ = v | v falls through 0 | none, to mode 0 |
///
/// From rest at h it hits the ground at t₁ = √(2h/g) with the speed g t₁. The k-th flight after that takes 2eᵏt₁ and rises by e²ᵏh. The
/// sums are geometric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BouncingBall;

impl BouncingBall {
    /// t₁ + 2t₁(e + e² + …) = t₁(1 + e)/(1 − e): when a ball that falls from rest at `height` stops.
    pub fn zeno_time<T: Real>(height: T, gravity: T, restitution: T) -> T {
        let first = ((height + height) / gravity).sqrt();
        first * (T::one() + restitution) / (T::one() - restitution)
    }

    /// h + 2h(e² + e⁴ + …) = h(1 + e²)/(1 − e²): how far it goes until then.
    pub fn path<T: Real>(height: T, restitution: T) -> T {
        let square = restitution * restitution;
        height * (T::one() + square) / (T::one() - square)
    }

    /// The time of impact k = 0, 1, …: t₁(1 + 2(e + … + eᵏ)).
    pub fn impact_time<T: Real>(height: T, gravity: T, restitution: T, impact: usize) -> T {
        let first = ((height + height) / gravity).sqrt();
        let (mut sum, mut power) = (T::one(), T::one());
        for _ in 0..impact {
            power *= restitution;
            sum += power + power;
        }
        first * sum
    }
}

impl Hybrid for BouncingBall {
    fn states(&self) -> usize {
        3
    }

    fn parameters(&self) -> usize {
        2
    }

    fn modes(&self) -> usize {
        2
    }

    fn flow<T: Real>(&self, mode: usize, _: T, x: &[T], theta: &[T], rate: &mut [T]) {
        (rate[0], rate[1]) = (x[1], -theta[0]);
        rate[2] = if mode == 0 { -x[1] } else { x[1] };
    }

    fn guard<T: Real>(&self, mode: usize, _: usize, _: T, x: &[T], _: &[T]) -> T {
        x[mode]
    }

    fn reset<T: Real>(&self, mode: usize, _: usize, _: T, x: &[T], theta: &[T], after: &mut [T]) {
        after.copy_from_slice(x);
        if mode == 0 {
            after[1] = -(theta[1] * x[1]);
        }
    }

    fn target(&self, mode: usize, _: usize, _: f64, _: &[f64], _: &[f64]) -> usize {
        1 - mode
    }
}
