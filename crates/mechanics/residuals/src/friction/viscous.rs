//! Viscous friction: r = B v.

use crate::error::demand;
use crate::{Residual, ResidualError, State};

/// r = B v with a coefficient per dof, N·m·s/rad or N·s/m.
#[derive(Clone, Debug, PartialEq)]
pub struct Viscous {
    coefficients: Vec<f64>,
}

impl Viscous {
    /// Of these coefficients, one per dof.
    ///
    /// # Errors
    /// [`ResidualError::Parameter`] if one is negative or not finite.
    pub fn new(coefficients: Vec<f64>) -> Result<Self, ResidualError> {
        demand("viscous friction", &coefficients, "it must be finite and not negative, or it would drive the joint", |x| x >= 0.0)?;
        Ok(Self { coefficients })
    }
}

impl Residual for Viscous {
    fn nv(&self) -> usize {
        self.coefficients.len()
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        for ((r, b), v) in r.iter_mut().zip(&self.coefficients).zip(state.v) {
            *r += b * v;
        }
        Ok(())
    }
}
