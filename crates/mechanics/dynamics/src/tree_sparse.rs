//! A symmetric matrix with the sparsity that branches of a tree induce, or its factors: one flat array.
//!
//! Source: the book, sections 6.4 and 6.5. Entry (i, j) can differ from zero only if one dof supports the other.
//! Shape: `nv`×`nv`. Row i stores the dofs from the root to i, itself last: `n + Σ(d_k − 1)` numbers, laid out as [`Topology::row`] says.
//! Row i is as long as the depth d_i. An ancestor's row has the same columns as the beginning of row i: inner loops run over contiguous
//! numbers.
//! Cost: [`TreeSparse::get`] O(1), [`TreeSparse::mul`] O(Σ d_k). Neither allocates.

use crate::error::expect;
use crate::parents::check_depth_first;
use crate::{DimensionError, NotATree, NotPositiveDefinite};
use featherbench_model::Topology;
use featherbench_spatial::Real;
use nalgebra::{DMatrix, Scalar};
use std::ops::Range;

/// The most dofs in one block: four rows and what they change leave free registers.
pub(crate) const BLOCK: usize = 4;

/// Zeros behind the stored numbers: a register loaded from any of them stays inside.
pub(crate) const PADDING: usize = 8;

/// A tree-sparse symmetric matrix (or the factors of one, see [`Ltdl`](crate::Ltdl)).
#[derive(Clone, Debug, PartialEq)]
pub struct TreeSparse<T> {
    /// The stored numbers and [`PADDING`].
    values: Vec<T>,
    stored: usize,
    rows: Vec<Row>,
}

/// Where a dof's row begins, and the dof's place in the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    /// Where the row begins in the flat array.
    pub(crate) start: usize,
    /// The parent dof.
    pub(crate) parent: Option<usize>,
    /// The first dof of this dof's *run*: consecutive dofs, each the parent of the next. Runs are contiguous in rows and in vectors.
    run: usize,
    /// One past the last dof that this one supports.
    pub(crate) end: usize,
}

impl Row {
    /// The same row in an array that begins at number `first` of the flat array.
    pub(crate) fn counted_from(self, first: usize) -> Self {
        Self { start: self.start - first, ..self }
    }
}

impl<T: Real> TreeSparse<T> {
    /// The zero matrix of a topology.
    pub fn new(topology: &Topology) -> Self {
        Self::of_depth_first(topology.dof_parents())
    }

