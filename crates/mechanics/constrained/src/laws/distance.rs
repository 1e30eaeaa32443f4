//! Two points at a distance: one row.
//!
//! Computes `φ = (d·d − l²) / (2 l)`, `φ̇ = d·ḋ / l`, and the bias `(ḋ·ḋ + d·d̈) / l` with the accelerations at v̇ = 0. Near its zero φ is
//! |d| − l. It has no square root, so it is smooth where the points meet; the row is zero there.
//! Source: the book, section 8.2, with the square of the distance. Units: m. A positive multiplier pushes the points apart.

use super::Row;
use crate::attachment::Anchor;
use featherbench_spatial::{Lift, Real, Vec3};

/// The row of a distance `length`.
pub(crate) fn set<T: Real>(frames: &[Anchor<T>; 2], length: f64, row: &mut Row<T>)
where
    f64: Lift<T>,
{
    let [first, second] = frames;
    let length = T::from_f64(length);
    let d = second.placement.translation - first.placement.translation;
    let rate = second.velocity.lin - first.velocity.lin;
    let bend = second.acceleration.lin - first.acceleration.lin;
    let push = d * (T::one() / length);
    row.wrenches = [first.wrench(Vec3::zero(), -push), second.wrench(Vec3::zero(), push)];
    row.residual = T::from_f64(0.5) * (push.dot(d) - length);
    row.bias = rate.dot(rate) / length + push.dot(bend);
}
