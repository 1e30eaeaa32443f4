//! Polynomials of several variables in the basis of Chebyshev, each variable scaled to [−1, 1].
//!
//! The basis is all products ∏ T_{e_j}(x_j) of total degree Σ e_j ≤ d. On the range they are bounded by one, which keeps the equations of a
//! fit well conditioned; powers do not.

use crate::{ResidualError, Sample};

/// The range of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The least value.
    pub low: f64,
    /// The greatest value.
    pub high: f64,
}

impl Range {
    /// The range of one component of samples.
    ///
    /// # Errors
    /// [`ResidualError::Learning`] without samples that differ, or if one is not finite.
    pub fn of(samples: &[Sample], component: impl Fn(&Sample) -> f64) -> Result<Self, ResidualError> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for x in samples.iter().map(component) {
            if !x.is_finite() {
                return Err(ResidualError::Learning("a number of the samples is not finite".into()));
            }
            (low, high) = (low.min(x), high.max(x));
        }
        if low < high { Ok(Self { low, high }) } else { Err(ResidualError::Learning("a variable of the samples does not vary".into())) }
    }

    /// x scaled to [−1, 1], and the factor of derivatives.
    fn scaled(self, x: f64) -> [f64; 2] {
        let factor = 2.0 / (self.high - self.low);
        [(x - self.low) * factor - 1.0, factor]
    }
}

/// A basis of polynomials.
#[derive(Clone, Debug, PartialEq)]
pub struct Chebyshev {
    ranges: Vec<Range>,
    degree: usize,
    /// The exponents of each product. The first is the constant.
    exponents: Vec<Vec<usize>>,
}

impl Chebyshev {
    /// All products of total degree at most `degree` in variables of these ranges.
    pub fn new(ranges: Vec<Range>, degree: usize) -> Self {
        let mut exponents = vec![Vec::new()];
        for _ in &ranges {
            let longer = |shorter: &Vec<usize>| {
                let shorter = shorter.clone();
                let used: usize = shorter.iter().sum();
                (0..=degree - used).map(move |e| [shorter.as_slice(), &[e]].concat())
            };
            exponents = exponents.iter().flat_map(longer).collect();
        }
        exponents.sort_by_key(|exponents: &Vec<usize>| exponents.iter().sum::<usize>());
        Self { ranges, degree, exponents }
    }

    /// The number of products.
    pub fn len(&self) -> usize {
        self.exponents.len()
    }

    /// Whether there are none; there is at least the constant.
    pub fn is_empty(&self) -> bool {
        self.exponents.is_empty()
    }

    /// T_e and T_e′ of each variable, e = 0…d, variable after variable. T_{e+1} = 2x T_e − T_{e−1}.
    fn single(&self, x: &[f64]) -> Vec<[f64; 2]> {
        let mut all = Vec::with_capacity(self.ranges.len() * (self.degree + 1));
        for (range, &x) in self.ranges.iter().zip(x) {
            let [x, factor] = range.scaled(x);
            let (mut before, mut now) = ([1.0, 0.0], [x, 1.0]);
            for _ in 0..=self.degree {
                all.push([before[0], before[1] * factor]);
                (before, now) = (now, [2.0 * x * now[0] - before[0], 2.0 * now[0] + 2.0 * x * now[1] - before[1]]);
            }
        }
        all
    }

    /// The values of all products at x, one number per variable.
    pub fn values(&self, x: &[f64]) -> Vec<f64> {
        let single = self.single(x);
        let rows = || single.chunks_exact(self.degree + 1);
        self.exponents.iter().map(|exponents| exponents.iter().zip(rows()).map(|(&e, row)| row[e][0]).product()).collect()
    }

    /// The values of all products at x, and their derivatives by each variable.
    pub fn gradients(&self, x: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let single = self.single(x);
        let product = |exponents: &[usize], by: Option<usize>| -> f64 {
            let factor = |(k, (&e, row)): (usize, (&usize, &[[f64; 2]]))| row[e][usize::from(by == Some(k))];
            exponents.iter().zip(single.chunks_exact(self.degree + 1)).enumerate().map(factor).product()
        };
        let all = |by: Option<usize>| self.exponents.iter().map(|exponents| product(exponents, by)).collect::<Vec<f64>>();
        (all(None), (0..x.len()).map(|k| all(Some(k))).collect())
    }
}
