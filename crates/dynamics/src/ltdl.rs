//! The factorization `M = LᵀDL` of a tree-sparse matrix without fill-in, and solutions of `M x = b`.
//!
//! Source: the book, section 6.5: eliminating from the leaves to the root keeps every zero of M. L is unit lower triangular and D diagonal;
//! they overwrite M. Shapes: M is `nv`×`nv`, x and b have `nv` numbers. Units: those of M and b. A call does not allocate.
//! Cost, with d_k the depth of dof k, D1 = Σ (d_k − 1) and D2 = Σ d_k (d_k − 1) / 2:
//!
//! | | divisions | multiply-subtracts | order |
//! |---|---|---|---|
//! | factor | D1 | D2 | O(Σ d_k²) |
//! | solve | n | 2·D1 | O(Σ d_k) |
//!
//! Dofs are eliminated in *blocks*: up to four consecutive dofs, each the parent of the next. They share the ancestors of the first, and
//! change an ancestor's row in one pass over it. The operations on each number keep the book's order.

use crate::error::{Pivot, expect};
use crate::tree_sparse::BLOCK;
use crate::{DimensionError, Error, NotPositiveDefinite, TreeSparse};
use featherbench_model::Topology;
use featherbench_spatial::Real;

// The arms of `by_block`.
const _: () = assert!(BLOCK == 4);

/// Calls a method with the size of the block, 1 … [`BLOCK`], as a constant.
macro_rules! by_block {
    ($size:expr, $self:ident.$method:ident($($argument:expr),+)) => {
        match $size {
            1 => $self.$method::<1>($($argument),+),
            2 => $self.$method::<2>($($argument),+),
            3 => $self.$method::<3>($($argument),+),
            _ => $self.$method::<BLOCK>($($argument),+),
        }
    };
}

/// The factors of a tree-sparse matrix. Before the first factorization they are all zero, and not valid.
#[derive(Clone, Debug)]
pub struct Ltdl<T> {
    matrix: TreeSparse<T>,
}

