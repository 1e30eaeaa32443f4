//! A mass on a belt: dry friction as a Filippov system with a sliding mode.

use crate::system::{Direction, Hybrid};
use featherbench_spatial::Real;

/// A mass on a spring lies on a belt: x = (position x in m, velocity v in m/s), θ = (m, k, belt speed u, static friction S, kinetic
/// friction F), forces in N.
///
/// | mode | flow | guard | to |
/// |---|---|---|---|
/// | 0: stick | ẋ = u, v̇ = 0 | kx − S rises; kx + S falls | 1; 2 |
/// | 1: slower than the belt | ẋ = v, m v̇ = F − kx | v − u rises through 0 | 0 if \|kx\| ≤ S, else 2 |
/// | 2: faster than the belt | ẋ = v, m v̇ = −F − kx | v − u falls through 0 | 0 if \|kx\| ≤ S, else 1 |
///
/// No reset changes the state. Mode 0 is the sliding mode of Filippov on v = u.
///
/// Source: R. I. Leine and H. Nijmeijer, *Dynamics and Bifurcations of Non-Smooth Mechanical Systems* (2004).
///
/// ```
/// // With S = F a slip is a whole oscillation, and nothing sticks.
/// use featherbench_hybrid::systems::StickSlip;
/// assert_eq!(StickSlip::slip_time(&[1.0, 1.0, 0.5, 2.0, 2.0]), std::f64::consts::TAU);
/// assert_eq!(StickSlip::stick_time(&[1.0, 1.0, 0.5, 2.0, 2.0]), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StickSlip;

impl StickSlip {
    /// How long a slip takes that began at kx = S: with ω² = k/m, a = (S − F)/k and tan β = aω/u,
    ///
    /// ```text
    /// x − F/k = a cos ωt + (u/ω) sin ωt      v = √(u² + a²ω²) cos(ωt + β) = u  again at  ωt = 2π − 2β
    /// ```
    pub fn slip_time(theta: &[f64; 5]) -> f64 {
        let [mass, stiffness, speed, fixed, moving] = *theta;
        let frequency = (stiffness / mass).sqrt();
        let angle = ((fixed - moving) / stiffness * frequency).atan2(speed);
        2.0 * (std::f64::consts::PI - angle) / frequency
    }

    /// How long it sticks after a slip, which ends at x = F/k − a: 2a/u.
    pub fn stick_time<T: Real>(theta: &[T; 5]) -> T {
        let [_, stiffness, speed, fixed, moving] = *theta;
        let travel = (fixed - moving) / stiffness;
        (travel + travel) / speed
    }
}

impl Hybrid for StickSlip {
    fn states(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        5
    }

    fn modes(&self) -> usize {
        3
    }

    fn guards(&self, mode: usize) -> usize {
        if mode == 0 { 2 } else { 1 }
    }

    fn direction(&self, mode: usize, guard: usize) -> Direction {
        if (mode, guard) == (0, 0) || mode == 1 { Direction::Rising } else { Direction::Falling }
    }

    fn flow<T: Real>(&self, mode: usize, _: T, x: &[T], theta: &[T], rate: &mut [T]) {
        let spring = theta[1] * x[0];
        (rate[0], rate[1]) = match mode {
            0 => (theta[2], T::zero()),
            1 => (x[1], (theta[4] - spring) / theta[0]),
            _ => (x[1], -((theta[4] + spring) / theta[0])),
        };
    }

    fn guard<T: Real>(&self, mode: usize, guard: usize, _: T, x: &[T], theta: &[T]) -> T {
        match (mode, guard) {
            (0, 0) => theta[1] * x[0] - theta[3],
            (0, _) => theta[1] * x[0] + theta[3],
            _ => x[1] - theta[2],
        }
    }

    fn target(&self, mode: usize, guard: usize, _: f64, after: &[f64], theta: &[f64]) -> usize {
        let holds = (theta[1] * after[0]).abs() <= theta[3];
        match (mode, guard) {
            (0, 0) => 1,
            (0, _) => 2,
            _ if holds => 0,
            _ => 3 - mode,
        }
    }
}
