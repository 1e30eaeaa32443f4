//! Gauss–Legendre points and weights on [0, 1]: n points are exact for polynomials of degree 2n − 1.
//!
//! Method: Newton's iteration on the Legendre polynomial by its three-term recurrence, from Tricomi's guess.

use std::f64::consts::PI;

/// The points, increasing, with their weights; the weights have the sum 1.
pub fn gauss(count: usize) -> Vec<(f64, f64)> {
    let mut rule = Vec::with_capacity(count);
    for i in 0..count {
        let n = count as f64;
        let mut x = -(PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        // Quadratic convergence from a guess with an error of 1/n²: six steps reach rounding.
        for _ in 0..6 {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=count {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        rule.push((0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope)));
    }
    rule
}

/// The rule of `count` points on each of `parts` equal parts of [0, 1].
pub fn composite(parts: usize, count: usize) -> Vec<(f64, f64)> {
    let (rule, width) = (gauss(count), 1.0 / parts as f64);
    (0..parts).flat_map(|part| rule.iter().map(move |(x, w)| ((part as f64 + x) * width, w * width))).collect()
}
