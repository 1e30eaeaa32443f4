//! A point of one frame on the origin of another: rows along axes of the first frame.
//!
//! Computes, for the axis a of frame A: `φ = a·d`, `φ̇ = a·(ṗ_B − ṗ_A) + ω_A·(a × d)`, and the bias
//! `a·(p̈_B − p̈_A) + 2 (ω_A × a)·ḋ + (ω̇_A × a + ω_A × (ω_A × a))·d` with the accelerations at v̇ = 0.
//! So the row is a unit force along a at p_B on body B, and its opposite at the same point on body A.
//! Source: the book, section 8.2 (loop constraints), with the rows in the axes of the predecessor's frame. Units: m.

use super::Row;
use crate::attachment::Anchor;
use featherbench_spatial::{Lift, Real, Vec3};

/// The row along axis `k` of the first frame.
pub(crate) fn set<T: Real>(frames: &[Anchor<T>; 2], k: usize, row: &mut Row<T>)
where
    f64: Lift<T>,
{
    let [first, second] = frames;
    let axis = first.axis(k);
    let d = second.placement.translation - first.placement.translation;
    let rate = second.velocity.lin - first.velocity.lin;
    let (omega, alpha) = (first.velocity.ang, first.acceleration.ang);
    let turning = omega.cross(axis);
    let curving = omega.cross_add(turning, alpha.cross(axis));
    row.wrenches = [first.wrench(axis.cross(d), -axis), second.wrench(Vec3::zero(), axis)];
    row.residual = axis.dot(d);
    let straight = axis.dot(second.acceleration.lin - first.acceleration.lin);
    row.bias = straight + T::from_f64(2.0) * turning.dot(rate) + curving.dot(d);
}