impl<T: Real> Ltdl<T> {
    /// A workspace for the factors of a matrix of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self::from_unfactored(TreeSparse::new(topology))
    }

    /// Factors a matrix, leaving it as it is.
    ///
    /// # Errors
    /// [`Error`] when the matrix has another topology or a pivot is not positive.
    pub fn run(&mut self, matrix: &TreeSparse<T>) -> Result<(), Error> {
        self.matrix.copy_from(matrix)?;
        self.factor()?;
        Ok(())
    }

    /// Before [`Ltdl::factor`]: the matrix, to be written where it will be factored. Afterwards its factors: L below the diagonal, D on it.
    pub fn matrix_mut(&mut self) -> &mut TreeSparse<T> {
        &mut self.matrix
    }

    /// The factors: L below the diagonal, D on it.
    pub fn factors(&self) -> &TreeSparse<T> {
        &self.matrix
    }

    /// Factors what [`Ltdl::matrix_mut`] holds, in place.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] when a pivot is not positive.
    pub fn factor(&mut self) -> Result<(), NotPositiveDefinite> {
        self.eliminate().check()
    }

    /// Solves `M x = b` in place: `x` holds b before and the solution afterwards.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    pub fn solve(&self, x: &mut [T]) -> Result<(), DimensionError> {
        let n = self.matrix.size();
        expect("right-hand side x", n, x.len())?;

        // Lᵀ y = b, from the leaves
        let mut end = n;
        while end > 0 {
            let size = self.matrix.block_before(end);
            end -= size;
            by_block!(size, self.subtract_from_ancestors(end, x));
        }
        // D z = y
        for (x, d) in x.iter_mut().zip(self.matrix.diagonal()) {
            *x = *x / d;
        }
        // L x = z, from the root
        let mut first = 0;
        while first < n {
            let size = self.matrix.block_from(first);
            by_block!(size, self.subtract_ancestors(first, x));
            first += size;
        }
        Ok(())
    }

    pub(crate) fn from_unfactored(matrix: TreeSparse<T>) -> Self {
        Self { matrix }
    }

    /// The factorization itself. Its result is valid only if the smallest pivot is positive.
    fn eliminate(&mut self) -> Pivot {
        let mut smallest = Pivot::none();
        let mut end = self.matrix.size();
        while end > 0 {
            let size = self.matrix.block_before(end);
            end -= size;
            by_block!(size, self.eliminate_block(end, &mut smallest));
        }
        smallest
    }

    /// `L_ki = H_ki / D_k,  H_i· −= L_ki H_k·` for every dof k of a block, the last first, and every strict ancestor i of k.
    #[inline(always)]
    fn eliminate_block<const SIZE: usize>(&mut self, first: usize, smallest: &mut Pivot) {
        let shared = self.matrix.depth(first) - 1;
        let (places, values) = self.matrix.parts_mut();
        let (above, rows) = values.split_at_mut(places[first].start);
        let mut rows = split_rows::<T, SIZE>(rows, shared);

        // ancestors in the block
        let mut d = [T::zero(); SIZE];
        for k in (0..SIZE).rev() {
            let (before, rest) = rows.split_at_mut(k);
            let h_k = &mut *rest[0];
            d[k] = h_k[shared + k];
            smallest.note(first + k, d[k].min_lane());
            for (i, h_i) in before.iter_mut().enumerate().rev() {
                let l = h_k[shared + i] / d[k];
                for (h_i, h_k) in h_i.iter_mut().zip(h_k.iter()) {
                    *h_i = (-l).mul_add(*h_k, *h_i);
                }
                h_k[shared + i] = l;
            }
        }
        // ancestors of the block, at position p of each of its rows
        let mut ancestor = places[first].parent;
        for p in (0..shared).rev() {
            let Some(i) = ancestor else { break };
            let l: [T; SIZE] = std::array::from_fn(|k| rows[k][p] / d[k]);
            let h_i = &mut above[places[i].start..][..=p];
            let h: [&[T]; SIZE] = rows.each_ref().map(|row| &row[..h_i.len()]);
            for j in 0..h_i.len() {
                for k in (0..SIZE).rev() {
                    h_i[j] = (-l[k]).mul_add(h[k][j], h_i[j]);
                }
            }
            for (row, l) in rows.iter_mut().zip(l) {
                row[p] = l;
            }
            ancestor = places[i].parent;
        }
    }

    /// `x_j −= L_kj x_k` for every dof k of a block, the last first, and every strict ancestor j of k.
    #[inline(always)]
    fn subtract_from_ancestors<const SIZE: usize>(&self, first: usize, x: &mut [T]) {
        let (shared, rows) = self.rows::<SIZE>(first);
        let mut x_k = [T::zero(); SIZE];
        for k in (0..SIZE).rev() {
            x_k[k] = -x[first + k];
            for (x_j, l) in x[first..first + k].iter_mut().zip(&rows[k][shared..]) {
                *x_j = l.mul_add(x_k[k], *x_j);
            }
        }
        for (dofs, entries) in self.matrix.ancestors(first) {
            let x_j = &mut x[dofs];
            let l: [&[T]; SIZE] = rows.map(|row| &row[entries.start..][..x_j.len()]);
            for j in 0..x_j.len() {
                for k in (0..SIZE).rev() {
                    x_j[j] = l[k][j].mul_add(x_k[k], x_j[j]);
                }
            }
        }
    }

    /// `x_k −= L_kj x_j` for every dof k of a block, the first first, and every strict ancestor j of k.
    #[inline(always)]
    fn subtract_ancestors<const SIZE: usize>(&self, first: usize, x: &mut [T]) {
        let (shared, rows) = self.rows::<SIZE>(first);
        let mut x_k: [T; SIZE] = std::array::from_fn(|k| x[first + k]);
        for (dofs, entries) in self.matrix.ancestors(first) {
            let x_j = &x[dofs];
            let l: [&[T]; SIZE] = rows.map(|row| &row[entries.start..][..x_j.len()]);
            for j in 0..x_j.len() {
                for k in 0..SIZE {
                    x_k[k] = (-l[k][j]).mul_add(x_j[j], x_k[k]);
                }
            }
        }
        for k in 0..SIZE {
            for j in 0..k {
                x_k[k] = (-rows[k][shared + j]).mul_add(x_k[j], x_k[k]);
            }
        }
        x[first..first + SIZE].copy_from_slice(&x_k);
    }

    /// The rows of a block, and how many strict ancestors its first dof has.
    #[inline(always)]
    fn rows<const SIZE: usize>(&self, first: usize) -> (usize, [&[T]; SIZE]) {
        let rows = std::array::from_fn(|k| &self.matrix.values()[self.matrix.row(first + k)]);
        (self.matrix.depth(first) - 1, rows)
    }
}

/// The rows of a block at the beginning of a slice. Row k of the block has `shared` + k + 1 entries; its first dof has `shared` strict
/// ancestors.
#[inline(always)]
fn split_rows<T, const SIZE: usize>(mut values: &mut [T], shared: usize) -> [&mut [T]; SIZE] {
    std::array::from_fn(|k| {
        let (row, rest) = std::mem::take(&mut values).split_at_mut(shared + k + 1);
        values = rest;
        row
    })
}
