//! nalgebra's dense Cholesky factorization as an oracle: a library with the C interface of `../../native/oracle.h`.

use featherbench_factors::{Factorization, Lower, MOST, Robot, Tree};
use featherbench_interface::Refusal;
use nalgebra::{Cholesky, DMatrix, DVectorViewMut, Dyn};

/// M = L Lᵀ by [`Cholesky`], of a dense matrix.
struct Dense {
    n: usize,
    /// Where each stored entry of M is in both triangles, column after column.
    at: Vec<[usize; 2]>,
}

impl Factorization for Dense {
    const ENGINE: &'static str = "nalgebra";
    const METHODS: &'static [(&'static str, &'static str)] = &[("factorization", "dense"), ("solve", "dense"), ("factor_entries", "dense")];
    const REVERSED: &'static [&'static str] = &[];
    type Factors = Option<Cholesky<f64, Dyn>>;

    fn new(_: &str, tree: &Tree) -> Result<Self, Refusal> {
        let n = tree.size();
        if 2 * n * n > MOST {
            let reason =
                format!("a dense matrix of {n} degrees of freedom and its factor have {} numbers, and {MOST} are kept here", 2 * n * n);
            return Err(Refusal::Unsupported(reason));
        }
        let at = tree.entries().into_iter().map(|(row, column)| [column * n + row, row * n + column]).collect();
        Ok(Self { n, at })
    }

    fn entries(&self) -> usize {
        self.n * (self.n + 1) / 2
    }

    fn numbers(&self) -> usize {
        self.n * self.n
    }

    fn form(&self, stored: &[f64]) -> Vec<f64> {
        let mut matrix = vec![0.0; self.n * self.n];
        self.at.iter().zip(stored).for_each(|(at, &number)| at.iter().for_each(|&at| matrix[at] = number));
        matrix
    }

    fn room(&self) -> Self::Factors {
        Some(Cholesky::pack_dirty(DMatrix::zeros(self.n, self.n)))
    }

    fn factorize(&mut self, matrix: &[f64], factors: &mut Self::Factors) -> Result<(), Refusal> {
        // The memory of the factors before. A matrix that is not positive definite leaves none.
        let mut room = factors.take().map_or_else(|| DMatrix::zeros(self.n, self.n), Cholesky::unpack_dirty);
        room.as_mut_slice().copy_from_slice(matrix);
        *factors = Cholesky::new(room);
        if factors.is_some() { Ok(()) } else { Err(Refusal::Failed("nalgebra: M is not positive definite".into())) }
    }

    fn solve(&mut self, factors: &Self::Factors, x: &mut [f64]) {
        if let Some(factors) = factors {
            factors.solve_mut(&mut DVectorViewMut::from_slice(x, self.n));
        }
    }

    fn lower(&self, factors: &Self::Factors) -> Lower {
        let column = |k: usize| {
            let lower = factors.as_ref().map(Cholesky::l_dirty);
            lower.map_or_else(Vec::new, |lower| (k..self.n).map(|row| (row, lower[(row, k)])).collect())
        };
        Lower { places: (0..self.n).collect(), columns: (0..self.n).map(column).collect() }
    }
}

featherbench_interface::export!(Robot<Dense>);
