//! Problem 4: one shape for a continuum. All shapes and weights here are polynomials, so that integrals are exact sums.
//!
//! E(q) = ∫ρ (x⋆ − Φ q)² ds. Gradient: −2∫ρ (x⋆ − Φ q) Φ ds. Smallest at q* = ∫ρ x⋆ Φ / ∫ρ Φ².
//! First route: Gauss and Legendre's rule. Second: the antiderivative of the product's coefficients.

use crate::claim::{Claim, Failure, Holds, Number};
use crate::quadrature::Rule;

/// Coefficients, lowest first.
type Polynomial = Vec<f64>;

fn times(a: &[f64], b: &[f64]) -> Polynomial {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

fn at(p: &[f64], s: f64) -> f64 {
    p.iter().rev().fold(0.0, |value, coefficient| value * s + coefficient)
}

/// ∫ from 0 to L of the product of all.
fn exact(length: f64, factors: &[&[f64]]) -> f64 {
    let product = factors.iter().fold(vec![1.0], |product, factor| times(&product, factor));
    product.iter().enumerate().map(|(k, c)| c * length.powi(k as i32 + 1) / (k + 1) as f64).sum()
}

fn by_rule(length: f64, factors: &[&[f64]]) -> f64 {
    Rule::gauss(8).integral(0.0, length, |s| factors.iter().map(|factor| at(factor, s)).product())
}

/// A continuum, its exact shape and the one that stands for it.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) length: f64,
    pub(crate) truth: Polynomial,
    pub(crate) mode: Polynomial,
    pub(crate) density: Polynomial,
}

impl Default for Shape {
    /// x⋆ = (3s² − s³)/2, a cantilever with a force at its end, by Φ = s², on L = 1, with ρ = 1 + 3s.
    fn default() -> Self {
        Self { length: 1.0, truth: vec![0.0, 0.0, 1.5, -0.5], mode: vec![0.0, 0.0, 1.0], density: vec![1.0, 3.0] }
    }
}

type Integral = fn(f64, &[&[f64]]) -> f64;

impl Shape {
    /// x⋆ − Φ q.
    fn error(&self, q: f64) -> Polynomial {
        let count = self.truth.len().max(self.mode.len());
        let of = |p: &[f64], k: usize| p.get(k).copied().unwrap_or(0.0);
        (0..count).map(|k| of(&self.truth, k) - q * of(&self.mode, k)).collect()
    }

    fn best(&self, integral: Integral, weight: &[f64]) -> f64 {
        integral(self.length, &[weight, &self.truth, &self.mode]) / integral(self.length, &[weight, &self.mode, &self.mode])
    }

    fn squared(&self, integral: Integral, q: f64) -> f64 {
        let e = self.error(q);
        integral(self.length, &[&e, &e])
    }

    fn gradient(&self, integral: Integral, q: f64) -> f64 {
        -2.0 * integral(self.length, &[&self.error(q), &self.mode])
    }

    /// Pairs by both routes.
    fn pair(&self, of: impl Fn(Integral) -> f64) -> [f64; 2] {
        [of(by_rule), of(exact)]
    }

    pub(crate) fn projection(&self) -> Vec<Number> {
        let one: &[f64] = &[1.0];
        let [best, best_second] = self.pair(|integral| self.best(integral, one));
        let named = |name: &str, [found, second]: [f64; 2], stated: f64| Number::new(name, "1", found, second).stated(stated, 0.0);
        // What the lesson's formulas give: those of the second route, with the difference of E for its gradient.
        let step = 0.5;
        let slope = (self.squared(exact, 1.0 + step) - self.squared(exact, 1.0 - step)) / (2.0 * step);
        let least = self.pair(|integral| self.squared(integral, best_second));
        vec![
            named("q*", [best, best_second], best_second),
            named("E(q*)", least, self.squared(exact, best)),
            named("E(1)", self.pair(|integral| self.squared(integral, 1.0)), self.squared(exact, 1.0)),
            // E is quadratic: its central difference is its derivative.
            Number::new("dE/dq at q = 1", "1", slope, self.gradient(by_rule, 1.0)).stated(self.gradient(exact, 1.0), 0.0),
        ]
    }

