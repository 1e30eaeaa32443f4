//! §4: the lesson's equation of a continuum is a string's.
//!
//! ρ ẍ = ∂T/∂s with the force T along the string: a hanging chain has ω = (j₀ₖ/2) √(g/L), j₀ₖ the zeros of Bessel's J₀. A beam needs
//! −EI w⁗: a cantilever has ω = β² √(EI/ρAL⁴), cos β cosh β = −1. First routes: these roots. Second: Galerkin's method with Legendre
//! polynomials P that have the right zeros at the clamp, (1 − ξ) P(ξ) for the chain from its free end, s² P(s) for the beam.

use crate::claim::{Claim, Failure, Holds, Number};
use crate::quadrature::Rule;
use featherbench_spatial::{DoubleDouble, Real};
use nalgebra::{Cholesky, DMatrix};

/// Shapes of Galerkin's method: more change no digit, and lose some to rounding.
const SHAPES: usize = 14;

/// The root of f between two arguments of unequal sign, to the last digit.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let rising = f(high) > 0.0;
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if (f(middle) > 0.0) == rising { high = middle } else { low = middle }
    }
}

/// J₀(x) = Σ (−x²/4)ᵏ/(k!)², in double-double: terms up to 10³ cancel.
fn bessel(x: f64) -> f64 {
    let quarter = DoubleDouble::from_f64(-0.25 * x) * DoubleDouble::from_f64(x);
    let (mut sum, mut term) = (DoubleDouble::zero(), DoubleDouble::one());
    for k in 1..80 {
        sum += term;
        let k = DoubleDouble::from_f64(f64::from(k));
        term = term * quarter / (k * k);
    }
    sum.to_f64()
}

/// P of degree k on [0, 1], its slope and its curvature: by the recurrence of the polynomial and its derivatives.
fn legendre(k: usize, s: f64) -> [f64; 3] {
    let x = 2.0 * s - 1.0;
    let (mut before, mut now) = ([0.0; 3], [1.0, 0.0, 0.0]);
    for j in 0..k {
        let j = j as f64;
        let (rise, fall) = ((2.0 * j + 1.0) / (j + 1.0), j / (j + 1.0));
        let next = [
            rise * x * now[0] - fall * before[0],
            rise * (2.0 * now[0] + x * now[1]) - fall * before[1],
            rise * (4.0 * now[1] + x * now[2]) - fall * before[2],
        ];
        (before, now) = (now, next);
    }
    now
}

/// The smallest frequencies of ∫ stiffness against ∫ φφ, smallest first.
fn galerkin(shape: impl Fn(usize, f64) -> [f64; 3], stiffness: impl Fn([f64; 3], [f64; 3], f64) -> f64) -> Result<Vec<f64>, Failure> {
    let rule = Rule::gauss(SHAPES + 4);
    let matrix = |of: &dyn Fn([f64; 3], [f64; 3], f64) -> f64| {
        DMatrix::from_fn(SHAPES, SHAPES, |i, j| rule.integral(0.0, 1.0, |s| of(shape(i, s), shape(j, s), s)))
    };
    let (k, m) = (matrix(&stiffness), matrix(&|a, b, _| a[0] * b[0]));
    // 1/ω² are the largest eigenvalues of L⁻¹ M L⁻ᵀ with K = L Lᵀ: so the smallest ω keep their digits.
    let lower = Cholesky::new(k).ok_or_else(|| Failure::of("the stiffness is not positive definite"))?.unpack();
    let half = lower.solve_lower_triangular(&m).ok_or_else(|| Failure::of("the stiffness is singular"))?;
    let whole = lower.solve_lower_triangular(&half.transpose()).ok_or_else(|| Failure::of("the stiffness is singular"))?;
    let even = 0.5 * (&whole + whole.transpose());
    let mut values: Vec<f64> = even.symmetric_eigen().eigenvalues.iter().map(|value| 1.0 / value.sqrt()).collect();
    values.sort_by(f64::total_cmp);
    Ok(values)
}

/// The hanging chain from its free end: (ξ w′)′ + ω² w = 0 with w(1) = 0.
fn chain() -> Result<Vec<f64>, Failure> {
    let shape = |k: usize, s: f64| {
        let [p, slope, curvature] = legendre(k, s);
        [(1.0 - s) * p, (1.0 - s) * slope - p, (1.0 - s) * curvature - 2.0 * slope]
    };
    galerkin(shape, |a, b, s| s * a[1] * b[1])
}

/// The cantilever: w⁗ = ω² w, clamped at 0.
fn cantilever() -> Result<Vec<f64>, Failure> {
    let shape = |k: usize, s: f64| {
        let [p, slope, curvature] = legendre(k, s);
        [s * s * p, s * s * slope + 2.0 * s * p, s * s * curvature + 4.0 * s * slope + 2.0 * p]
    };
    galerkin(shape, |a, b, _| a[2] * b[2])
}

/// A string.
pub(super) const STRING: Claim = Claim {
    id: "continuum_string",
    place: "§4",
    title: "The equation of a continuum",
    says: "ρ ẍ = ∂T/∂s + f is a model of a one-dimensional continuum.",
    right: "It is a string's. With the weight as its tension it is the hanging chain, ω = (j₀ₖ/2)√(g/L).",
    holds: Holds::Yes,
    numbers: |_| {
        let second = chain()?;
        let brackets = [(2.0, 3.0), (5.0, 6.0), (8.0, 9.0)];
        let number = |(k, (low, high)): (usize, (f64, f64))| {
            let known = 0.5 * root(bessel, low, high);
            Number::new(format!("frequency {} of a hanging chain over √(g/L)", k + 1), "1", known, second[k]).stated(second[k], 0.0)
        };
        Ok(brackets.into_iter().enumerate().map(number).collect())
    },
};

/// A beam.
pub(super) const BEAM: Claim = Claim {
    id: "continuum_beam",
    place: "§4",
    title: "Bending",
    says: "The same equation, with shape functions, is the model of soft and continuum robots.",
    right: "It has no bending. A cantilever without tension would not come back: ω = 0. The term −EI w⁗ is missing.",
    holds: Holds::No,
    numbers: |_| {
        let second = cantilever()?;
        // cos β cosh β = −1 over cosh β, so that large β do not overflow the sign.
        let characteristic = |beta: f64| beta.cos() + 1.0 / beta.cosh();
        let brackets = [(1.5, 2.5), (4.0, 5.5), (7.0, 8.5)];
        let number = |(k, (low, high)): (usize, (f64, f64))| {
            let beta = root(characteristic, low, high);
            let name = format!("frequency {} of a cantilever over √(EI/ρAL⁴)", k + 1);
            Number::new(name, "1", beta * beta, second[k]).stated(0.0, -second[k])
        };
        Ok(brackets.into_iter().enumerate().map(number).collect())
    },
};
