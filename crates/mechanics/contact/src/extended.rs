//! Small dense linear algebra in double-double arithmetic: what the exact decisions of the enumeration rest on.

use featherbench_spatial::{DoubleDouble, Real};
use nalgebra::{DMatrix, DVector};

/// A dense matrix of double-doubles.
pub(crate) type Matrix = DMatrix<DoubleDouble>;

/// A matrix of doubles, exactly.
pub(crate) fn wide(matrix: &DMatrix<f64>) -> Matrix {
    matrix.map(DoubleDouble::from_f64)
}

/// A x + y.
pub(crate) fn times_plus(a: &Matrix, x: &[DoubleDouble], y: &[DoubleDouble]) -> Vec<DoubleDouble> {
    a.row_iter().zip(y).map(|(row, y)| row.iter().zip(x).fold(*y, |sum, (a, x)| a.mul_add(*x, sum))).collect()
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
    let (rows, columns) = a.shape();
    let mut order: Vec<usize> = (0..columns).collect();
    let mut rank = 0;
    while rank < rows && rank < columns {
        let mut largest = (zero, None);
        for row in rank..rows {
            for &column in &order[rank..] {
                let size = a[(row, column)].to_f64().abs();
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
        let pivot = a[(rank, column)];
        for other in 0..rows {
            let factor = a[(other, column)];
            if other == rank || factor == DoubleDouble::zero() {
                continue;
            }
            let factor = -(factor / pivot);
            for &k in &order[rank + 1..] {
                a[(other, k)] = a[(rank, k)].mul_add(factor, a[(other, k)]);
            }
            a[(other, column)] = DoubleDouble::zero();
            y[other] = y[rank].mul_add(factor, y[other]);
        }
        rank += 1;
    }
    // NaN is not within any bound.
    if !y[rank..].iter().all(|rest| rest.to_f64().abs() <= zero) {
        return Solved::Inconsistent;
    }
    if rank < columns {
        return Solved::Many((rank + 1 == columns).then(|| {
            let free = order[rank];
            let mut direction = vec![DoubleDouble::zero(); columns];
            direction[free] = DoubleDouble::one();
            for (row, &column) in order[..rank].iter().enumerate() {
                direction[column] = -(a[(row, free)] / a[(row, column)]);
            }
            direction
        }));
    }
    let mut x = vec![DoubleDouble::zero(); columns];
    for (row, &column) in order.iter().enumerate() {
        x[column] = y[row] / a[(row, column)];
    }
    Solved::Unique(x)
}

/// G = J M⁻¹ Jᵀ and J v_free; `None` where M has no Cholesky factor. `M = L Lᵀ`, `Y = L⁻¹ Jᵀ`, `G = Yᵀ Y`.
pub(crate) fn delassus(mass: &DMatrix<f64>, jacobian: &DMatrix<f64>, free: &DVector<f64>) -> Option<(Matrix, Vec<DoubleDouble>)> {
    let (mut lower, jacobian) = (wide(mass), wide(jacobian));
    let (rows, dofs) = jacobian.shape();
    let free: Vec<DoubleDouble> = free.iter().map(|v| DoubleDouble::from_f64(*v)).collect();
    let free = times_plus(&jacobian, &free, &vec![DoubleDouble::zero(); rows]);
    for row in 0..dofs {
        for column in 0..=row {
            let sum = (0..column).fold(lower[(row, column)], |sum, k| (-lower[(row, k)]).mul_add(lower[(column, k)], sum));
            let is_positive = sum.to_f64() > 0.0;
            lower[(row, column)] = match (row == column, is_positive) {
                (true, true) => sum.sqrt(),
                (true, false) => return None,
                (false, _) => sum / lower[(column, column)],
            };
        }
    }
    let mut half = jacobian.transpose();
    for mut y in half.column_iter_mut() {
        for dof in 0..dofs {
            let sum = (0..dof).fold(y[dof], |sum, k| (-y[k]).mul_add(lower[(dof, k)], sum));
            y[dof] = sum / lower[(dof, dof)];
        }
    }
    let mut delassus = Matrix::from_element(rows, rows, DoubleDouble::zero());
    for a in 0..rows {
        for b in 0..=a {
            let (x, y) = (half.column(a), half.column(b));
            let product = -x.iter().zip(y.iter()).fold(DoubleDouble::zero(), |sum, (x, y)| (-*x).mul_add(*y, sum));
            (delassus[(a, b)], delassus[(b, a)]) = (product, product);
        }
    }
    Some((delassus, free))
}
