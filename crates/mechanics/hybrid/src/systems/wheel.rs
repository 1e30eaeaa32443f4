//! The rimless wheel: the simplest walker, with a limit cycle in closed form.

use crate::system::{Direction, Hybrid};
use featherbench_spatial::Real;

/// A wheel of spokes without a rim rolls down a slope.
///
/// The state is x = (angle ϑ of the spoke on the ground from the vertical in rad, rate ω in rad/s). The parameters are θ = (g/l in 1/s²,
/// slope γ, half the angle between spokes α).
///
/// ```text
/// ϑ̈ = (g/l) sin ϑ     ϑ − γ − α rises through 0     ϑ⁺ = ϑ⁻ − 2α, ω⁺ = cos 2α ω⁻
/// ```
///
/// All mass is in the hub. The factor cos 2α keeps the angular momentum about the new point of contact.
///
/// Source: T. McGeer, *Passive dynamic walking* (1990).
///
/// ```
/// // On the level nothing replaces what the impacts take; with spokes at 90° an impact takes everything.
/// use featherbench_hybrid::systems::RimlessWheel;
/// assert_eq!(RimlessWheel::limit_cycle(&[9.81, 0.0, 0.3]), 0.0);
/// assert!(RimlessWheel::multiplier(&[9.81, 0.1, std::f64::consts::FRAC_PI_4]) < 1e-30);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RimlessWheel;

impl RimlessWheel {
    /// ω⁺ right after an impact of the limit cycle.
    ///
    /// A step from γ − α to γ + α adds 2(g/l)(cos(γ − α) − cos(γ + α)) = 4(g/l) sin α sin γ to ω², and the impact multiplies it by cos² 2α:
    ///
    /// ```text
    /// ω₊² = cos² 2α (ω₊² + 4(g/l) sin α sin γ)   ⇒   ω₊ = cot 2α √(4(g/l) sin α sin γ)
    /// ```
    pub fn limit_cycle<T: Real>(theta: &[T; 3]) -> T {
        let (sine, cosine) = (theta[2] + theta[2]).sin_cos();
        let gain = T::from_f64(4.0) * theta[0] * theta[2].sin_cos().0 * theta[1].sin_cos().0;
        cosine * gain.sqrt() / sine
    }

    /// cos² 2α: what is left of a small deviation of ω₊ from the limit cycle after one step.
    pub fn multiplier<T: Real>(theta: &[T; 3]) -> T {
        let (_, cosine) = (theta[2] + theta[2]).sin_cos();
        cosine * cosine
    }
}

impl Hybrid for RimlessWheel {
    fn states(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        3
    }

    fn direction(&self, _: usize, _: usize) -> Direction {
        Direction::Rising
    }

    fn flow<T: Real>(&self, _: usize, _: T, x: &[T], theta: &[T], rate: &mut [T]) {
        (rate[0], rate[1]) = (x[1], theta[0] * x[0].sin_cos().0);
    }

    fn guard<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], theta: &[T]) -> T {
        x[0] - theta[1] - theta[2]
    }

    fn reset<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], theta: &[T], after: &mut [T]) {
        let between = theta[2] + theta[2];
        (after[0], after[1]) = (x[0] - between, between.sin_cos().1 * x[1]);
    }
}
