//! A sphere that slides until it rolls.

use crate::system::Hybrid;
use featherbench_spatial::Real;

/// A uniform sphere on the ground: x = (position in m, velocity v in m/s, rate ω in rad/s), θ = (μ, g, radius ρ).
///
/// | mode | flow | guard |
/// |---|---|---|
/// | 0: sliding | v̇ = −μg, ω̇ = 5μg/(2ρ) | v − ρω falls through 0, to mode 1 |
/// | 1: rolling | v̇ = 0, ω̇ = 0 | none |
///
/// No reset changes the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlidingSphere;

impl SlidingSphere {
    /// When sliding ends that began with v₀ and ω = 0: v − ρω = v₀ − (7/2)μg t is zero at 2v₀/(7μg). There v = 5v₀/7.
    pub fn rolling_time<T: Real>(speed: T, friction: T, gravity: T) -> T {
        (speed + speed) / (T::from_f64(7.0) * friction * gravity)
    }
}

impl Hybrid for SlidingSphere {
    fn states(&self) -> usize {
        3
    }

    fn parameters(&self) -> usize {
        3
    }

    fn modes(&self) -> usize {
        2
    }

    fn guards(&self, mode: usize) -> usize {
        1 - mode
    }

    fn flow<T: Real>(&self, mode: usize, _: T, x: &[T], theta: &[T], rate: &mut [T]) {
        let push = if mode == 0 { theta[0] * theta[1] } else { T::zero() };
        (rate[0], rate[1], rate[2]) = (x[1], -push, T::from_f64(2.5) * push / theta[2]);
    }

    fn guard<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], theta: &[T]) -> T {
        x[1] - theta[2] * x[2]
    }

    fn target(&self, _: usize, _: usize, _: f64, _: &[f64], _: &[f64]) -> usize {
        1
    }
}
