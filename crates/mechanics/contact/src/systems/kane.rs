//! Kane's puzzle: a double pendulum whose tip hits the ground and gains energy under Newton's law with Coulomb's friction.

use crate::malformed::Malformed;
use crate::problem::{Contact, Level, Mechanism, Problem};
use nalgebra::{DMatrix, DVector};

/// Two uniform rods of 1 kg and 1 m, hinged in a row, angles from the vertical. The tip hits the ground.
///
/// ```text
/// M = [4/3, ½ cos(θ₁ − θ₂); ·, 1/3]    J_n = [sin θ₁, sin θ₂]    J_t = [cos θ₁, cos θ₂]
/// ```
///
/// Source: T. R. Kane and D. A. Levinson, *Dynamics: Theory and Applications* (1985); the numbers are this project's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kane {
    /// θ in rad.
    pub angles: [f64; 2],
    /// θ̇ in rad/s.
    pub rates: [f64; 2],
    /// μ.
    pub friction: f64,
    /// e.
    pub restitution: f64,
}

impl Default for Kane {
    /// θ = (20°, 30°), θ̇ = (−0.1, −0.2), e = μ = 0.5.
    fn default() -> Self {
        Self { angles: [20.0_f64.to_radians(), 30.0_f64.to_radians()], rates: [-0.1, -0.2], friction: 0.5, restitution: 0.5 }
    }
}

impl Kane {
    /// The impact of the tip.
    ///
    /// # Errors
    /// [`Malformed`] if a parameter is not finite or out of its range.
    pub fn problem(&self) -> Result<Problem, Malformed> {
        let [(sine1, cosine1), (sine2, cosine2)] = self.angles.map(f64::sin_cos);
        let coupling = 0.5 * (self.angles[0] - self.angles[1]).cos();
        let mass = DMatrix::from_row_slice(2, 2, &[4.0 / 3.0, coupling, coupling, 1.0 / 3.0]);
        let jacobian = DMatrix::from_row_slice(2, 2, &[sine1, sine2, cosine1, cosine2]);
        let mechanism = Mechanism { mass, jacobian, free: DVector::from_row_slice(&self.rates) };
        let contact = Contact::planar("tip", self.friction).with_restitution(self.restitution);
        Problem::from_mechanism("kane", Level::Impulse, vec![contact], mechanism)
    }
}
