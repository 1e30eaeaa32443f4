//! Dense linear algebra in multi-precision: L D Lᵀ of positive definite matrices, and Gaussian elimination with partial pivoting of others.
//!
//! Source: Golub & Van Loan, *Matrix Computations* (2013), §4.1 and §3.4. Cost: n³/6 and n³/3 multiplications; entries that are exactly
//! zero cost nothing.

use crate::{Error, Mp};

/// A square matrix, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    n: usize,
    entries: Vec<Mp>,
}

impl Matrix {
    /// The zero matrix of order `n`.
    pub fn zero(n: usize) -> Self {
        Self { n, entries: vec![Mp::zero(); n * n] }
    }

    /// The number of rows.
    pub fn order(&self) -> usize {
        self.n
    }

    /// The entry of row `i` and column `j`.
    pub fn get(&self, i: usize, j: usize) -> &Mp {
        &self.entries[i * self.n + j]
    }

    /// Writes an entry.
    pub fn set(&mut self, i: usize, j: usize, value: Mp) {
        self.entries[i * self.n + j] = value;
    }

    /// Row `i`.
    pub fn row(&self, i: usize) -> &[Mp] {
        &self.entries[i * self.n..(i + 1) * self.n]
    }

    /// All entries, row after row.
    pub fn entries(&self) -> &[Mp] {
        &self.entries
    }

    /// The matrix times a vector of its order; further numbers of the vector are ignored.
    pub fn apply(&self, x: &[Mp]) -> Vec<Mp> {
        (0..self.n).map(|i| dot(self.row(i), x)).collect()
    }

    /// Solves A x = b by Gaussian elimination with partial pivoting.
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::Singular`] when no pivot is left in a column.
    pub fn solve(mut self, b: &[Mp]) -> Result<Vec<Mp>, Error> {
        let n = self.n;
        if b.len() != n {
            return Err(Error::Length { array: "right-hand side", found: b.len(), expected: n });
        }
        let mut x = b.to_vec();
        for column in 0..n {
            let size = |row: usize| self.get(row, column).abs();
            let pivot = (column + 1..n).fold(column, |best, row| if size(row) > size(best) { row } else { best });
            if self.get(pivot, column).is_zero() {
                return Err(Error::Singular { row: column });
            }
            if pivot != column {
                (0..n).for_each(|j| self.entries.swap(pivot * n + j, column * n + j));
                x.swap(pivot, column);
            }
            for row in column + 1..n {
                if self.get(row, column).is_zero() {
                    continue;
                }
                let factor = self.get(row, column) / self.get(column, column);
                for j in column + 1..n {
                    if !self.get(column, j).is_zero() {
                        let reduced = self.get(row, j) - &factor * self.get(column, j);
                        self.set(row, j, reduced);
                    }
                }
                x[row] = &x[row] - &factor * &x[column];
            }
        }
        for row in (0..n).rev() {
            let known = dot(&self.row(row)[row + 1..], &x[row + 1..]);
            x[row] = (&x[row] - known) / self.get(row, row);
        }
        Ok(x)
    }
}

/// A = L D Lᵀ with unit lower triangular L and positive diagonal D.
#[derive(Clone, Debug)]
pub struct Factors {
    lower: Matrix,
    pivots: Vec<Mp>,
}

impl Factors {
    /// Factors a symmetric matrix; only its lower triangle is used.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`] at the first pivot that is not positive.
    pub fn new(matrix: &Matrix) -> Result<Self, Error> {
        let n = matrix.order();
        let (mut lower, mut pivots) = (Matrix::zero(n), Vec::with_capacity(n));
        for i in 0..n {
            // u_j = L_ij d_j, from A_ij = Σ_k<j u_k L_jk + u_j
            let mut scaled: Vec<Mp> = Vec::with_capacity(i);
            for j in 0..i {
                let u = matrix.get(i, j) - dot(&scaled, lower.row(j));
                scaled.push(u);
            }
            let mut pivot = matrix.get(i, i).clone();
            for j in 0..i {
                let entry = &scaled[j] / &pivots[j];
                pivot = pivot - &scaled[j] * &entry;
                lower.set(i, j, entry);
            }
            if pivot.is_zero() || pivot.is_negative() {
                return Err(Error::NotPositiveDefinite { dof: i });
            }
            pivots.push(pivot);
        }
        Ok(Self { lower, pivots })
    }

    /// The diagonal D.
    pub fn pivots(&self) -> &[Mp] {
        &self.pivots
    }

    /// Solves A x = b (of the matrix' order).
    pub fn solve(&self, b: &[Mp]) -> Vec<Mp> {
        let n = self.pivots.len();
        let mut x: Vec<Mp> = Vec::with_capacity(n);
        for (i, b) in b.iter().enumerate().take(n) {
            let y = b - dot(&self.lower.row(i)[..i], &x);
            x.push(y);
        }
        for (x, pivot) in x.iter_mut().zip(&self.pivots) {
            *x = &*x / pivot;
        }
        for i in (0..n).rev() {
            for j in 0..i {
                if !self.lower.get(i, j).is_zero() {
                    x[j] = &x[j] - self.lower.get(i, j) * &x[i];
                }
            }
        }
        x
    }
}

/// Σ a_i b_i over the shorter length.
fn dot(a: &[Mp], b: &[Mp]) -> Mp {
    a.iter().zip(b).filter(|(a, b)| !a.is_zero() && !b.is_zero()).map(|(a, b)| a * b).sum()
}
