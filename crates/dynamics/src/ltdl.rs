//! The factorization `M = LᵀDL` of a tree-sparse matrix without fill-in, and solutions of `M x = b`.
//!
//! Source: the book, section 6.5: eliminating from the leaves to the root keeps every zero of M. L is unit lower
//! triangular and D diagonal; they overwrite M. With d_k the depth of dof k: D1 = Σ (d_k − 1) divisions and D2 = Σ d_k (d_k − 1) / 2
//! multiply-subtracts to factor, 2·D1 multiply-subtracts and n divisions to solve. Shapes: M is `nv`×`nv`, x and b have `nv` numbers.
//! Units: those of M and b. Cost: O(Σ d_k²) and O(Σ d_k). A call does not allocate.

use crate::error::{Pivot, expect};
use crate::{DimensionError, Error, NotPositiveDefinite, TreeSparse};
use model::Topology;
use spatial::Real;

/// The factors of a tree-sparse matrix. All zero, and of no use, before the first factorization.
#[derive(Clone, Debug)]
pub struct Ltdl<T> {
    matrix: TreeSparse<T>,
}

impl<T: Real> Ltdl<T> {
    /// Room for the factors of a matrix of this topology.
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

    /// The matrix before [`Ltdl::factor`], so that it can be written where it will be factored; its factors afterwards: L below the
    /// diagonal, D on it.
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
        let values = self.matrix.values();

        // Lᵀ y = b:  x_j −= L_kj x_k, from the leaves
        for k in (0..n).rev() {
            let x_k = -x[k];
            for (dofs, entries) in self.matrix.ancestors(k) {
                for (x_j, l) in x[dofs].iter_mut().zip(&values[entries]) {
                    *x_j = l.mul_add(x_k, *x_j);
                }
            }
        }
        // D z = y
        for (x, d) in x.iter_mut().zip(self.matrix.diagonal()) {
            *x = *x / d;
        }
        // L x = z:  x_k −= L_kj x_j, from the root
        for k in 0..n {
            let mut x_k = x[k];
            for (dofs, entries) in self.matrix.ancestors(k) {
                for (x_j, l) in x[dofs].iter().zip(&values[entries]) {
                    x_k = (-*l).mul_add(*x_j, x_k);
                }
            }
            x[k] = x_k;
        }
        Ok(())
    }

    pub(crate) fn from_unfactored(matrix: TreeSparse<T>) -> Self {
        Self { matrix }
    }

    /// The factorization itself; what it leaves behind is meaningful only if the pivot is positive.
    fn eliminate(&mut self) -> Pivot {
        let mut smallest = Pivot::none();
        for k in (0..self.matrix.size()).rev() {
            let row = self.matrix.row(k);
            let (rows, values) = self.matrix.parts_mut();
            let (above, h_k) = values.split_at_mut(row.start);
            let last = row.len() - 1;
            let d = h_k[last];
            smallest.note(k, d.min_lane());

            // L_ki = H_ki / D_k,  H_i· −= L_ki H_k·  for every strict ancestor i of k, at position p of the row
            let mut ancestor = rows[k].parent;
            for p in (0..last).rev() {
                let Some(i) = ancestor else { break };
                let (l, start) = (h_k[p] / d, rows[i].start);
                for (h_i, h_k) in above[start..=start + p].iter_mut().zip(&h_k[..=p]) {
                    *h_i = (-l).mul_add(*h_k, *h_i);
                }
                h_k[p] = l;
                ancestor = rows[i].parent;
            }
        }
        smallest
    }
}
