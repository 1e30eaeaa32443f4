//! The penalty limit: how a spring-damper ground approaches the rigid one as it stiffens.
//!
//! A ball of mass m meets a ground with the force −ky − cẏ while y < 0, where c = 2ζ√(km). Let ω = √(k/m), β = √(1 − ζ²), and let the ball
//! arrive at t₁ with the speed V. In the fast time s = ω(t − t₁) let y = Y₀/ω + Y₁/ω² + …:
//!
//! ```text
//! Y₀″ + 2ζY₀′ + Y₀ = 0     Y₀ = −V e^{−ζs} sin(βs)/β
//! Y₁″ + 2ζY₁′ + Y₁ = −g    Y₁ = −g (1 − e^{−ζs}(cos βs + (ζ/β) sin βs))
//! ```
//!
//! The ball leaves at y = 0. To first order that is s = π/β + δ, where δ = −Y₁/(ωY₀′) = g(1 + e)/(ωeV). There e = e^{−πζ/β} is the
//! restitution of the limit, Y₀′ = eV, Y₀″ = −2ζeV and Y₁′ = 0. So the velocity is eV + Y₀″δ = eV − 2ζg(1 + e)/ω. It leaves later than the
//! rigid one by π/(βω), and less fast. At the fixed time T, with x and v the state of the rigid ball,
//!
//! ```text
//! Δv = ( g π/β − 2ζg(1 + e) ) √(m/k) + O(1/k)
//! Δx = ( −v π/β − 2ζg(1 + e)(T − t₁) ) √(m/k) + O(1/k)
//! ```
//!
//! The slope in k is −½. Without damper it is Δx = −vπ√(m/k), Δv = gπ√(m/k).

use crate::error::HybridError;
use crate::system::{Direction, Hybrid};
use featherbench_spatial::Real;

/// A ball on a spring-damper ground: x = (height y in m, velocity v in m/s), θ = (m, g, k, c).
///
/// | mode | flow | guard |
/// |---|---|---|
/// | 0: free | v̇ = −g | y falls through 0, to mode 1 |
/// | 1: in contact | v̇ = −g − (ky + cv)/m | y rises through 0, to mode 0 |
///
/// The contact ends at y = 0, so that the damper may pull just before.
///
/// ```
/// use featherbench_hybrid::penalty::PenaltyBall;
/// use featherbench_hybrid::{Settings, Start, simulate};
/// let start = Start { mode: 0, time: 0.0, state: vec![1.0, 0.0] };
/// let run = simulate(&PenaltyBall, &[1.0, 9.81, 1e6, 0.0], &start, 0.7, &Settings::default())?;
/// // A contact without damper keeps the energy.
/// let energy: f64 = 0.5 * run.state[1] * run.state[1] + 9.81 * run.state[0];
/// assert!((energy - 9.81).abs() < 1e-11);
/// # Ok::<(), featherbench_hybrid::HybridError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PenaltyBall;

impl Hybrid for PenaltyBall {
    fn states(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        4
    }

    fn modes(&self) -> usize {
        2
    }

    fn direction(&self, mode: usize, _: usize) -> Direction {
        if mode == 0 { Direction::Falling } else { Direction::Rising }
    }

    fn flow<T: Real>(&self, mode: usize, _: T, x: &[T], theta: &[T], rate: &mut [T]) {
        let force = if mode == 0 { T::zero() } else { theta[2].mul_add(x[0], theta[3] * x[1]) };
        (rate[0], rate[1]) = (x[1], -(theta[1] + force / theta[0]));
    }

    fn guard<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], _: &[T]) -> T {
        x[0]
    }

    fn target(&self, mode: usize, _: usize, _: f64, _: &[f64], _: &[f64]) -> usize {
        1 - mode
    }
}

/// A drop from rest onto a ground with a given damping ratio, looked at after one bounce.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drop {
    /// m in kg.
    pub mass: f64,
    /// g in m/s².
    pub gravity: f64,
    /// The height at the beginning in m.
    pub height: f64,
    /// ζ.
    pub damping: f64,
    /// T in s: after the first impact and before the second one.
    pub time: f64,
}

/// The rigid limit of a [`Drop`], and the prefactors of its law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// e = e^{−πζ/β}.
    pub restitution: f64,
    /// (x, v) of the rigid ball at T.
    pub limit: [f64; 2],
    /// (Δx, Δv) of the penalty ball, times √k.
    pub prefactor: [f64; 2],
}

impl Drop {
    /// The law of this drop.
    ///
    /// # Errors
    /// [`HybridError::Parameter`] unless m, g, h are positive, 0 ≤ ζ < 1, and T lies between the first and the second impact.
    pub fn law(&self) -> Result<Law, HybridError> {
        for (name, value) in [("mass", self.mass), ("gravity", self.gravity), ("height", self.height)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(HybridError::Parameter { name, value, range: "positive and finite" });
            }
        }
        if !(0.0..1.0).contains(&self.damping) {
            return Err(HybridError::Parameter { name: "damping", value: self.damping, range: "at least 0 and below 1" });
        }
        let (g, first) = (self.gravity, (2.0 * self.height / self.gravity).sqrt());
        let beta = ((1.0 - self.damping) * (1.0 + self.damping)).sqrt();
        let restitution = (-std::f64::consts::PI * self.damping / beta).exp();
        let after = self.time - first;
        let inside = after > 0.0 && after < 2.0 * restitution * first;
        if !inside {
            return Err(HybridError::Parameter { name: "time", value: self.time, range: "between the first and the second impact" });
        }
        let speed = restitution * g * first;
        let limit = [after * (speed - 0.5 * g * after), speed - g * after];
        let (delay, loss) = (std::f64::consts::PI / beta, 2.0 * self.damping * g * (1.0 + restitution));
        let root = self.mass.sqrt();
        Ok(Law { restitution, limit, prefactor: [-root * (limit[1] * delay + loss * after), root * (g * delay - loss)] })
    }

    /// θ of [`PenaltyBall`] for a stiffness in N/m.
    pub fn parameters(&self, stiffness: f64) -> [f64; 4] {
        [self.mass, self.gravity, stiffness, 2.0 * self.damping * (stiffness * self.mass).sqrt()]
    }
}
