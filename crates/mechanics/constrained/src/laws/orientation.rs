//! Two frames with the same axes: three rows in the axes of the first frame.
//!
//! The relative rotation `R = R_Aᵀ R_B` has the quaternion (u, w) with w ≥ 0. The residual is `φ = 2 u = 2 sin(θ/2)·axis`: near zero the
//! rotation vector, and smooth for all θ < π. Without a choice between formulas, `4 w² = 1 + tr R` and `φ = (R − Rᵀ)ᵛ / (2 w)`.
//! With the relative angular velocity `ω = R_Aᵀ (ω_B − ω_A)`:
//!
//! ```text
//! φ̇ = E ω = w ω + ½ ω × φ        ẇ = −¼ ω·φ        bias = E ω̇ + ẇ ω + ½ ω × φ̇
//! ```
//!
//! det E = w, so the rows are independent but at a half turn, which is refused.
//! Source: the quaternion's kinematic equation, `q̇ = ½ (ω, 0) ⊗ q`. Units: rad.

use super::Row;
use crate::attachment::Anchor;
use featherbench_spatial::{Lift, Mat3, Real, Vec3};

/// The least w. There the quotient loses half of the digits: tr R is known to ε, and 4 w² = 1 + tr R.
const LEAST: f64 = 1e-4;

/// The three rows; `None` at a half turn.
pub(crate) fn set<T: Real>(frames: &[Anchor<T>; 2], rows: &mut [Row<T>]) -> Option<()>
where
    f64: Lift<T>,
{
    let [first, second] = frames;
    let axes = first.placement.rotation;
    let relative: Mat3<T> = axes.transpose() * second.placement.rotation;
    let half = T::from_f64(0.5);
    let trace = relative.x.x + relative.y.y + relative.z.z;
    let four_squares = T::one() + trace;
    // NaN ends here too.
    let turned_less = four_squares.min_lane() > 4.0 * LEAST * LEAST;
    if !turned_less {
        return None;
    }
    let w = four_squares.sqrt() * half;
    let twice_sine = Vec3::new(relative.z.y - relative.y.z, relative.x.z - relative.z.x, relative.y.x - relative.x.y);
    let phi = twice_sine * (half / w);

    let across = second.velocity.ang - first.velocity.ang;
    let omega = axes.transpose_mul(across);
    let bend = second.acceleration.ang - first.acceleration.ang - first.velocity.ang.cross(across);
    let alpha = axes.transpose_mul(bend);
    let map = |x: Vec3<T>| (x * half).cross_add(phi, x * w);
    let rate = map(omega);
    let w_rate = omega.dot(phi) * T::from_f64(-0.25);
    let bias = map(alpha) + omega * w_rate + (omega * half).cross(rate);

    let (residuals, biases) = (phi.to_array(), bias.to_array());
    for (k, row) in rows.iter_mut().enumerate() {
        // Eᵀ e_k = w e_k + ½ φ × e_k
        let mut unit = [T::zero(); 3];
        unit[k] = T::one();
        let unit = Vec3::from_array(unit);
        row.set_moments(frames, axes * (phi * half).cross_add(unit, unit * w));
        (row.residual, row.bias) = (residuals[k], biases[k]);
    }
    Some(())
}
