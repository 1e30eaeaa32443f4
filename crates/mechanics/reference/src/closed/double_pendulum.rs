//! The double pendulum, or 2R arm in a vertical plane: its accelerations by Cramer's rule.
//!
//! Computes, with q₁ from the upward vertical and q₂ relative to the first link, b = m₂ l₁ r₂:
//!
//! ```text
//! M₁₁ = I₁ + m₁r₁² + m₂l₁² + M₂₂ + 2b cos q₂    M₁₂ = M₂₂ + b cos q₂    M₂₂ = I₂ + m₂r₂²
//! h₁ = −b sin q₂ (2q̇₁q̇₂ + q̇₂²) − g (m₁r₁ + m₂l₁) sin q₁ − g m₂r₂ sin(q₁ + q₂)
//! h₂ =  b sin q₂ q̇₁² − g m₂r₂ sin(q₁ + q₂)
//! ```
//!
//! Source: Spong, Hutchinson & Vidyasagar, *Robot Modeling and Control* (2006), chapter 7, here from the upward vertical. Cost: two sines.

use crate::Mp;

/// Two links in a plane.
#[derive(Clone, Debug)]
pub struct DoublePendulum {
    /// Masses.
    pub mass: [Mp; 2],
    /// Length of the first link.
    pub length: Mp,
    /// Distances of the centres of mass from the links' own joints.
    pub reach: [Mp; 2],
    /// Moments of inertia about the centres of mass.
    pub inertia: [Mp; 2],
    /// Gravitational acceleration, downwards.
    pub gravity: Mp,
}

impl DoublePendulum {
    /// Links of constant cross-section with these lengths: centres half-way, I = ml²/12.
    pub fn uniform(mass: [Mp; 2], length: [Mp; 2], gravity: Mp) -> Self {
        let twelve = mass[0].precision().integer(12);
        let inertia = std::array::from_fn(|i| &mass[i] * &length[i] * &length[i] / &twelve);
        let reach = std::array::from_fn(|i| length[i].half());
        let [length, _] = length;
        Self { mass, length, reach, inertia, gravity }
    }

    /// Point masses at the ends of massless links with these lengths.
    pub fn tips(mass: [Mp; 2], length: [Mp; 2], gravity: Mp) -> Self {
        let first = length[0].clone();
        Self { mass, length: first, reach: length, inertia: [Mp::zero(), Mp::zero()], gravity }
    }

    /// q̈ at angles q, rates v and joint torques τ.
    pub fn acceleration(&self, q: &[Mp; 2], v: &[Mp; 2], tau: &[Mp; 2]) -> [Mp; 2] {
        let ([m1, m2], [r1, r2], [i1, i2]) = (&self.mass, &self.reach, &self.inertia);
        let (sin, cos) = q[1].sin_cos();
        let coupling = m2 * &self.length * r2;
        let m22 = i2 + m2 * r2 * r2;
        let m12 = &m22 + &coupling * &cos;
        let m11 = i1 + m1 * r1 * r1 + m2 * &self.length * &self.length + &m22 + (&coupling * &cos).twice();
        let lift = |angle: &Mp| &self.gravity * angle.sin_cos().0;
        let outer = m2 * r2 * lift(&(&q[0] + &q[1]));
        let h1 = -(&coupling * &sin * ((&v[0] * &v[1]).twice() + &v[1] * &v[1])) - (m1 * r1 + m2 * &self.length) * lift(&q[0]) - &outer;
        let h2 = &coupling * &sin * &v[0] * &v[0] - outer;
        let (f1, f2) = (&tau[0] - h1, &tau[1] - h2);
        let determinant = &m11 * &m22 - &m12 * &m12;
        [(&m22 * &f1 - &m12 * &f2) / &determinant, (&m11 * &f2 - &m12 * &f1) / &determinant]
    }
}
