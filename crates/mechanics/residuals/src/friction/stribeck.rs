//! Stribeck's curve: friction that falls as the joint sets off, and rises with speed.
//!
//! r = (F + (S − F) exp(−(v / u)²)) tanh(v / w) + B v. Source: B. Armstrong-Hélouvry, P. Dupont and C. Canudas de Wit, *A survey of models,
//! analysis tools and compensation methods for the control of machines with friction* (1994), with the sign made smooth.

use crate::error::{demand, expect};
use crate::{Residual, ResidualError, State};

/// Stribeck friction; each list has a number per dof.
#[derive(Clone, Debug, PartialEq)]
pub struct Stribeck {
    /// Coulomb friction F of a fast joint, N·m or N.
    pub coulomb: Vec<f64>,
    /// Static friction S of a joint that sets off, N·m or N; at least F.
    pub stiction: Vec<f64>,
    /// The speed u over which friction falls from S to F, rad/s or m/s.
    pub speed: Vec<f64>,
    /// Viscous coefficient B.
    pub viscous: Vec<f64>,
    /// The width w over which the sign changes, rad/s or m/s.
    pub width: Vec<f64>,
}

impl Stribeck {
    /// The same, checked.
    ///
    /// # Errors
    /// [`ResidualError`] if the lengths differ, S < F, F or B is negative, a speed or width is not positive, or a number is not finite.
    pub fn checked(self) -> Result<Self, ResidualError> {
        let n = self.coulomb.len();
        expect("static frictions", n, self.stiction.len())?;
        expect("Stribeck speeds", n, self.speed.len())?;
        expect("viscous frictions", n, self.viscous.len())?;
        expect("widths of Stribeck friction", n, self.width.len())?;
        demand("Coulomb friction", &self.coulomb, "it must be finite and not negative", |x| x >= 0.0)?;
        let above: Vec<f64> = self.stiction.iter().zip(&self.coulomb).map(|(s, f)| s - f).collect();
        demand("static less Coulomb friction", &above, "static friction must be finite and at least the Coulomb friction", |x| x >= 0.0)?;
        demand("Stribeck speed", &self.speed, "it must be finite and positive", |x| x > 0.0)?;
        demand("viscous friction", &self.viscous, "it must be finite and not negative", |x| x >= 0.0)?;
        demand("width of Stribeck friction", &self.width, "it must be finite and positive", |x| x > 0.0)?;
        Ok(self)
    }
}

impl Residual for Stribeck {
    fn nv(&self) -> usize {
        self.coulomb.len()
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        for (k, r) in r.iter_mut().enumerate() {
            let v = state.v[k];
            let fast = v / self.speed[k];
            let level = self.coulomb[k] + (self.stiction[k] - self.coulomb[k]) * (-fast * fast).exp();
            *r += level * (v / self.width[k]).tanh() + self.viscous[k] * v;
        }
        Ok(())
    }
}