    /// The zero matrix of a tree without a robot: the parent of each dof, `None` for a root, in depth-first order.
    ///
    /// # Errors
    /// [`NotATree`] when the order is not depth-first; [`depth_first_order`](crate::depth_first_order) makes one.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// // Two dofs on one: rows of 1, 2 and 2 numbers.
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0), Some(0)])?;
    /// matrix.fill(|i, j| if i == j { 4.0 } else { 1.0 });
    /// assert_eq!(matrix.values(), [4.0, 1.0, 4.0, 1.0, 4.0]);
    /// let factors = matrix.into_ltdl()?;
    /// assert_eq!(factors.factors().get(0, 0), 3.5, "4 − 1/4 − 1/4");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_parents(parents: &[Option<usize>]) -> Result<Self, NotATree> {
        check_depth_first(parents)?;
        Ok(Self::of_depth_first(parents))
    }

    fn of_depth_first(parents: &[Option<usize>]) -> Self {
        let mut rows: Vec<Row> = Vec::with_capacity(parents.len());
        let (mut stored, mut depths) = (0, Vec::with_capacity(parents.len()));
        for (dof, &parent) in parents.iter().enumerate() {
            let run = if dof > 0 && parent == Some(dof - 1) { rows[dof - 1].run } else { dof };
            rows.push(Row { start: stored, parent, run, end: dof + 1 });
            depths.push(1 + parent.map_or(0, |parent| depths[parent]));
            stored += depths[dof];
        }
        for dof in (0..rows.len()).rev() {
            if let Some(parent) = rows[dof].parent {
                rows[parent].end = rows[parent].end.max(rows[dof].end);
            }
        }
        Self { values: vec![T::zero(); stored + PADDING], stored, rows }
    }

    /// The matrix with these entries. `entry(i, j)` is called for each stored entry; dof `j` supports dof `i`.
    pub fn from_fn(topology: &Topology, entry: impl FnMut(usize, usize) -> T) -> Self {
        let mut matrix = Self::new(topology);
        matrix.fill(entry);
        matrix
    }

    /// Writes every stored entry, row after row. `entry(i, j)` is called with a dof `j` that supports dof `i`. It allocates one path.
    pub fn fill(&mut self, mut entry: impl FnMut(usize, usize) -> T) {
        let mut path: Vec<usize> = Vec::new();
        for dof in 0..self.size() {
            let row = self.row(dof);
            // In depth-first order the path to a dof is that to the dof before it, cut.
            path.truncate(row.len() - 1);
            path.push(dof);
            for (value, &ancestor) in self.values[row].iter_mut().zip(&path) {
                *value = entry(dof, ancestor);
            }
        }
    }

    /// The parent of a dof: the last dof but one of its row. `None` for a root, and where there is no such dof.
    pub fn parent(&self, dof: usize) -> Option<usize> {
        self.rows.get(dof)?.parent
    }

    /// How many dofs are on the path from the root to `dof`, itself included: the length of its row. Zero where there is no such dof.
    pub fn path_length(&self, dof: usize) -> usize {
        if dof < self.size() { self.depth(dof) } else { 0 }
    }

    /// Rows and columns: the number of dofs.
    pub fn size(&self) -> usize {
        self.rows.len()
    }

    /// The stored numbers, row after row.
    pub fn values(&self) -> &[T] {
        &self.values[..self.stored]
    }

    /// The stored numbers, to be written.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values[..self.stored]
    }

    /// Exchanges the stored numbers with those of another matrix: matrices of one topology in turn, without a copy.
    ///
    /// # Errors
    /// [`DimensionError`] when the counts differ; nothing is exchanged then.
    pub fn exchange(&mut self, other: &mut Self) -> Result<(), DimensionError> {
        expect("stored numbers of the tree-sparse matrix", self.stored, other.stored)?;
        std::mem::swap(&mut self.values, &mut other.values);
        Ok(())
    }

    /// Entry (i, j): zero where neither dof supports the other, or where there is no such entry.
    pub fn get(&self, i: usize, j: usize) -> T {
        let (upper, lower) = (i.min(j), i.max(j));
        match (self.rows.get(lower), self.rows.get(upper)) {
            (Some(row), Some(column)) if lower < column.end => self.values[row.start + self.depth(upper) - 1],
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
            let row = &self.values[self.row(dof)];
            for (dofs, entries) in self.ancestors(dof) {
                let mut sum = y[dof];
                for ((m, x_j), y_j) in row[entries].iter().zip(&x[dofs.clone()]).zip(&mut y[dofs]) {
                    sum = m.mul_add(*x_j, sum);
                    *y_j = m.mul_add(x[dof], *y_j);
                }
                y[dof] = sum;
            }
        }
        Ok(())
    }

    /// `M x` for the symmetric matrix M. It allocates.
    ///
    /// # Errors
    /// [`DimensionError`] when x has not one number per dof.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 8.0]);
    /// assert_eq!(matrix.product(&[1.0, 1.0])?, [9.0, 12.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn product(&self, x: &[T]) -> Result<Vec<T>, DimensionError> {
        let mut y = vec![T::zero(); self.size()];
        self.mul(x, &mut y)?;
        Ok(y)
    }

    /// The dense matrix; it allocates.
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
        self.expect_same_tree(other)?;
        self.values.copy_from_slice(&other.values);
        Ok(())
    }

    /// An error if the other matrix has another topology.
    pub(crate) fn expect_same_tree(&self, other: &Self) -> Result<(), DimensionError> {
        let agreeing = self.rows.iter().zip(&other.rows).filter(|(row, theirs)| row == theirs).count();
        expect("dofs of the tree-sparse matrix", self.size(), other.size())?;
        expect("dofs of the tree-sparse matrix with the same place in the tree", self.size(), agreeing)
    }

    /// An error if the topology has another shape.
    pub(crate) fn expect_topology(&self, topology: &Topology) -> Result<(), DimensionError> {
        expect("dofs of the tree-sparse matrix", topology.nv(), self.size())?;
        let agreeing = self.rows.iter().zip(topology.dof_parents()).filter(|(row, parent)| row.parent == **parent).count();
        expect("dofs of the tree-sparse matrix with the model's parent dof", topology.nv(), agreeing)
    }

    /// Adds to a diagonal entry.
    #[inline(always)]
    pub(crate) fn add_to_diagonal(&mut self, dof: usize, value: T) {
        let last = self.row(dof).end - 1;
        self.values[last] += value;
    }

    /// Zeros behind the stored numbers again, after rows were written in whole registers.
    pub(crate) fn clear_padding(&mut self) {
        self.values[self.stored..].fill(T::zero());
    }

    /// A dof's depth: the length of its row.
    #[inline(always)]
    pub(crate) fn depth(&self, dof: usize) -> usize {
        self.row(dof).len()
    }

    /// The range of row `dof` in the flat array.
    #[inline(always)]
    pub(crate) fn row(&self, dof: usize) -> Range<usize> {
        self.rows[dof].start..self.rows.get(dof + 1).map_or(self.stored, |next| next.start)
    }

    /// The dofs that `dof` supports, itself first.
    #[inline(always)]
    pub(crate) fn supported(&self, dof: usize) -> Range<usize> {
        dof..self.rows[dof].end
    }

    /// The rows and the flat array with its padding.
    #[inline(always)]
    pub(crate) fn parts_mut(&mut self) -> (&[Row], &mut [T]) {
        (&self.rows, &mut self.values)
    }

    /// The rows and the flat array with its padding.
    #[inline(always)]
    pub(crate) fn parts(&self) -> (&[Row], &[T]) {
        (&self.rows, &self.values)
    }

    /// Whether the parent of `dof` is the dof before it.
    pub(crate) fn continues(&self, dof: usize) -> bool {
        self.rows[dof].run < dof
    }

    /// How many dofs just before `end` are in one run, [`BLOCK`] at most.
    #[inline(always)]
    pub(crate) fn block_before(&self, end: usize) -> usize {
        (end - self.rows[end - 1].run).min(BLOCK)
    }

    /// How many dofs from `first` on are in one run, [`BLOCK`] at most.
    #[inline(always)]
    pub(crate) fn block_from(&self, first: usize) -> usize {
        let rows = &self.rows[first..];
        rows.iter().take(BLOCK).take_while(|row| row.run == rows[0].run).count()
    }

    /// The strict ancestors of `dof`, run by run from the nearest to the root. Each item: the ancestors' dofs, and their entries in row
    /// `dof`.
    #[inline(always)]
    pub(crate) fn ancestors(&self, dof: usize) -> impl Iterator<Item = (Range<usize>, Range<usize>)> + '_ {
        let mut end = self.depth(dof) - 1;
        let mut next = self.rows[dof].parent;
        std::iter::from_fn(move || {
            let last = next?;
            let first = self.rows[last].run;
            let entries = end + first - (last + 1)..end;
            (next, end) = (self.rows[first].parent, entries.start);
            Some((first..last + 1, entries))
        })
    }
}
