//! Dense matrices in double-double, row after row: what tree-sparse algebra is compared with.

use featherbench_dynamics::TreeSparse;
use featherbench_spatial::{DoubleDouble, Real};

/// A square matrix.
#[derive(Clone)]
pub struct Dense {
    pub n: usize,
    pub entries: Vec<DoubleDouble>,
}

impl Dense {
    pub fn from_fn(n: usize, entry: impl Fn(usize, usize) -> DoubleDouble) -> Self {
        Self { n, entries: (0..n * n).map(|place| entry(place / n, place % n)).collect() }
    }

    /// A symmetric tree-sparse matrix.
    pub fn of(matrix: &TreeSparse<f64>) -> Self {
        Self::from_fn(matrix.size(), |i, j| matrix.get(i, j).into())
    }

    /// L of the factors, with ones or with what is stored on the diagonal.
    pub fn lower(factors: &TreeSparse<f64>, unit: bool) -> Self {
        Self::from_fn(factors.size(), |i, j| match i.cmp(&j) {
            std::cmp::Ordering::Less => DoubleDouble::zero(),
            std::cmp::Ordering::Equal if unit => DoubleDouble::one(),
            _ => factors.get(i, j).into(),
        })
    }

    pub fn at(&self, i: usize, j: usize) -> DoubleDouble {
        self.entries[i * self.n + j]
    }

    pub fn transposed(&self) -> Self {
        Self::from_fn(self.n, |i, j| self.at(j, i))
    }

    pub fn times(&self, other: &Self) -> Self {
        Self::from_fn(self.n, |i, j| (0..self.n).fold(DoubleDouble::zero(), |sum, k| self.at(i, k).mul_add(other.at(k, j), sum)))
    }

    pub fn mul(&self, x: &[f64]) -> Vec<DoubleDouble> {
        (0..self.n).map(|i| x.iter().enumerate().fold(DoubleDouble::zero(), |sum, (j, &x)| self.at(i, j).mul_add(x.into(), sum))).collect()
    }

    /// The largest difference of two entries, over the roots of the diagonal entries of this one: it has no unit.
    pub fn distance(&self, other: &Self) -> f64 {
        let root: Vec<f64> = (0..self.n).map(|i| self.at(i, i).to_f64().sqrt()).collect();
        let off = |place: usize| {
            let (i, j) = (place / self.n, place % self.n);
            (self.entries[place] - other.entries[place]).to_f64().abs() / (root[i] * root[j])
        };
        (0..self.entries.len()).map(off).fold(0.0, super::larger)
    }

    /// Solves A x = b by elimination from the first row to the last, with no regard to zeros; also the logarithms of the pivots. It takes
    /// another order than what is tested.
    pub fn solve(mut self, b: &[f64]) -> (Vec<DoubleDouble>, Vec<DoubleDouble>) {
        let n = self.n;
        let mut x: Vec<DoubleDouble> = b.iter().map(|&b| b.into()).collect();
        for k in 0..n {
            for i in k + 1..n {
                let factor = self.at(i, k) / self.at(k, k);
                for j in k..n {
                    self.entries[i * n + j] = (-factor).mul_add(self.at(k, j), self.at(i, j));
                }
                x[i] = (-factor).mul_add(x[k], x[i]);
            }
        }
        for k in (0..n).rev() {
            for j in k + 1..n {
                x[k] = (-self.at(k, j)).mul_add(x[j], x[k]);
            }
            x[k] = x[k] / self.at(k, k);
        }
        (x, (0..n).map(|k| self.at(k, k)).collect())
    }
}

/// The largest difference of a number and its double-double, over the largest of these.
pub fn off(found: &[f64], truth: &[DoubleDouble]) -> f64 {
    assert_eq!(found.len(), truth.len());
    let scale = truth.iter().map(|x| x.to_f64().abs()).fold(0.0, super::larger);
    found.iter().zip(truth).map(|(&x, &t)| (DoubleDouble::from_f64(x) - t).to_f64().abs()).fold(0.0, super::larger) / scale
}
