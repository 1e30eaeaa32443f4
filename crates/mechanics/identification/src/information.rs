//! What samples say of the unknowns, in the size of the unknowns: the triangular factor of the stacked equations.
//!
//! `[W Y, W τ]` with a row per sample and dof is brought to triangular form block by block, by Householder reflections. Least squares on the
//! triangle are least squares on all rows, at the same condition number (G. Golub & C. Van Loan, *Matrix Computations*, section 5.3). So a log
//! of any length takes memory for `p²` numbers.

use crate::linear::Rows;
use crate::{IdentificationError, LinearModel, Samples};
use nalgebra::{DMatrix, DVector, RowDVector};
use std::ops::Range;

/// The triangular factor of the stacked equations `Y θ = τ`.
#[derive(Clone, Debug)]
pub struct Information {
    /// `p + 1` columns: the unknowns, then the torques. At most `p + 1` rows.
    triangle: DMatrix<f64>,
    /// Rows that were stacked.
    rows: usize,
}

/// How equations are stacked.
#[derive(Clone, Debug)]
pub struct Stacking<'a> {
    /// The dofs whose equations are taken.
    pub dofs: Range<usize>,
    /// A weight for each dof: the reciprocal of its noise, or `None` for one each.
    pub weights: Option<&'a [f64]>,
}

impl Stacking<'_> {
    /// All dofs, with the same weight.
    pub fn plain(linear: &LinearModel) -> Self {
        Self { dofs: 0..linear.model().topology.nv(), weights: None }
    }
}

impl Information {
    /// Stacks the equations of samples.
    ///
    /// # Errors
    /// [`IdentificationError`] when the samples do not fit the robot or hold a number that is not finite.
    pub fn of(linear: &LinearModel, samples: &Samples, stacking: &Stacking) -> Result<Self, IdentificationError> {
        samples.check(linear)?;
        let (nv, width) = (linear.model().topology.nv(), linear.unknowns().len() + 1);
        if let Some(weights) = stacking.weights.filter(|weights| weights.len() != nv) {
            return Err(IdentificationError::Length { array: "weights", found: weights.len(), samples: 1, expected: nv });
        }
        let mut rows = Rows::new(linear);
        let mut stack = Stack { triangle: DMatrix::zeros(0, width), pending: Vec::new(), width, most: 3 * width, rows: 0 };
        for k in 0..samples.count() {
            let (q, v, a) = samples.state(linear, k);
            let block = rows.at(linear, q, v, a)?;
            for dof in stacking.dofs.clone().filter(|&dof| dof < nv && samples.used[k * nv + dof]) {
                let weight = stacking.weights.map_or(1.0, |weights| weights[dof]);
                let tau = samples.tau[k * nv + dof] - linear.known(dof, v[dof], a[dof]);
                stack.push(block.row(dof).iter().map(|y| weight * y).chain([weight * tau]));
            }
        }
        Ok(stack.finish())
    }

    /// Stacks rows that are given: `matrix · θ = torques`.
    pub fn of_rows(matrix: &DMatrix<f64>, torques: &DVector<f64>) -> Self {
        let width = matrix.ncols() + 1;
        let mut stack = Stack { triangle: DMatrix::zeros(0, width), pending: Vec::new(), width, most: 3 * width, rows: 0 };
        for (row, tau) in matrix.row_iter().zip(torques.iter()) {
            stack.push(row.iter().copied().chain([*tau]));
        }
        stack.finish()
    }

    /// The equations that were stacked.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The unknowns.
    pub fn unknowns(&self) -> usize {
        self.triangle.ncols() - 1
    }

    /// The factor of Y: it has the singular values and the null space of Y.
    pub fn factor(&self) -> DMatrix<f64> {
        self.triangle.columns(0, self.unknowns()).into_owned()
    }

    /// What stands beside the factor: the transformed torques.
    pub fn right(&self) -> DVector<f64> {
        self.triangle.column(self.unknowns()).into_owned()
    }

    /// The equations of some unknowns alone, the others being zero.
    pub fn only(&self, columns: &[usize]) -> Self {
        let with_right: Vec<usize> = columns.iter().copied().chain([self.unknowns()]).collect();
        Self { triangle: triangle(self.triangle.select_columns(&with_right)), rows: self.rows }
    }

    /// These equations and those of another, which has the same unknowns. `None` if it has not.
    pub fn with(&self, other: &Self) -> Option<Self> {
        (self.triangle.ncols() == other.triangle.ncols()).then(|| {
            let mut both = self.triangle.clone().insert_rows(self.triangle.nrows(), other.triangle.nrows(), 0.0);
            both.rows_mut(self.triangle.nrows(), other.triangle.nrows()).copy_from(&other.triangle);
            Self { triangle: triangle(both), rows: self.rows + other.rows }
        })
    }
}

/// Rows that are brought to triangular form as they come.
struct Stack {
    triangle: DMatrix<f64>,
    pending: Vec<f64>,
    width: usize,
    /// Rows that wait before they are folded in.
    most: usize,
    rows: usize,
}

impl Stack {
    fn push(&mut self, row: impl Iterator<Item = f64>) {
        self.pending.extend(row);
        self.rows += 1;
        if self.pending.len() >= self.most * self.width {
            self.fold();
        }
    }

    fn fold(&mut self) {
        let above = self.triangle.nrows();
        let below = self.pending.len() / self.width;
        let mut both = self.triangle.clone().insert_rows(above, below, 0.0);
        for (k, row) in self.pending.chunks_exact(self.width).enumerate() {
            both.set_row(above + k, &RowDVector::from_row_slice(row));
        }
        self.pending.clear();
        self.triangle = triangle(both);
    }

    fn finish(mut self) -> Information {
        self.fold();
        Information { triangle: self.triangle, rows: self.rows }
    }
}

/// The triangular factor of a matrix.
fn triangle(matrix: DMatrix<f64>) -> DMatrix<f64> {
    if matrix.nrows() == 0 { matrix } else { matrix.qr().unpack_r() }
}
