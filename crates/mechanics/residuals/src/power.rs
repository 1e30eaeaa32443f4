//! The balance of power: what a motor supplies and the nominal model does not store is the power of the residual.
//!
//! Along any motion of the true robot, with the nominal energy Ê and the true forces τ = ID⋆(q, v, a),
//!
//! ```text
//! ∫ (vᵀτ − dÊ/dt) dt = ∫ vᵀr dt
//! ```
//!
//! Ê(T) − Ê(0) is exact, and the other two integrals are sums. So the two sides differ by the error of the quadrature, which falls with its order.

use crate::{Residual, ResidualError, State};

/// A composite rule of quadrature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quadrature {
    /// Order 2.
    Trapezoid,
    /// Order 4.
    Simpson,
    /// Three points of Gauss and Legendre, order 6.
    Gauss,
}

impl Quadrature {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Trapezoid, Self::Simpson, Self::Gauss];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Trapezoid => "trapezoid",
            Self::Simpson => "simpson",
            Self::Gauss => "gauss",
        }
    }

    /// The order p: the error falls like hᵖ.
    pub fn order(self) -> u32 {
        match self {
            Self::Trapezoid => 2,
            Self::Simpson => 4,
            Self::Gauss => 6,
        }
    }

    /// Nodes on [0, 1] and weights.
    fn nodes(self) -> Vec<(f64, f64)> {
        let side = (3.0_f64 / 5.0).sqrt() / 2.0;
        match self {
            Self::Trapezoid => vec![(0.0, 0.5), (1.0, 0.5)],
            Self::Simpson => vec![(0.0, 1.0 / 6.0), (0.5, 4.0 / 6.0), (1.0, 1.0 / 6.0)],
            Self::Gauss => vec![(0.5 - side, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + side, 5.0 / 18.0)],
        }
    }
}

/// The three terms of the balance over a motion, J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerBalance {
    /// ∫ vᵀτ dt.
    pub supplied: f64,
    /// Ê at the end less Ê at the start.
    pub stored: f64,
    /// ∫ vᵀr dt.
    pub residual: f64,
}

impl PowerBalance {
    /// The balance of a motion over the time from 0 to `time`, with `intervals` of the rule.
    ///
    /// `motion` gives q, v and a of a time, `forces` the true joint forces of a state, `energy` the nominal energy of q and v.
    ///
    /// # Errors
    /// Those of `forces`, `energy` and the residual.
    pub fn of<R: Residual + ?Sized>(
        (rule, intervals, time): (Quadrature, usize, f64),
        motion: impl Fn(f64) -> [Vec<f64>; 3],
        residual: &R,
        forces: impl Fn(&State<'_>) -> Result<Vec<f64>, ResidualError>,
        energy: impl Fn(&[f64], &[f64]) -> Result<f64, ResidualError>,
    ) -> Result<Self, ResidualError> {
        let h = time / intervals as f64;
        let (mut supplied, mut lost) = (0.0, 0.0);
        let power = |v: &[f64], forces: &[f64]| v.iter().zip(forces).map(|(v, f)| v * f).sum::<f64>();
        for interval in 0..intervals {
            for (node, weight) in rule.nodes() {
                let [q, v, a] = motion((interval as f64 + node) * h);
                let state = State::new(&q, &v, &a);
                supplied += h * weight * power(&v, &forces(&state)?);
                lost += h * weight * power(&v, &residual.value(&state)?);
            }
        }
        let [[q0, v0, _], [q1, v1, _]] = [motion(0.0), motion(time)];
        Ok(Self { supplied, stored: energy(&q1, &v1)? - energy(&q0, &v0)?, residual: lost })
    }

    /// What the two sides differ by, J.
    pub fn error(&self) -> f64 {
        self.supplied - self.stored - self.residual
    }
}
