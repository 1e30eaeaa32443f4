//! The pseudo-inertia: ten numbers belong to a body that exists if, and only if, a 4×4 matrix has no negative eigenvalue.
//!
//! Source: P. Wensing, S. Kim & J.-J. Slotine, *Linear matrix inequalities for physically consistent inertial parameter identification* (2018).
//! With the density ρ ≥ 0, the first moment h and the inertia Ī about the origin:
//!
//! ```text
//! P = ∫ [x; 1][x; 1]ᵀ ρ dx = [[Σ, h], [hᵀ, m]]      Σ = ½ tr(Ī) 1 − Ī      Ī = tr(Σ) 1 − Σ
//! ```
//!
//! Units: m, kg·m, kg·m². Frame: the body's origin and axes, in which the parameters are.

use featherbench_dynamics::PARAMETERS;
use nalgebra::{Matrix4, Vector4};
use std::ops::Add;

/// Eigenvalues below this share of the largest are zero: forming P from Ī leaves a few roundings of its largest entry.
pub const ZERO: f64 = 1e-13;

/// A pseudo-inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PseudoInertia(pub Matrix4<f64>);

/// Whether a body with these parameters can exist.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Consistency {
    /// The smallest eigenvalue of P.
    pub smallest: f64,
    /// The largest eigenvalue of P.
    pub largest: f64,
    /// How many eigenvalues are above [`ZERO`] of the largest: 4 of a body with volume, 3 of a plate, 2 of a rod, 1 of a point.
    pub rank: usize,
}

impl Consistency {
    /// No eigenvalue is negative beyond rounding.
    pub fn is_consistent(&self) -> bool {
        self.smallest >= -ZERO * self.largest.max(0.0)
    }
}

impl PseudoInertia {
    /// No body.
    pub fn zero() -> Self {
        Self(Matrix4::zeros())
    }

    /// A point mass.
    pub fn point(mass: f64, [x, y, z]: [f64; 3]) -> Self {
        let place = Vector4::new(x, y, z, 1.0);
        Self(place * place.transpose() * mass)
    }

    /// Of the ten inertial parameters (m, h, Ī as xx, xy, xz, yy, yz, zz).
    ///
    /// ```
    /// use featherbench_identification::PseudoInertia;
    ///
    /// // Principal moments 1, 1, 3 are positive, and break the triangle inequality: no body has them.
    /// let refused = PseudoInertia::of(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 3.0]).consistency();
    /// assert!(!refused.is_consistent());
    /// assert_eq!(refused.smallest, -0.5);
    /// ```
    pub fn of(pi: &[f64; PARAMETERS]) -> Self {
        let [m, hx, hy, hz, xx, xy, xz, yy, yz, zz] = *pi;
        let half = 0.5 * (xx + yy + zz);
        Self(Matrix4::new(half - xx, -xy, -xz, hx, -xy, half - yy, -yz, hy, -xz, -yz, half - zz, hz, hx, hy, hz, m))
    }

    /// The ten inertial parameters.
    pub fn parameters(&self) -> [f64; PARAMETERS] {
        let p = &self.0;
        let (x, y, z) = (p[(0, 0)], p[(1, 1)], p[(2, 2)]);
        [p[(3, 3)], p[(0, 3)], p[(1, 3)], p[(2, 3)], y + z, -p[(0, 1)], -p[(0, 2)], x + z, -p[(1, 2)], x + y]
    }

    /// Mass, centre of mass, and inertia about it (xx, xy, xz, yy, yz, zz). Without mass the centre is the origin.
    pub fn central(&self) -> (f64, [f64; 3], [f64; 6]) {
        let [m, hx, hy, hz, xx, xy, xz, yy, yz, zz] = self.parameters();
        if m == 0.0 {
            return (m, [0.0; 3], [xx, xy, xz, yy, yz, zz]);
        }
        let [x, y, z] = [hx / m, hy / m, hz / m];
        let about = [xx - (hy * y + hz * z), xy + hx * y, xz + hx * z, yy - (hx * x + hz * z), yz + hy * z, zz - (hx * x + hy * y)];
        (m, [x, y, z], about)
    }

    /// The eigenvalues' verdict.
    pub fn consistency(&self) -> Consistency {
        let values = self.0.symmetric_eigenvalues();
        if values.iter().any(|value| value.is_nan()) {
            return Consistency { smallest: f64::NAN, largest: f64::NAN, rank: 0 };
        }
        let (smallest, largest) = (values.min(), values.max());
        let rank = values.iter().filter(|&&value| value > ZERO * largest).count();
        Consistency { smallest, largest, rank }
    }
}

impl Add for PseudoInertia {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}
