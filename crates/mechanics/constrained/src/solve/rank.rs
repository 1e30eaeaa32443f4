//! A rank-revealing orthogonal factorization: the rows of a constraint that are independent, found by their lengths and not by luck.
//!
//! Computes `Y P = Q R` for an n×m matrix Y: the column with the longest rest comes next, its direction is a column of Q, and the others
//! lose their part along it. It ends where the longest rest is at most `tolerance` times the first. Each new direction is made orthogonal
//! to the others a second time, so Q is orthogonal to rounding also where the rest is short.
//!
//! Source: Golub and Van Loan, *Matrix Computations* (4th edition), sections 5.2.8 (modified Gram–Schmidt) and 5.4.2 (column pivoting);
//! Giraud, Langou and Rozložník (2005) for "twice is enough". Cost: 2 n m r multiply-adds, r the rank. It allocates.

use nalgebra::{DMatrix, DVector};

/// The factors of a matrix, cut at its rank.
#[derive(Clone, Debug)]
pub(crate) struct Revealed {
    /// An orthonormal basis of the columns: n×rank.
    q: DMatrix<f64>,
    /// The coordinates of all columns in it, in the order of the pivots: rank×m.
    r: DMatrix<f64>,
    /// The columns, independent ones first.
    order: Vec<usize>,
}

impl Revealed {
    /// The factors of Y. A rest of at most `tolerance` times the longest column counts as none.
    pub(crate) fn of(mut y: DMatrix<f64>, tolerance: f64) -> Self {
        let (n, m) = y.shape();
        let mut order: Vec<usize> = (0..m).collect();
        let mut q: DMatrix<f64> = DMatrix::zeros(n, n.min(m));
        let mut r = DMatrix::zeros(n.min(m), m);
        let (mut rank, mut first) = (0, 0.0);
        while rank < n.min(m) {
            let Some((longest, norm)) = (rank..m).map(|k| (k, y.column(k).norm())).max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
            if rank == 0 {
                first = norm;
            }
            if norm <= tolerance * first {
                break;
            }
            y.swap_columns(rank, longest);
            r.swap_columns(rank, longest);
            order.swap(rank, longest);
            let mut direction: DVector<f64> = y.column(rank).into_owned();
            for k in 0..rank {
                let part = q.column(k).dot(&direction);
                r[(k, rank)] += part;
                direction.axpy(-part, &q.column(k), 1.0);
            }
            let length = direction.norm();
            direction /= length;
            r[(rank, rank)] = length;
            for k in rank + 1..m {
                let part = direction.dot(&y.column(k));
                r[(rank, k)] = part;
                y.column_mut(k).axpy(-part, &direction, 1.0);
            }
            q.set_column(rank, &direction);
            rank += 1;
        }
        Self { q: q.columns(0, rank).into_owned(), r: r.rows(0, rank).into_owned(), order }
    }

    pub(crate) fn rank(&self) -> usize {
        self.r.nrows()
    }

    /// The shortest z with `Yᵀ z = c` on the independent columns: `z = Q R⁻ᵀ c`. On the others it holds if c is compatible.
    pub(crate) fn shortest(&self, c: &[f64]) -> DVector<f64> {
        let mut w = DVector::zeros(self.rank());
        for k in 0..self.rank() {
            let known = (0..k).fold(c[self.order[k]], |sum, j| sum - self.r[(j, k)] * w[j]);
            w[k] = known / self.r[(k, k)];
        }
        &self.q * w
    }

    /// The λ with `Y λ = z` for a z in the span of the columns. Of dependent columns it is zero.
    pub(crate) fn multipliers(&self, z: &DVector<f64>) -> Vec<f64> {
        let w = self.q.tr_mul(z);
        let mut lambda = vec![0.0; self.order.len()];
        for k in (0..self.rank()).rev() {
            let known = (k + 1..self.rank()).fold(w[k], |sum, j| sum - self.r[(k, j)] * lambda[self.order[j]]);
            lambda[self.order[k]] = known / self.r[(k, k)];
        }
        lambda
    }
}
