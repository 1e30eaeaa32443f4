//! Quadrature: Gauss and Legendre's rule of any order, from the eigenvalues of its Jacobi matrix, and Simpson's rule as a second route.
//!
//! Source: G. Golub and J. Welsch, *Calculation of Gauss quadrature rules* (1969). A rule of n points is exact for polynomials up to degree
//! 2n − 1.

use nalgebra::{DMatrix, SymmetricEigen};

/// Points and weights on [−1, 1].
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    points: Vec<(f64, f64)>,
}

impl Rule {
    /// The rule of n points.
    ///
    /// ```
    /// let rule = featherbench_lesson::Rule::gauss(8);
    /// assert!((rule.integral(0.0, 2.0, |x| x.powi(15)) - 4096.0).abs() < 1e-10);
    /// ```
    pub fn gauss(n: usize) -> Self {
        let beside = |k: usize| {
            let k = k as f64;
            k / (4.0 * k * k - 1.0).sqrt()
        };
        let jacobi = DMatrix::from_fn(n, n, |i, j| if i.abs_diff(j) == 1 { beside(i.max(j)) } else { 0.0 });
        // A Newton step on the Legendre polynomial takes each eigenvalue to the last digit; the weight is 2/((1 − x²) Pₙ′²).
        let polished = |x: f64| {
            let (_, slope) = legendre(n, x);
            let x = x - legendre(n, x).0 / slope;
            let slope = legendre(n, x).1;
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        };
        Self { points: SymmetricEigen::new(jacobi).eigenvalues.iter().map(|x| polished(*x)).collect() }
    }

    /// ∫ f from a to b.
    pub fn integral(&self, a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        self.points.iter().map(|(x, weight)| half * weight * f(middle + half * x)).sum()
    }

    /// ∫ f from a to b on equal panels.
    pub fn on_panels(&self, a: f64, b: f64, panels: usize, f: impl Fn(f64) -> f64) -> f64 {
        let at = |k: usize| a + (b - a) * k as f64 / panels as f64;
        (0..panels).map(|k| self.integral(at(k), at(k + 1), &f)).sum()
    }
}

/// Pₙ and its derivative, |x| < 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut now) = (0.0, 1.0);
    for k in 1..=n {
        let k = k as f64;
        (before, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k);
    }
    (now, n as f64 * (before - x * now) / (1.0 - x * x))
}

/// ∫ f from a to b by Simpson's rule on `2·half` equal steps: of fourth order.
pub(crate) fn simpson(a: f64, b: f64, half: usize, f: impl Fn(f64) -> f64) -> f64 {
    let steps = 2 * half;
    let at = |k: usize| a + (b - a) * k as f64 / steps as f64;
    let weight = |k: usize| {
        if k == 0 || k == steps {
            1.0
        } else if k.is_multiple_of(2) {
            2.0
        } else {
            4.0
        }
    };
    (0..=steps).map(|k| weight(k) * f(at(k))).sum::<f64>() * (b - a) / (3.0 * steps as f64)
}
