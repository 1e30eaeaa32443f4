//! One step by extrapolation of Gragg's midpoint rule: an embedded pair of orders 2κ and 2κ − 2 for any number of columns κ, with the value
//! in the middle of the step.
//!
//! ```text
//! δ₀ = 0,  δ₁ = ĥ f(x₀),  δ_{m+1} = δ_{m−1} + 2ĥ f(x₀ + δ_m),   ĥ = h/n,  n = 2, 6, 10, …, 4κ − 2
//! x₁ = x₀ + Σⱼ wⱼ δ⁽ʲ⁾,   wⱼ = Π_{i≠j} nⱼ²/(nⱼ² − nᵢ²)
//! ```
//!
//! The error estimate is the difference to the same sum over the last κ − 1 columns. The weights are rational, so every scalar has them to
//! its own precision: one text serves f64, duals and double-double. All n are twice an odd number; so δ_{n/2} has an expansion in ĥ² too,
//! and the same weights give the middle. Increments are extrapolated, not states: the rounding of the weights meets h f only.
//!
//! Source: E. Hairer, S. P. Nørsett and G. Wanner, *Solving Ordinary Differential Equations I* (1993), §II.9, with the dense
//! output of ODEX. Cost: κ(2κ − 1) evaluations of f, and one at the start; dense output and its check add four.

use crate::run::Step;
use crate::system::{Hybrid, seeded};
use featherbench_spatial::{Dual, Real};

/// A number of columns with their weights.
#[derive(Clone, Debug)]
pub(crate) struct Extrapolation<T> {
    /// nⱼ, wⱼ, and the weight of the estimate: wⱼ less that of the lower order.
    columns: Vec<(usize, T, T)>,
}

/// What a step gives.
pub(crate) struct Trial<T> {
    pub(crate) middle: Vec<T>,
    pub(crate) end: Vec<T>,
    pub(crate) error: Vec<T>,
}

impl<T: Real> Extrapolation<T> {
    pub(crate) fn new(columns: usize) -> Self {
        let subdivisions: Vec<usize> = (1..=columns).map(|column| 4 * column - 2).collect();
        let square = |n: usize| T::from_f64((n * n) as f64);
        let weight = |n: usize, among: &[usize]| {
            let others = among.iter().filter(|other| **other != n);
            others.fold(T::one(), |product, other| product * (square(n) / (square(n) - square(*other))))
        };
        let of = |(index, n): (usize, &usize)| {
            let full = weight(*n, &subdivisions);
            let lower = if index == 0 { T::zero() } else { weight(*n, &subdivisions[1..]) };
            (*n, full, full - lower)
        };
        Self { columns: subdivisions.iter().enumerate().map(of).collect() }
    }

    /// The exponent of h in the error estimate.
    pub(crate) fn estimate_order(&self) -> f64 {
        2.0 * self.columns.len() as f64 - 1.0
    }

    /// A step of length `h` from `x` at `t`, where the field is `first`.
    pub(crate) fn step(&self, mut field: impl FnMut(T, &[T], &mut [T]), t: T, h: T, x: &[T], first: &[T]) -> Trial<T> {
        let mut trial = Trial { middle: x.to_vec(), end: x.to_vec(), error: vec![T::zero(); x.len()] };
        for (n, weight, difference) in &self.columns {
            let mut add = |m: usize, increment: &[T]| {
                for (k, increment) in increment.iter().enumerate() {
                    if 2 * m == *n {
                        trial.middle[k] = weight.mul_add(*increment, trial.middle[k]);
                    }
                    if m == *n {
                        trial.end[k] = weight.mul_add(*increment, trial.end[k]);
                        trial.error[k] = difference.mul_add(*increment, trial.error[k]);
                    }
                }
            };
            midpoint_rule(&mut field, *n, t, h, x, first, |m, increment| add(m, increment));
        }
        trial
    }

    /// The transpose of the derivative of a step times a gradient: λ after the step becomes that before it, and the gradient of the
    /// parameters is added to `parameters`.
    pub(crate) fn pull<S: Hybrid>(&self, system: &S, theta: &[T], step: &Step<T>, gradient: &mut [T], parameters: &mut [T]) {
        let &Step { mode, time: t, length: h, state: ref x } = step;
        let states = x.len();
        let mut first = vec![T::zero(); states];
        system.flow(mode, t, x, theta, &mut first);
        let after = gradient.to_vec();
        for (n, weight, _) in &self.columns {
            let part = h / T::from_f64(*n as f64);
            let mut increments = vec![vec![T::zero(); states]];
            let field = |t: T, x: &[T], rate: &mut [T]| system.flow(mode, t, x, theta, rate);
            midpoint_rule(field, *n, t, h, x, &first, |_, increment| increments.push(increment.to_vec()));
            // The gradients of δ_{m+1} and δ_m.
            let mut upper: Vec<T> = after.iter().map(|gradient| *weight * *gradient).collect();
            let mut lower = vec![T::zero(); states];
            for m in (0..*n).rev() {
                let at: Vec<T> = x.iter().zip(&increments[m]).map(|(x, increment)| *x + *increment).collect();
                let time = part.mul_add(T::from_f64(m as f64), t);
                let factor = if m == 0 { part } else { part + part };
                let seed: Vec<T> = upper.iter().map(|gradient| factor * *gradient).collect();
                let pulled = transpose_flow(system, theta, mode, time, &at, &seed, parameters);
                for (gradient, pulled) in gradient.iter_mut().zip(&pulled) {
                    *gradient += *pulled;
                }
                // δ_m moves δ_{m+1} through f alone; δ_{m−1} moves it directly.
                let next: Vec<T> = lower.iter().zip(&pulled).map(|(lower, pulled)| *lower + *pulled).collect();
                lower = upper;
                upper = next;
            }
        }
    }
}

