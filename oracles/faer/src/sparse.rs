//! The sparse factorization: matrices as columns of one triangle.

use crate::too_large;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::linalg::cholesky::simplicial::{prefactorize_symbolic_cholesky, prefactorize_symbolic_cholesky_scratch};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, cholesky};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side, Spec};
use featherbench_factors::{Lower, MOST, Tree};
use featherbench_interface::Refusal;

/// An index, as small as the matrices allow.
type Index = u32;

/// An order of elimination.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// That in which M is given.
    Given,
    /// faer's approximate minimum degree.
    MinimumDegree,
}

/// M = L Lᵀ of a sparse matrix.
pub struct Sparse {
    n: usize,
    side: Side,
    /// The columns of the triangle that is kept of M.
    pattern: SymbolicSparseColMat<Index>,
    /// The stored entry of M at each of their numbers.
    from: Vec<usize>,
    symbolic: SymbolicCholesky<Index>,
    entries: usize,
    memory: MemBuffer,
}

impl Sparse {
    /// The symbolic part, once for a tree.
    pub fn new(tree: &Tree, order: Order) -> Result<Self, Refusal> {
        let (n, stored) = (tree.size(), tree.entries());
        let (upper, from) = columns(n, stored.iter().map(|&(row, column)| (column, row)));
        let entries = if order == Order::Given { entries(&upper) } else { 0 };
        if entries > MOST {
            return Err(too_large("the factor", n, entries));
        }
        let ordering = if order == Order::Given { SymmetricOrdering::Identity } else { SymmetricOrdering::Amd };
        let symbolic = factorize_symbolic_cholesky(upper.as_ref(), Side::Upper, ordering, CholeskySymbolicParams::default())?;
        let entries = if order == Order::Given { entries } else { fill_in_of(&upper, ordering)? };
        // Each kind of factorization takes another triangle without transposing it. With an order, M is permuted in any case.
        let lower = symbolic.perm().is_none() && matches!(symbolic.raw(), SymbolicCholeskyRaw::Supernodal(_));
        let (side, (pattern, from)) = if lower { (Side::Lower, columns(n, stored.into_iter())) } else { (Side::Upper, (upper, from)) };
        let factor = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        Ok(Self { n, side, pattern, from, symbolic, entries, memory: MemBuffer::new(factor.or(solve)) })
    }

    /// Numbers of L by the symbolic analysis, without the zeros that pad supernodes.
    pub fn entries(&self) -> usize {
        self.entries
    }

    /// Numbers of L with the zeros that pad supernodes.
    pub fn numbers(&self) -> usize {
        self.symbolic.len_val()
    }

    /// The triangle of M.
    pub fn form(&self, stored: &[f64]) -> Vec<f64> {
        self.from.iter().map(|&at| stored[at]).collect()
    }

    /// The numeric part: L of M, in the order that the symbolic part chose.
    pub fn factorize(&mut self, matrix: &[f64], factors: &mut [f64]) -> Result<(), LltError> {
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), matrix);
        let stack = MemStack::new(&mut self.memory);
        self.symbolic.factorize_numeric_llt(factors, matrix, self.side, Default::default(), Par::Seq, stack, Spec::default()).map(|_| ())
    }

    /// Solves in place.
    pub fn solve(&mut self, factors: &[f64], x: &mut [f64]) {
        let x = MatMut::from_column_major_slice_mut(x, self.n, 1);
        LltRef::new(&self.symbolic, factors).solve_in_place_with_conj(Conj::No, x, Par::Seq, MemStack::new(&mut self.memory));
    }

    /// The numbers of L.
    pub fn lower(&self, factors: &[f64]) -> Lower {
        let places = match self.symbolic.perm() {
            // The dof i has the place inverse[i].
            Some(order) => order.arrays().1.iter().map(|&place| place as usize).collect(),
            None => (0..self.n).collect(),
        };
        let mut columns = vec![Vec::new(); self.n];
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let starts = symbolic.col_ptr();
                for (column, numbers) in columns.iter_mut().enumerate() {
                    let range = starts[column] as usize..starts[column + 1] as usize;
                    numbers.extend(range.map(|at| (symbolic.row_idx()[at] as usize, factors[at])));
                }
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let supernodes = cholesky::supernodal::SupernodalLltRef::new(symbolic, factors);
                for supernode in (0..symbolic.n_supernodes()).map(|s| supernodes.supernode(s)) {
                    let (first, numbers) = (supernode.start(), supernode.val());
                    let below = supernode.pattern().iter().map(|&row| row as usize);
                    let rows: Vec<usize> = (first..first + numbers.ncols()).chain(below).collect();
                    for column in 0..numbers.ncols() {
                        columns[first + column].extend((column..rows.len()).map(|row| (rows[row], numbers[(row, column)])));
                    }
                }
            }
        }
        Lower { places, columns }
    }
}

/// The columns of a triangle with these entries (row, column), and the place of each of its numbers among them.
fn columns(n: usize, entries: impl Iterator<Item = (usize, usize)>) -> (SymbolicSparseColMat<Index>, Vec<usize>) {
    let mut sorted: Vec<(usize, usize, usize)> = entries.enumerate().map(|(at, (row, column))| (column, row, at)).collect();
    sorted.sort_unstable();
    let mut starts: Vec<Index> = vec![0; n + 1];
    sorted.iter().for_each(|(column, ..)| starts[column + 1] += 1);
    for column in 0..n {
        starts[column + 1] += starts[column];
    }
    let rows = sorted.iter().map(|&(_, row, _)| row as Index).collect();
    (SymbolicSparseColMat::new_checked(n, n, starts, None, rows), sorted.into_iter().map(|(.., at)| at).collect())
}

/// The numbers of L in the order in which an upper triangle is given.
fn entries(upper: &SymbolicSparseColMat<Index>) -> usize {
    let n = upper.ncols();
    let (mut tree, mut counts) = (vec![0_i32; n], vec![0; n]);
    let mut memory = MemBuffer::new(prefactorize_symbolic_cholesky_scratch::<Index>(n, upper.row_idx().len()));
    prefactorize_symbolic_cholesky(&mut tree, &mut counts, upper.as_ref(), MemStack::new(&mut memory));
    counts.into_iter().map(|count| count as usize).sum()
}

/// The numbers of L in an order that faer chooses.
fn fill_in_of(upper: &SymbolicSparseColMat<Index>, ordering: SymmetricOrdering<'_, Index>) -> Result<usize, Refusal> {
    let single = CholeskySymbolicParams { supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL, ..Default::default() };
    Ok(factorize_symbolic_cholesky(upper.as_ref(), Side::Upper, ordering, single)?.len_val())
}
