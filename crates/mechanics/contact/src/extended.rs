//! Small dense linear algebra in double-double arithmetic: what the exact decisions of the enumeration rest on.

use crate::problem::Mechanism;
use featherbench_spatial::{DoubleDouble, Real};
use nalgebra::DMatrix;

/// A dense matrix of double-doubles, row by row.
#[derive(Clone, Debug)]
pub(crate) struct Matrix {
    pub rows: usize,
    pub columns: usize,
    entries: Vec<DoubleDouble>,
}

impl Matrix {
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, entries: vec![DoubleDouble::zero(); rows * columns] }
    }

    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> DoubleDouble) -> Self {
        let entries = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))).map(|(row, column)| entry(row, column));
        Self { rows, columns, entries: entries.collect() }
    }

    pub fn from_f64(matrix: &DMatrix<f64>) -> Self {
        Self::from_fn(matrix.nrows(), matrix.ncols(), |row, column| DoubleDouble::from_f64(matrix[(row, column)]))
    }

    pub fn to_f64(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.rows, self.columns, |row, column| self.at(row, column).to_f64())
    }

    pub fn at(&self, row: usize, column: usize) -> DoubleDouble {
        self.entries[row * self.columns + column]
    }

    pub fn set(&mut self, row: usize, column: usize, value: DoubleDouble) {
        self.entries[row * self.columns + column] = value;
    }

    fn row(&self, row: usize) -> &[DoubleDouble] {
        &self.entries[row * self.columns..][..self.columns]
    }

    /// The product with a vector, plus another vector.
    pub fn times_plus(&self, vector: &[DoubleDouble], addend: &[DoubleDouble]) -> Vec<DoubleDouble> {
        (0..self.rows).map(|row| (0..self.columns).fold(addend[row], |sum, k| self.at(row, k).mul_add(vector[k], sum))).collect()
    }

    fn swap_rows(&mut self, a: usize, b: usize) {
        for column in 0..self.columns {
            self.entries.swap(a * self.columns + column, b * self.columns + column);
        }
    }
}

/// What the equations A x = y say.
pub(crate) enum Solved {
    /// One x.
    Unique(Vec<DoubleDouble>),
    /// None.
    Inconsistent,
    /// Many. Where only one direction is free, it is given: A d = 0.
    Many(Option<Vec<DoubleDouble>>),
}

/// Solves A x = y by elimination with complete pivoting. A pivot at most `zero` is none, and neither is a residual.
///
/// A may have any shape. Cost: O(rows · columns²).
pub(crate) fn solve(mut a: Matrix, mut y: Vec<DoubleDouble>, zero: f64) -> Solved {
    let mut order: Vec<usize> = (0..a.columns).collect();
    let mut rank = 0;
    while rank < a.rows && rank < a.columns {
        let mut largest = (zero, None);
        for row in rank..a.rows {
            for &column in &order[rank..] {
                let size = a.at(row, column).to_f64().abs();
                if size > largest.0 {
                    largest = (size, Some((row, column)));
                }
            }
        }
        let Some((row, column)) = largest.1 else { break };
        a.swap_rows(rank, row);
        y.swap(rank, row);
        if let Some(place) = order.iter().position(|&c| c == column) {
            order.swap(rank, place);
        }
        let pivot = a.at(rank, column);
        for other in 0..a.rows {
            let factor = a.at(other, column);
            if other == rank || factor == DoubleDouble::zero() {
                continue;
            }
            let factor = -(factor / pivot);
            for &k in &order[rank + 1..] {
                let value = a.at(rank, k).mul_add(factor, a.at(other, k));
                a.set(other, k, value);
            }
            a.set(other, column, DoubleDouble::zero());
            y[other] = y[rank].mul_add(factor, y[other]);
        }
        rank += 1;
    }
    // NaN is not within any bound.
    if !y[rank..].iter().all(|rest| rest.to_f64().abs() <= zero) {
        return Solved::Inconsistent;
    }
    if rank < a.columns {
        return Solved::Many((rank + 1 == a.columns).then(|| {
            let free = order[rank];
            let mut direction = vec![DoubleDouble::zero(); a.columns];
            direction[free] = DoubleDouble::one();
            for (row, &column) in order[..rank].iter().enumerate() {
                direction[column] = -(a.at(row, free) / a.at(row, column));
            }
            direction
        }));
    }
    let mut x = vec![DoubleDouble::zero(); a.columns];
    for (row, &column) in order.iter().enumerate() {
        x[column] = y[row] / a.at(row, column);
    }
    Solved::Unique(x)
}

/// G = J M⁻¹ Jᵀ and J v_free of a mechanism; `None` where M has no Cholesky factor. `M = L Lᵀ`, `Y = L⁻¹ Jᵀ`, `G = Yᵀ Y`.
pub(crate) fn delassus(mechanism: &Mechanism) -> Option<(Matrix, Vec<DoubleDouble>)> {
    let (mass, jacobian) = (Matrix::from_f64(&mechanism.mass), Matrix::from_f64(&mechanism.jacobian));
    let (dofs, rows) = (mass.rows, jacobian.rows);
    let free: Vec<DoubleDouble> = mechanism.free.iter().map(|v| DoubleDouble::from_f64(*v)).collect();
    let free = jacobian.times_plus(&free, &vec![DoubleDouble::zero(); rows]);
    let mut lower = Matrix::zeros(dofs, dofs);
    for row in 0..dofs {
        for column in 0..=row {
            let sum = less_products(mass.at(row, column), lower.row(row), lower.row(column), column);
            let is_positive = sum.to_f64() > 0.0;
            match (row == column, is_positive) {
                (true, true) => lower.set(row, row, sum.sqrt()),
                (true, false) => return None,
                (false, _) => lower.set(row, column, sum / lower.at(column, column)),
            }
        }
    }
    // Each row of `half` is a column of Y.
    let mut half = Matrix::zeros(rows, dofs);
    for row in 0..rows {
        for dof in 0..dofs {
            let sum = less_products(jacobian.at(row, dof), half.row(row), lower.row(dof), dof);
            half.set(row, dof, sum / lower.at(dof, dof));
        }
    }
    let mut delassus = Matrix::zeros(rows, rows);
    for a in 0..rows {
        for b in 0..=a {
            let product = -less_products(DoubleDouble::zero(), half.row(a), half.row(b), dofs);
            delassus.set(a, b, product);
            delassus.set(b, a, product);
        }
    }
    Some((delassus, free))
}

/// `from − Σ a_k b_k` over the first `count` numbers.
fn less_products(from: DoubleDouble, a: &[DoubleDouble], b: &[DoubleDouble], count: usize) -> DoubleDouble {
    a[..count].iter().zip(b).fold(from, |sum, (a, b)| (-*a).mul_add(*b, sum))
}
