//! Shape functions on [0, 1] that satisfy the clamped end: what a Ritz discretisation is made of.
//!
//! | basis | of bending (φ(0) = φ'(0) = 0) | of extension and twist (φ(0) = 0) |
//! |---|---|---|
//! | monomials, r | s², …, s^{r+1} | s, …, s^r |
//! | modes, r | the first r exact modes of a cantilever, φ(1) = ±2 | sin((2j − 1) π s/2) |
//! | Hermite, m | cubic splines on m parts: w and w' at the m nodes | linear splines: the value at the m nodes |
//!
//! The modes of a cantilever are cosh βs − cos βs − σ (sinh βs − sin βs), σ = (cosh β + cos β)/(sinh β + sin β). Written like that they
//! lose all digits for large β. Here cosh − σ sinh is written by exponentials of what is at most 0: with c = (1 − σ)/2 it is
//! `e^{−βs} (1 − c) + c e^{βs}`, and c e^{β} is known without cancellation.

use std::f64::consts::{FRAC_PI_2, PI};

/// A basis of shape functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Powers of s: as many terms.
    Monomials(usize),
    /// Exact modes of the clamped rod: as many terms.
    Modes(usize),
    /// Hermite splines on as many equal parts, with two coordinates each for bending and one for extension and twist.
    Hermite(usize),
}

/// A shape function at a place: its value and derivatives by s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// φ
    pub value: f64,
    /// φ'
    pub slope: f64,
    /// φ''
    pub curvature: f64,
    /// φ''''
    pub fourth: f64,
}

impl Basis {
    /// The number of shape functions, of bending or of extension and twist.
    pub fn terms(self, bending: bool) -> usize {
        match self {
            Self::Monomials(terms) | Self::Modes(terms) => terms,
            Self::Hermite(parts) => parts * if bending { 2 } else { 1 },
        }
    }

    /// The parts and points of a Gauss rule that integrates products of two shape functions: exactly for polynomials, and to rounding for
    /// modes.
    pub fn rule(self, bending: bool) -> Vec<(f64, f64)> {
        let (parts, points) = match self {
            // The product of two functions of degree r + 1 has the degree 2r + 2.
            Self::Monomials(terms) => (1, terms + 2),
            // Eight points per half wave: the error of Gauss' rule for sin² over half a wave is below 1e-16.
            Self::Modes(terms) => (2 * terms, 10),
            Self::Hermite(parts) => (parts, if bending { 4 } else { 2 }),
        };
        crate::quadrature::composite(parts, points)
    }

    /// Shape function `j` at s in [0, 1].
    pub fn at(self, bending: bool, j: usize, s: f64) -> Shape {
        match (self, bending) {
            (Self::Monomials(_), _) => power(j + if bending { 2 } else { 1 }, s),
            (Self::Modes(_), true) => cantilever_mode(j, s),
            (Self::Modes(_), false) => {
                let k = (2 * j + 1) as f64 * FRAC_PI_2;
                let (sin, cos) = (k * s).sin_cos();
                Shape { value: sin, slope: k * cos, curvature: -k * k * sin, fourth: k.powi(4) * sin }
            }
            (Self::Hermite(parts), true) => cubic(parts, j, s),
            (Self::Hermite(parts), false) => hat(parts, j, s),
        }
    }
}

/// s^p
fn power(p: usize, s: f64) -> Shape {
    let term = |order: usize| {
        let factor: f64 = (0..order).map(|i| p as f64 - i as f64).product();
        if p < order { 0.0 } else { factor * s.powi((p - order) as i32) }
    };
    Shape { value: term(0), slope: term(1), curvature: term(2), fourth: term(4) }
}

/// Root number `k`, from 0, of cos β cosh β = −1.
pub fn cantilever_root(k: usize) -> f64 {
    let mut beta = if k == 0 { 1.875 } else { (k as f64 + 0.5) * PI };
    // From a guess within 2e-2: five steps of quadratic convergence.
    for _ in 0..5 {
        let sech = 1.0 / beta.cosh();
        let (sin, cos) = beta.sin_cos();
        beta -= (cos + sech) / (-sin - sech * beta.tanh());
    }
    beta
}

/// Mode `j` of a cantilever, with ∫ φ² = 1.
fn cantilever_mode(j: usize, s: f64) -> Shape {
    let beta = cantilever_root(j);
    let (sin_end, cos_end) = beta.sin_cos();
    // σ, and c e^β = ½ (1 − σ) e^β = ½ e^β (sinh + sin − cosh − cos)/(sinh + sin) = (sin β − cos β − e^{−β}) / (1 − e^{−2β} + 2 e^{−β} sin
    // β)
    let decayed = (-beta).exp();
    let grown = (sin_end - cos_end - decayed) / (1.0 - decayed * decayed + 2.0 * decayed * sin_end);
    let sigma = 1.0 - 2.0 * grown * decayed;
    // cosh − σ sinh = f + g, f = (1 + σ)/2 e^{−βs} and g = c e^{βs}
    let (falling, growing) = (0.5 * (1.0 + sigma) * (-beta * s).exp(), grown * (beta * (s - 1.0)).exp());
    let (sin, cos) = (beta * s).sin_cos();
    Shape {
        value: falling + growing - cos + sigma * sin,
        slope: beta * (growing - falling + sin + sigma * cos),
        curvature: beta.powi(2) * (falling + growing + cos - sigma * sin),
        fourth: beta.powi(4) * (falling + growing - cos + sigma * sin),
    }
}

/// Cubic Hermite function `j`: of node j/2 + 1, its value if j is even and its slope by s if j is odd.
fn cubic(parts: usize, j: usize, s: f64) -> Shape {
    let (node, slope, h) = (j / 2 + 1, j % 2 == 1, 1.0 / parts as f64);
    let part = part_of(parts, s);
    let t = s / h - part as f64;
    // On the part that ends at the node, and on the one that begins there: value, t-derivatives.
    let [a, b, c, d] = match (part + 1 == node, part == node, slope) {
        (true, _, false) => [t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t), 6.0 - 12.0 * t, 0.0],
        (true, _, true) => [t * t * (t - 1.0) * h, t * (3.0 * t - 2.0) * h, (6.0 * t - 2.0) * h, 0.0],
        (_, true, false) => [1.0 - t * t * (3.0 - 2.0 * t), -6.0 * t * (1.0 - t), 12.0 * t - 6.0, 0.0],
        (_, true, true) => [t * (1.0 - t) * (1.0 - t) * h, (1.0 - t) * (1.0 - 3.0 * t) * h, (6.0 * t - 4.0) * h, 0.0],
        _ => [0.0; 4],
    };
    Shape { value: a, slope: b / h, curvature: c / (h * h), fourth: d }
}

/// Linear spline `j`: 1 at node j + 1.
fn hat(parts: usize, j: usize, s: f64) -> Shape {
    let (node, n) = (j + 1, parts as f64);
    let part = part_of(parts, s);
    let t = s * n - part as f64;
    let (value, slope) = if part + 1 == node {
        (t, n)
    } else if part == node {
        (1.0 - t, -n)
    } else {
        (0.0, 0.0)
    };
    Shape { value, slope, curvature: 0.0, fourth: 0.0 }
}

/// The part that s is on; the end belongs to the last one.
fn part_of(parts: usize, s: f64) -> usize {
    ((s * parts as f64) as usize).min(parts - 1)
}