/// The increments δ₁ … δₙ of Gragg's rule, one after another.
fn midpoint_rule<T: Real>(
    mut field: impl FnMut(T, &[T], &mut [T]),
    n: usize,
    t: T,
    h: T,
    x: &[T],
    first: &[T],
    mut visit: impl FnMut(usize, &[T]),
) {
    let part = h / T::from_f64(n as f64);
    let mut before = vec![T::zero(); x.len()];
    let mut now: Vec<T> = first.iter().map(|rate| part * *rate).collect();
    let (mut at, mut rate) = (x.to_vec(), first.to_vec());
    visit(1, &now);
    for m in 1..n {
        for ((at, x), now) in at.iter_mut().zip(x).zip(&now) {
            *at = *x + *now;
        }
        field(part.mul_add(T::from_f64(m as f64), t), &at, &mut rate);
        for (before, rate) in before.iter_mut().zip(&rate) {
            *before = (part + part).mul_add(*rate, *before);
        }
        std::mem::swap(&mut before, &mut now);
        visit(m + 1, &now);
    }
}

/// (∂f/∂x)ᵀ times a gradient; (∂f/∂θ)ᵀ times it is added to `parameters`.
fn transpose_flow<S: Hybrid, T: Real>(system: &S, theta: &[T], mode: usize, t: T, x: &[T], gradient: &[T], parameters: &mut [T]) -> Vec<T> {
    let mut rate = vec![Dual::constant(T::zero()); x.len()];
    let mut along = |input: usize| {
        let (at, theta) = (seeded(x, input), seeded(theta, input.wrapping_sub(x.len())));
        system.flow(mode, Dual::constant(t), &at, &theta, &mut rate);
        rate.iter().zip(gradient).fold(T::zero(), |sum, (rate, gradient)| rate.derivative.mul_add(*gradient, sum))
    };
    let state = (0..x.len()).map(&mut along).collect();
    for (index, parameter) in parameters.iter_mut().enumerate() {
        *parameter += along(x.len() + index);
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dense::Dense;
    use featherbench_spatial::DoubleDouble;

    type Number = DoubleDouble;

    fn rotation(_: Number, x: &[Number], rate: &mut [Number]) {
        (rate[0], rate[1]) = (x[1], -x[0]);
    }

    /// One step of ẍ = −x from (1, 0): its errors at the end, in the middle, and of the dense output at a quarter.
    fn errors(columns: usize, h: f64) -> [f64; 4] {
        let number = Number::from_f64;
        let (start, first) = ([number(1.0), number(0.0)], [number(0.0), number(-1.0)]);
        let trial = Extrapolation::new(columns).step(rotation, number(0.0), number(h), &start, &first);
        let rate = |x: &[Number]| [x[1], -x[0]];
        let (middle, end) = (rate(&trial.middle), rate(&trial.end));
        let dense = Dense::new(number(0.0), number(h), [(&start, &first), (&trial.middle, &middle), (&trial.end, &end)]);
        let (_, quarter, _) = dense.at(0.25);
        let off = |x: &[Number], part: f64| (x[0] - number(h * part).sin_cos().1).abs().to_f64();
        [off(&trial.end, 1.0), off(&trial.middle, 0.5), off(&quarter, 0.25), trial.error[0].abs().to_f64()]
    }

    /// The local errors fall like h^(2κ+1) at the end, at least like h^(2κ) in the middle, like h⁶ on the dense output, and the estimate
    /// like h^(2κ−1). The first state is even in h: its errors and estimates of odd order are one order higher.
    #[test]
    fn orders_are_those_of_the_theory() {
        for columns in [2, 3, 4, 6] {
            let (long, short) = (errors(columns, 0.2), errors(columns, 0.1));
            let orders: Vec<f64> = long.iter().zip(short).map(|(long, short)| (long / short).log2()).collect();
            let order = 2.0 * columns as f64;
            println!("κ = {columns}: {orders:?}");
            // The next term changes a slope by some h² = 4 %.
            assert!((orders[0] - order - 2.0).abs() < 0.1, "{orders:?}");
            assert!(orders[1] > order - 0.1, "{orders:?}");
            assert!((orders[3] - order).abs() < 0.1, "{orders:?}");
            if columns > 3 {
                assert!((orders[2] - 6.0).abs() < 0.1, "{orders:?}");
            }
        }
    }

    /// A polynomial of degree 5 is its own dense output, with its rate.
    #[test]
    fn dense_output_is_exact_for_degree_five() {
        let value = |t: f64| 1.0 + t * (2.0 - t * (0.5 + t * (3.0 - t * (1.0 + 0.7 * t))));
        let slope = |t: f64| 2.0 - t * (1.0 + t * (9.0 - t * (4.0 + 3.5 * t)));
        let at = |t: f64| ([value(t)], [slope(t)]);
        let points = [at(0.0), at(0.4), at(0.8)];
        let dense = Dense::new(0.0, 0.8, [0, 1, 2].map(|k| (&points[k].0[..], &points[k].1[..])));
        for s in [0.0, 0.1, 0.35, 0.5, 0.81, 1.0] {
            let (t, x, rate) = dense.at(s);
            assert!((t - 0.8 * s).abs() < 1e-16 && (x[0] - value(t)).abs() < 1e-14 && (rate[0] - slope(t)).abs() < 1e-13, "{s}");
        }
    }
}
