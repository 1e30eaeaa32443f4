//! Moments of samples: blocks by themselves, merged in their order.
//!
//! A block is reduced about its own mean. Two sets are merged by the formulas of P. Pébay, *Sandia report SAND2008-6212*, 2008. Nothing depends on
//! which thread reduced a block.

use crate::Estimate;

/// Count, mean and central sums Σ(y − ȳ)ᵏ of one output.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Moments {
    /// How many samples.
    pub count: f64,
    /// ȳ.
    pub mean: f64,
    /// Σ (y − ȳ)ᵏ, k = 2, 3, 4.
    pub sums: [f64; 3],
}

/// Partial sums run in so many lanes, in a fixed order.
const LANES: usize = 8;

/// Σ f(y), by lanes, then lane by lane.
pub(crate) fn sum_of<const N: usize>(values: &[f64], f: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let mut lanes = [[0.0; LANES]; N];
    let (full, rest) = values.as_chunks::<LANES>();
    for chunk in full {
        for (k, y) in chunk.iter().enumerate() {
            f(*y).into_iter().zip(&mut lanes).for_each(|(part, sums)| sums[k] += part);
        }
    }
    for (k, y) in rest.iter().enumerate() {
        f(*y).into_iter().zip(&mut lanes).for_each(|(part, sums)| sums[k] += part);
    }
    lanes.map(|sums| sums.iter().sum())
}

/// Σ (a − ā)(b − b̄).
pub(crate) fn product_sum(a: &[f64], mean_a: f64, b: &[f64], mean_b: f64) -> f64 {
    let mut lanes = [0.0; LANES];
    for (a, b) in a.chunks(LANES).zip(b.chunks(LANES)) {
        for (sum, (a, b)) in lanes.iter_mut().zip(a.iter().zip(b)) {
            *sum += (a - mean_a) * (b - mean_b);
        }
    }
    lanes.iter().sum()
}

impl Moments {
    /// The moments of a block.
    pub fn of(values: &[f64]) -> Self {
        if values.is_empty() {
            return Self::default();
        }
        let count = values.len() as f64;
        let [sum] = sum_of(values, |y| [y]);
        let mean = sum / count;
        let sums = sum_of(values, |y| {
            let (d, square) = (y - mean, (y - mean) * (y - mean));
            [square, square * d, square * square]
        });
        Self { count, mean, sums }
    }

    /// The moments of both sets of samples.
    #[must_use]
    pub fn merged(self, other: Self) -> Self {
        if self.count == 0.0 {
            return other;
        }
        if other.count == 0.0 {
            return self;
        }
        let (a, b) = (self.count, other.count);
        let n = a + b;
        let d = other.mean - self.mean;
        let ([a2, a3, a4], [b2, b3, b4]) = (self.sums, other.sums);
        let second = a2 + b2 + d * d * a * b / n;
        let third = a3 + b3 + d.powi(3) * a * b * (a - b) / (n * n) + 3.0 * d * (a * b2 - b * a2) / n;
        let fourth = a4
            + b4
            + d.powi(4) * a * b * (a * a - a * b + b * b) / n.powi(3)
            + 6.0 * d * d * (a * a * b2 + b * b * a2) / (n * n)
            + 4.0 * d * (a * b3 - b * a3) / n;
        Self { count: n, mean: self.mean + d * (b / n), sums: [second, third, fourth] }
    }

    /// The variance, unbiased of independent samples.
    pub fn variance(&self) -> f64 {
        self.sums[0] / (self.count - 1.0)
    }

    /// The standard error of the mean, of independent samples.
    pub fn mean_error(&self) -> f64 {
        (self.variance() / self.count).sqrt()
    }

    /// The standard error of the variance, of independent samples: `(μ₄ − σ⁴ (n − 3)/(n − 1)) / n` is its square.
    pub fn variance_error(&self) -> f64 {
        let (n, square) = (self.count, self.variance());
        ((self.sums[2] / n - square * square * (n - 3.0) / (n - 1.0)).max(0.0) / n).sqrt()
    }

    /// The mean of independent samples.
    pub fn mean_estimate(&self) -> Estimate {
        Estimate { value: self.mean, error: self.mean_error(), freedom: self.count - 1.0 }
    }

    /// The variance of independent samples.
    pub fn variance_estimate(&self) -> Estimate {
        Estimate { value: self.variance(), error: self.variance_error(), freedom: self.count - 1.0 }
    }

    /// μ₃/σ³.
    pub fn skewness(&self) -> f64 {
        self.sums[1] / self.count / (self.sums[0] / self.count).powf(1.5)
    }

    /// μ₄/σ⁴ − 3.
    pub fn excess(&self) -> f64 {
        self.count * self.sums[2] / (self.sums[0] * self.sums[0]) - 3.0
    }
}
