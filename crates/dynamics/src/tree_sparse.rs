//! A symmetric matrix with the sparsity that branches of a tree induce, or its factors: one flat array.
//!
//! Source: the book, sections 6.4 and 6.5: entry (i, j) can differ from zero only if one dof supports the other. Row i stores the dofs from
//! the root to i, itself last: `n + Σ(d_k − 1)` numbers, laid out as [`Topology::row`] says. A dof's row is as long as its depth, and an
//! ancestor's row is aligned with the beginning of it, so that inner loops run over contiguous numbers.

use crate::error::expect;
use crate::{DimensionError, NotPositiveDefinite};
use model::Topology;
use nalgebra::{DMatrix, Scalar};
use spatial::Real;
use std::ops::Range;

/// A tree-sparse symmetric matrix (or the factors of one, see [`Ltdl`](crate::Ltdl)).
#[derive(Clone, Debug, PartialEq)]
pub struct TreeSparse<T> {
    values: Vec<T>,
    /// Where each row begins in the flat array, and where the last one ends.
    starts: Vec<usize>,
    dofs: Vec<Dof>,
}

/// A dof's place in the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dof {
    /// The parent dof.
    pub(crate) parent: Option<usize>,
    /// The first dof of this dof's *run*: consecutive dofs, each the parent of the next. Runs are contiguous in rows and in vectors.
    run: usize,
    /// One past the last dof that this one supports.
    end: usize,
}

impl<T: Real> TreeSparse<T> {
    /// The zero matrix of a topology.
    pub fn new(topology: &Topology) -> Self {
        let parents = topology.dof_parents();
        let mut dofs: Vec<Dof> = Vec::with_capacity(parents.len());
        for (dof, &parent) in parents.iter().enumerate() {
            let run = if dof > 0 && parent == Some(dof - 1) { dofs[dof - 1].run } else { dof };
            dofs.push(Dof { parent, run, end: dof + 1 });
        }
        for dof in (0..dofs.len()).rev() {
            if let Some(parent) = dofs[dof].parent {
                dofs[parent].end = dofs[parent].end.max(dofs[dof].end);
            }
        }
        let starts = (0..dofs.len()).map(|dof| topology.row(dof).start).chain([topology.stored()]).collect();
        Self { values: vec![T::zero(); topology.stored()], starts, dofs }
    }

    /// The matrix with these entries: `entry(i, j)` is asked for each stored one, `j` supporting `i`.
    pub fn from_fn(topology: &Topology, mut entry: impl FnMut(usize, usize) -> T) -> Self {
        let mut matrix = Self::new(topology);
        for i in 0..topology.nv() {
            for (value, &j) in matrix.values[topology.row(i)].iter_mut().zip(topology.row_dofs(i)) {
                *value = entry(i, j);
            }
        }
        matrix
    }

    /// Rows and columns: the number of dofs.
    pub fn size(&self) -> usize {
        self.dofs.len()
    }

    /// The stored numbers, row after row.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Entry (i, j): zero where neither dof supports the other, or where there is no such entry.
    pub fn get(&self, i: usize, j: usize) -> T {
        let (upper, lower) = (i.min(j), i.max(j));
        match self.dofs.get(upper) {
            Some(support) if lower < support.end => self.values[self.starts[lower] + self.depth(upper) - 1],
            _ => T::zero(),
        }
    }

    /// The diagonal.
    pub fn diagonal(&self) -> impl ExactSizeIterator<Item = T> {
        (0..self.size()).map(|dof| self.values[self.row(dof).end - 1])
    }

