//! Constraints between coordinates of one-dof joints: gear trains and joints that follow others. One row each.
//!
//! | | residual φ | row J | bias J̇v |
//! |---|---|---|---|
//! | gear | Σ c_k q_k − offset | c_k | 0 |
//! | mimic | q_f − p(q_l) | 1 and −p'(q_l) | −p''(q_l) v_l² |
//!
//! p is a polynomial of degree four at most, as in MuJoCo's joint equality; URDF's `mimic` is offset + multiplier·q. Units: those of the
//! coordinates.

use super::Row;
use featherbench_spatial::Real;

/// A coordinate: its dof, its number and its rate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coordinate<T> {
    pub(crate) dof: usize,
    pub(crate) q: T,
    pub(crate) v: T,
}

/// The row of a gear train: coefficients and coordinates.
pub(crate) fn set_gear<T: Real>(terms: impl Iterator<Item = (f64, Coordinate<T>)>, offset: f64, row: &mut Row<T>) {
    row.residual = T::from_f64(-offset);
    row.bias = T::zero();
    for (coefficient, Coordinate { dof, q, .. }) in terms {
        let coefficient = T::from_f64(coefficient);
        row.residual = coefficient.mul_add(q, row.residual);
        row.dofs.push((dof, coefficient));
    }
}

/// The row of a joint that follows another by a polynomial; coefficients by rising power.
pub(crate) fn set_mimic<T: Real>(follower: Coordinate<T>, leader: Coordinate<T>, polynomial: &[f64; 5], row: &mut Row<T>) {
    // Horner's rule for p, p' and p''/2
    let (mut value, mut slope, mut half_curve) = (T::zero(), T::zero(), T::zero());
    for coefficient in polynomial.iter().rev() {
        half_curve = half_curve.mul_add(leader.q, slope);
        slope = slope.mul_add(leader.q, value);
        value = value.mul_add(leader.q, T::from_f64(*coefficient));
    }
    row.residual = follower.q - value;
    row.bias = -(half_curve * T::from_f64(2.0) * leader.v * leader.v);
    row.dofs.extend([(follower.dof, T::one()), (leader.dof, -slope)]);
}
