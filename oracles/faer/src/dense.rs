//! The dense factorization: lower triangles of matrices column after column.

use crate::too_large;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::cholesky::llt::solve::{solve_in_place, solve_in_place_scratch};
use faer::{MatMut, MatRef, Par, Spec};
use featherbench_factors::{Lower, MOST, Tree};
use featherbench_interface::Refusal;

/// M = L Lᵀ of a dense matrix.
pub struct Dense {
    n: usize,
    /// Where each stored entry of M is.
    at: Vec<usize>,
    memory: MemBuffer,
}

impl Dense {
    /// Prepares the matrices of a tree.
    pub fn new(tree: &Tree) -> Result<Self, Refusal> {
        let n = tree.size();
        if 2 * n * n > MOST {
            return Err(too_large("a dense matrix and its factor", n, 2 * n * n));
        }
        let at = tree.entries().into_iter().map(|(row, column)| column * n + row).collect();
        let factor = cholesky_in_place_scratch::<f64>(n, Par::Seq, Spec::default());
        let solve = solve_in_place_scratch::<f64>(n, 1, Par::Seq);
        Ok(Self { n, at, memory: MemBuffer::new(factor.or(solve)) })
    }

    /// The triangle.
    pub fn entries(&self) -> usize {
        self.n * (self.n + 1) / 2
    }

    /// The square.
    pub fn numbers(&self) -> usize {
        self.n * self.n
    }

    /// The lower triangle of M.
    pub fn form(&self, stored: &[f64]) -> Vec<f64> {
        let mut matrix = vec![0.0; self.numbers()];
        self.at.iter().zip(stored).for_each(|(&at, &number)| matrix[at] = number);
        matrix
    }

    /// Copies the lower triangle of M, and factorizes it in place.
    pub fn factorize(&mut self, matrix: &[f64], factors: &mut [f64]) -> Result<(), LltError> {
        let n = self.n;
        let mut room = MatMut::from_column_major_slice_mut(factors, n, n);
        room.copy_from_triangular_lower(MatRef::from_column_major_slice(matrix, n, n));
        cholesky_in_place(room, Default::default(), Par::Seq, MemStack::new(&mut self.memory), Spec::default()).map(|_| ())
    }

    /// Solves in place.
    pub fn solve(&mut self, factors: &[f64], x: &mut [f64]) {
        let n = self.n;
        let lower = MatRef::from_column_major_slice(factors, n, n);
        solve_in_place(lower, MatMut::from_column_major_slice_mut(x, n, 1), Par::Seq, MemStack::new(&mut self.memory));
    }

    /// The numbers of L.
    pub fn lower(&self, factors: &[f64]) -> Lower {
        let column = |k: usize| (k..self.n).map(|row| (row, factors[k * self.n + row])).collect();
        Lower { places: (0..self.n).collect(), columns: (0..self.n).map(column).collect() }
    }
}
