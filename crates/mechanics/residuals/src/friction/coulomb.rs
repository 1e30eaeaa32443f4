//! Coulomb friction, made smooth: r = F tanh(v / w).
//!
//! For |v| ≥ 20 w it is F to the last bit. Nearer to rest it creeps: under a force below F the joint does not stick, it moves with
//! v = w artanh(τ / F).

use crate::error::{demand, expect};
use crate::{Residual, ResidualError, State};

/// r = F tanh(v / w): a friction F, N·m or N, and a width w, rad/s or m/s, per dof.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothCoulomb {
    friction: Vec<f64>,
    width: Vec<f64>,
}

impl SmoothCoulomb {
    /// Of these numbers per dof.
    ///
    /// # Errors
    /// [`ResidualError`] if the lengths differ, a friction is negative, a width is not positive, or a number is not finite.
    pub fn new(friction: Vec<f64>, width: Vec<f64>) -> Result<Self, ResidualError> {
        expect("widths of Coulomb friction", friction.len(), width.len())?;
        demand("Coulomb friction", &friction, "it must be finite and not negative", |x| x >= 0.0)?;
        demand("width of Coulomb friction", &width, "it must be finite and positive", |x| x > 0.0)?;
        Ok(Self { friction, width })
    }
}

impl Residual for SmoothCoulomb {
    fn nv(&self) -> usize {
        self.friction.len()
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        for (k, r) in r.iter_mut().enumerate() {
            *r += self.friction[k] * (state.v[k] / self.width[k]).tanh();
        }
        Ok(())
    }
}
