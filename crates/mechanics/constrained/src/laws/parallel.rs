//! The z axes of two frames parallel: two rows, along x and y of the first frame.
//!
//! Computes, for the axis a of frame A and b = z of frame B: `φ = a·b`, `φ̇ = (ω_B − ω_A)·(b × a)`, and the bias
//! `(ω̇_A × a + ω_A × (ω_A × a))·b + 2 (ω_A × a)·(ω_B × b) + a·(ω̇_B × b + ω_B × (ω_B × b))` with the accelerations at v̇ = 0.
//! It also holds where the z axes are opposite. Unlike an orientation it knows no half turn: a hinge may turn as far as it likes.
//! Source: P. E. Nikravesh, *Computer-Aided Analysis of Mechanical Systems* (1988), chapter 7 (two parallel vectors). Units: none.

use super::Row;
use crate::attachment::Anchor;
use featherbench_spatial::{Lift, Real};

/// The row along axis `k` of the first frame.
pub(crate) fn set<T: Real>(frames: &[Anchor<T>; 2], k: usize, row: &mut Row<T>)
where
    f64: Lift<T>,
{
    let [first, second] = frames;
    let (a, b) = (first.axis(k), second.axis(2));
    let [a_rate, b_rate] = [first.velocity.ang.cross(a), second.velocity.ang.cross(b)];
    let a_curve = first.velocity.ang.cross_add(a_rate, first.acceleration.ang.cross(a));
    let b_curve = second.velocity.ang.cross_add(b_rate, second.acceleration.ang.cross(b));
    row.set_moments(frames, b.cross(a));
    row.residual = a.dot(b);
    row.bias = a_curve.dot(b) + T::from_f64(2.0) * a_rate.dot(b_rate) + a.dot(b_curve);
}
