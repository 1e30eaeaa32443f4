//! Housner's rocking block.

use super::elliptic::{carlson, incomplete};
use crate::error::HybridError;
use crate::system::{Direction, Hybrid};
use featherbench_spatial::Real;

/// A uniform rectangular block rocks about its lower edges: x = (angle ϑ in rad, rate ω in rad/s), θ = (g, half width b, half height h).
///
/// With R² = b² + h², tan α = b/h and p² = 3g/(4R):
///
/// | mode | flow | guard | reset |
/// |---|---|---|---|
/// | 0: ϑ > 0 | ϑ̈ = −p² sin(α − ϑ) | ϑ falls through 0 | ω⁺ = r ω⁻, to mode 1 |
/// | 1: ϑ < 0 | ϑ̈ = p² sin(α + ϑ) | ϑ rises through 0 | ω⁺ = r ω⁻, to mode 0 |
///
/// The block neither slides nor bounces. Past |ϑ| = α it overturns, and nothing here stops it.
///
/// Source: G. W. Housner, *The behavior of inverted pendulum structures during earthquakes* (1963).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RockingBlock;

impl RockingBlock {
    /// r = 1 − (3/2) sin² α, from the angular momentum about the new edge: with the moment of inertia (4/3) m R² about an edge,
    ///
    /// ```text
    /// (4/3) m R² ω⁺ = ((4/3) m R² − 2 m R b sin α) ω⁻,    b = R sin α
    /// ```
    pub fn ratio<T: Real>(width: T, height: T) -> T {
        let square = width * width / (width * width + height * height);
        T::one() - T::from_f64(1.5) * square
    }

    /// p in rad/s.
    pub fn frequency<T: Real>(gravity: T, width: T, height: T) -> T {
        let radius = (width * width + height * height).sqrt();
        (T::from_f64(0.75) * gravity / radius).sqrt()
    }

    /// p times the quarter period from rest at ϑ₀ to ϑ = 0, where sin is replaced by its argument: arccosh(1/(1 − ϑ₀/α)).
    ///
    /// # Errors
    /// [`HybridError::Parameter`] unless 0 < ϑ₀ < α < π/2.
    pub fn linear_quarter(alpha: f64, amplitude: f64) -> Result<f64, HybridError> {
        check(alpha, amplitude)?;
        Ok((1.0 / (1.0 - amplitude / alpha)).acosh())
    }

    /// p times the quarter period from rest at ϑ₀ to ϑ = 0.
    ///
    /// φ = π − α + ϑ is the angle of a pendulum, φ̈ = −p² sin φ. It falls from rest at φ₀ = π − α + ϑ₀ to φ₁ = π − α. With k = sin(φ₀/2):
    ///
    /// ```text
    /// p T/4 = K(k) − F(arcsin(sin(φ₁/2)/k), k)
    /// ```
    ///
    /// # Errors
    /// [`HybridError::Parameter`] unless 0 < ϑ₀ < α < π/2.
    pub fn quarter(alpha: f64, amplitude: f64) -> Result<f64, HybridError> {
        check(alpha, amplitude)?;
        // sin(φ/2) = cos((α − ϑ)/2)
        let modulus = (0.5 * (alpha - amplitude)).cos();
        let sine = (0.5 * alpha).cos() / modulus;
        Ok(carlson(0.0, (0.5 * (alpha - amplitude)).sin().powi(2), 1.0)? - incomplete(sine, modulus)?)
    }
}

fn check(alpha: f64, amplitude: f64) -> Result<(), HybridError> {
    if !(alpha > 0.0 && alpha < std::f64::consts::FRAC_PI_2) {
        return Err(HybridError::Parameter { name: "alpha", value: alpha, range: "between 0 and π/2" });
    }
    let inside = amplitude > 0.0 && amplitude < alpha;
    if inside { Ok(()) } else { Err(HybridError::Parameter { name: "amplitude", value: amplitude, range: "between 0 and alpha" }) }
}

impl Hybrid for RockingBlock {
    fn states(&self) -> usize {
        2
    }

    fn parameters(&self) -> usize {
        3
    }

    fn modes(&self) -> usize {
        2
    }

    fn direction(&self, mode: usize, _: usize) -> Direction {
        if mode == 0 { Direction::Falling } else { Direction::Rising }
    }

    fn flow<T: Real>(&self, mode: usize, _: T, x: &[T], theta: &[T], rate: &mut [T]) {
        let [gravity, width, height] = [theta[0], theta[1], theta[2]];
        let square = width * width + height * height;
        let (sine, cosine) = x[0].sin_cos();
        // p² sin(α ∓ ϑ) = 3g/(4R²) (b cos ϑ ∓ h sin ϑ)
        let factor = T::from_f64(0.75) * gravity / square;
        let pull = if mode == 0 { height * sine - width * cosine } else { height * sine + width * cosine };
        (rate[0], rate[1]) = (x[1], factor * pull);
    }

    fn guard<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], _: &[T]) -> T {
        x[0]
    }

    fn reset<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], theta: &[T], after: &mut [T]) {
        (after[0], after[1]) = (x[0], Self::ratio(theta[1], theta[2]) * x[1]);
    }

    fn target(&self, mode: usize, _: usize, _: f64, _: &[f64], _: &[f64]) -> usize {
        1 - mode
    }
}
