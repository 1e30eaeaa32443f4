//! Orthogonal polynomials of a probability measure, and the Gauss rules that they give.
//!
//! Monic polynomials follow p_{k+1} = (t − a_k) p_k − b_k p_{k−1}. The nodes of the n-point rule are the eigenvalues of the tridiagonal matrix
//! with diagonal a_k and off-diagonal √b_k, and its weights the squared first components of the eigenvectors (Golub & Welsch, 1969). The rule is
//! exact for polynomials up to degree 2n − 1. a₀ is the mean of the measure, b₁ its variance.

use nalgebra::{DMatrix, SymmetricEigen};

/// The recurrence of a measure of mass one.
#[derive(Clone, Debug, PartialEq)]
pub struct Recurrence {
    /// a_k, k = 0, 1, …
    pub centre: Vec<f64>,
    /// b_k, k = 1, 2, …; b₀ = 1 is not stored.
    pub spread: Vec<f64>,
}

/// Nodes and weights; the weights sum to one.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Rising.
    pub nodes: Vec<f64>,
    /// Positive.
    pub weights: Vec<f64>,
}

impl Recurrence {
    fn new(count: usize, centre: impl Fn(f64) -> f64, spread: impl Fn(f64) -> f64) -> Self {
        Self { centre: (0..count).map(|k| centre(k as f64)).collect(), spread: (1..count).map(|k| spread(k as f64)).collect() }
    }

    /// Legendre: constant density on (−1, 1).
    pub fn legendre(count: usize) -> Self {
        Self::new(count, |_| 0.0, |k| k * k / (4.0 * k * k - 1.0))
    }

    /// Hermite: the standard normal density.
    pub fn hermite(count: usize) -> Self {
        Self::new(count, |_| 0.0, |k| k)
    }

    /// Generalised Laguerre: density ∝ t^(shape − 1) e^(−t) on t > 0.
    pub fn laguerre(count: usize, shape: f64) -> Self {
        Self::new(count, |k| 2.0 * k + shape, |k| k * (k + shape - 1.0))
    }

    /// Of a discrete measure, by Stieltjes' procedure. There must be many more points than `count`.
    pub fn of_points(count: usize, points: &Rule) -> Self {
        let total: f64 = points.weights.iter().sum();
        let (mut centre, mut spread) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let (mut before, mut now) = (vec![0.0; points.nodes.len()], vec![1.0; points.nodes.len()]);
        let mut norm = total;
        for k in 0..count {
            let weighted = |f: &dyn Fn(usize) -> f64| -> f64 { points.weights.iter().enumerate().map(|(i, w)| w * f(i)).sum() };
            let a = weighted(&|i| points.nodes[i] * now[i] * now[i]) / norm;
            centre.push(a);
            let b = spread.last().copied().unwrap_or(0.0);
            let next: Vec<f64> = (0..now.len()).map(|i| (points.nodes[i] - a) * now[i] - b * before[i]).collect();
            let above = weighted(&|i| next[i] * next[i]);
            if k + 1 < count {
                spread.push(above / norm);
            }
            (before, now, norm) = (now, next, above);
        }
        Self { centre, spread }
    }

    /// The Gauss rule of so many points, at most as many as there are coefficients.
    pub fn rule(&self, points: usize) -> Rule {
        let points = points.min(self.centre.len());
        let entry = |i: usize, j: usize| match i.abs_diff(j) {
            0 => self.centre[i],
            1 => self.spread[i.min(j)].sqrt(),
            _ => 0.0,
        };
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(DMatrix::from_fn(points, points, entry));
        let mut pairs: Vec<(f64, f64)> = (0..points).map(|k| (eigenvalues[k], eigenvectors[(0, k)].powi(2))).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (nodes, weights) = pairs.into_iter().unzip();
        Rule { nodes, weights }
    }

    /// The orthonormal polynomials up to a degree at a point; there must be more coefficients than the degree.
    pub fn orthonormal(&self, degree: usize, t: f64) -> Vec<f64> {
        let mut values = vec![1.0];
        let mut before = 0.0;
        for k in 0..degree {
            let now = values[k];
            let b = if k == 0 { 0.0 } else { self.spread[k - 1].sqrt() };
            values.push(((t - self.centre[k]) * now - b * before) / self.spread[k].sqrt());
            before = now;
        }
        values
    }
}