    /// `y = M x` for the symmetric matrix M.
    ///
    /// # Errors
    /// [`DimensionError`] when a vector has not one number per dof.
    pub fn mul(&self, x: &[T], y: &mut [T]) -> Result<(), DimensionError> {
        expect("vector x", self.size(), x.len())?;
        expect("vector y", self.size(), y.len())?;
        for (dof, diagonal) in self.diagonal().enumerate() {
            y[dof] = diagonal * x[dof];
            for (dofs, entries) in self.ancestors(dof) {
                let mut sum = y[dof];
                for ((m, x_j), y_j) in self.values[entries].iter().zip(&x[dofs.clone()]).zip(&mut y[dofs]) {
                    sum = m.mul_add(*x_j, sum);
                    *y_j = m.mul_add(x[dof], *y_j);
                }
                y[dof] = sum;
            }
        }
        Ok(())
    }

    /// The whole matrix; it allocates.
    pub fn to_dense(&self) -> DMatrix<T>
    where
        T: Scalar,
    {
        DMatrix::from_fn(self.size(), self.size(), |i, j| self.get(i, j))
    }

    /// Factors the matrix as `LᵀDL`; see [`Ltdl`](crate::Ltdl).
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] when a pivot is not positive.
    pub fn into_ltdl(self) -> Result<crate::Ltdl<T>, NotPositiveDefinite> {
        let mut ltdl = crate::Ltdl::from_unfactored(self);
        ltdl.factor()?;
        Ok(ltdl)
    }

    /// Copies the numbers of a matrix of the same topology.
    pub(crate) fn copy_from(&mut self, other: &Self) -> Result<(), DimensionError> {
        let agreeing = self.dofs.iter().zip(&other.dofs).filter(|(dof, theirs)| dof == theirs).count();
        expect("dofs of the tree-sparse matrix", self.size(), other.size())?;
        expect("dofs of the tree-sparse matrix with the same place in the tree", self.size(), agreeing)?;
        self.values.copy_from_slice(&other.values);
        Ok(())
    }

    /// Refuses a topology of another shape.
    pub(crate) fn expect_topology(&self, topology: &Topology) -> Result<(), DimensionError> {
        expect("dofs of the tree-sparse matrix", topology.nv(), self.size())?;
        let agreeing = self.dofs.iter().zip(topology.dof_parents()).filter(|(dof, parent)| dof.parent == **parent).count();
        expect("dofs of the tree-sparse matrix with the model's parent dof", topology.nv(), agreeing)
    }

    /// Adds to a diagonal entry.
    #[inline(always)]
    pub(crate) fn add_to_diagonal(&mut self, dof: usize, value: T) {
        let last = self.row(dof).end - 1;
        self.values[last] += value;
    }

    /// A dof's depth: the length of its row.
    #[inline(always)]
    pub(crate) fn depth(&self, dof: usize) -> usize {
        self.row(dof).len()
    }

    /// Where row `dof` stands in the flat array.
    #[inline(always)]
    pub(crate) fn row(&self, dof: usize) -> Range<usize> {
        self.starts[dof]..self.starts[dof + 1]
    }

    /// The dofs that `dof` supports, itself first.
    #[inline(always)]
    pub(crate) fn supported(&self, dof: usize) -> Range<usize> {
        dof..self.dofs[dof].end
    }

    /// The dofs' places in the tree, where their rows begin, and the flat array.
    #[inline(always)]
    pub(crate) fn parts_mut(&mut self) -> (&[Dof], &[usize], &mut [T]) {
        (&self.dofs, &self.starts, &mut self.values)
    }

    /// The strict ancestors of `dof`, run by run from the nearest to the root: their dofs, and their entries of row `dof`.
    #[inline(always)]
    pub(crate) fn ancestors(&self, dof: usize) -> impl Iterator<Item = (Range<usize>, Range<usize>)> + '_ {
        let mut end = self.row(dof).end - 1;
        let mut next = self.dofs[dof].parent;
        std::iter::from_fn(move || {
            let last = next?;
            let first = self.dofs[last].run;
            let entries = end + first - (last + 1)..end;
            (next, end) = (self.dofs[first].parent, entries.start);
            Some((first..last + 1, entries))
        })
    }
}
