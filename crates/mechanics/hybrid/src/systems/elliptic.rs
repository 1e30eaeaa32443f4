//! Elliptic integrals of the first kind, by Carlson's duplication.
//!
//! Source: B. C. Carlson, *Computing elliptic integrals by duplication* (1979); its series to the order 5 in the deviations.

use crate::error::HybridError;

/// R_F(x, y, z) = ½ ∫₀^∞ dt/√((t + x)(t + y)(t + z)), to a few ulps.
///
/// # Errors
/// [`HybridError::Parameter`] unless all are finite and at least 0, and at most one is 0.
pub fn carlson(x: f64, y: f64, z: f64) -> Result<f64, HybridError> {
    for (name, value) in [("x", x), ("y", y), ("z", z)] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(HybridError::Parameter { name, value, range: "finite and at least 0" });
        }
    }
    if [x, y, z].iter().filter(|value| **value == 0.0).count() > 1 {
        return Err(HybridError::Parameter { name: "two of x, y, z", value: 0.0, range: "not both 0: the integral is infinite" });
    }
    let (mut x, mut y, mut z) = (x, y, z);
    loop {
        let mean = (x + y + z) / 3.0;
        let [a, b, c] = [x, y, z].map(|value| 1.0 - value / mean);
        // The first term that is left out is of order 6: at most 10⁻¹⁸. Each round divides the deviations by about 4.
        if a.abs().max(b.abs()).max(c.abs()) < 1e-3 {
            let (second, third) = (a * b - c * c, a * b * c);
            let series = 1.0 - second / 10.0 + third / 14.0 + second * second / 24.0 - 3.0 * second * third / 44.0;
            return Ok(series / mean.sqrt());
        }
        let [p, q, r] = [x, y, z].map(f64::sqrt);
        let lambda = p * q + q * r + r * p;
        (x, y, z) = (0.25 * (x + lambda), 0.25 * (y + lambda), 0.25 * (z + lambda));
    }
}

/// F(φ, k) = ∫₀^φ dϑ/√(1 − k² sin² ϑ) = sin φ R_F(cos² φ, 1 − k² sin² φ, 1), from sin φ with 0 ≤ φ ≤ π/2.
///
/// # Errors
/// [`HybridError::Parameter`] unless 0 ≤ sin φ ≤ 1 and 0 ≤ k < 1.
pub fn incomplete(sine: f64, modulus: f64) -> Result<f64, HybridError> {
    if !(0.0..=1.0).contains(&sine) {
        return Err(HybridError::Parameter { name: "sine", value: sine, range: "between 0 and 1" });
    }
    if !(0.0..1.0).contains(&modulus) {
        return Err(HybridError::Parameter { name: "modulus", value: modulus, range: "at least 0 and below 1" });
    }
    let product = modulus * sine;
    Ok(sine * carlson((1.0 - sine) * (1.0 + sine), (1.0 - product) * (1.0 + product), 1.0)?)
}