    pub(crate) fn mean(&self) -> Vec<Number> {
        let [found, second] = self.pair(|integral| self.squared(integral, 1.0));
        let name = format!("mean-square error at q = 1, L = {}", self.length);
        vec![Number::new(name, "1", found / self.length, second / self.length).stated(found, second * (1.0 - 1.0 / self.length))]
    }

    pub(crate) fn weight(&self) -> Vec<Number> {
        let one: &[f64] = &[1.0];
        let [found, second] = self.pair(|integral| self.best(integral, &self.density));
        let (unweighted, unweighted_second) = (self.best(by_rule, one), self.best(exact, one));
        vec![Number::new("q* of the dynamics", "1", found, second).stated(unweighted, unweighted_second - second)]
    }
}

/// The gradient and the condition.
pub(super) const PROJECTION: Claim = Claim {
    id: "mode_projection",
    place: "Problem 4",
    title: "Projection on one shape",
    says: "dE/dq = −2∫eᵀΦ ds, and at the smallest E the error is orthogonal to Φ.",
    right: "So it is. For (3s² − s³)/2 by s²: q* = 13/12, E = 1/1008; E(1) = 1/420, E′(1) = −1/30.",
    holds: Holds::Yes,
    numbers: |_| Ok::<_, Failure>(Shape::default().projection()),
};

/// The factor 1/L.
pub(super) const MEAN: Claim = Claim {
    id: "mode_mean",
    place: "Problem 4",
    title: "The mean-square error",
    says: "The mean-square error over the body is ∫‖e‖² ds.",
    right: "A mean has the factor 1/L. On L = 1, where nobody sees it, both are the same.",
    holds: Holds::InPart,
    numbers: |_| Ok([1.0, 2.0].into_iter().flat_map(|length| Shape { length, ..Shape::default() }.mean()).collect()),
};

/// The weight of the dynamics.
pub(super) const WEIGHT: Claim = Claim {
    id: "mode_weight",
    place: "Problem 4",
    title: "The condition of Galerkin's type",
    says: "The smallest E leads to a condition of Galerkin's type.",
    right: "Galerkin's condition for the dynamics has the weight ρ(s). Without it q* is another where ρ is not constant.",
    holds: Holds::InPart,
    numbers: |_| {
        let constant = Shape { density: vec![2.0], ..Shape::default() }.weight();
        let named = |numbers: Vec<Number>, density: &'static str| {
            numbers.into_iter().map(move |number| Number { name: format!("{}, {density}", number.name), ..number })
        };
        Ok(named(constant, "ρ constant").chain(named(Shape::default().weight(), "ρ = 1 + 3s")).collect())
    },
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fractions_are_those_of_the_exact_integrals() {
        let values: Vec<f64> = Shape::default().projection().iter().map(|number| number.corrected).collect();
        for (value, known) in values.iter().zip([13.0 / 12.0, 1.0 / 1008.0, 1.0 / 420.0, -1.0 / 30.0]) {
            assert!((value - known).abs() < 1e-14, "{value} {known}");
        }
    }

    #[test]
    fn drawn_shapes_agree() {
        let mut random = featherbench_robots::Random::new(3, 0);
        for _ in 0..20 {
            let mut drawn = |count: usize, low: f64| (0..count).map(|_| random.uniform(low, 1.0)).collect::<Vec<f64>>();
            let shape = Shape { truth: drawn(5, -1.0), mode: drawn(3, 0.2), density: drawn(2, 0.1), length: 1.7 };
            for number in [shape.projection(), shape.mean(), shape.weight()].concat() {
                assert!(number.error() < 1e-11, "{number:?}");
                assert!(number.separation_error().is_none_or(|error| error < 1e-11), "{number:?}");
            }
        }
    }
}
