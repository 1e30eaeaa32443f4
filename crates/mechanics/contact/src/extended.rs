//! Small dense linear algebra with balls: what the decisions of the enumeration and the proofs rest on.

use crate::ball::Ball;
use nalgebra::{DMatrix, DVector};

/// A dense matrix of balls.
pub(crate) type Matrix = DMatrix<Ball>;

/// A matrix of doubles, exactly.
pub(crate) fn wide(matrix: &DMatrix<f64>) -> Matrix {
    matrix.map(Ball::exact)
}

/// A x + y.
pub(crate) fn times_plus(a: &Matrix, x: &[Ball], y: &[Ball]) -> Vec<Ball> {
    a.row_iter().zip(y).map(|(row, y)| row.iter().zip(x).fold(*y, |sum, (a, x)| sum + *a * *x)).collect()
}

/// What the equations A x = y say.
pub(crate) enum Solved {
    /// One x.
    Unique(Vec<Ball>),
    /// None.
    Inconsistent,
    /// Many. Where only one direction is free, it is given: A d = 0.
    Many(Option<Vec<Ball>>),
}

/// Solves A x = y by elimination with complete pivoting. Also tells whether what it says is certain: not where a pivot was taken as zero that
/// may be another number within its error.
///
/// A may have any shape. Cost: O(rows · columns²).
pub(crate) fn solve(mut a: Matrix, mut y: Vec<Ball>) -> (Solved, bool) {
    let (rows, columns) = a.shape();
    let mut order: Vec<usize> = (0..columns).collect();
    let mut rank = 0;
    while rank < rows && rank < columns {
        let mut largest = (0.0, None);
        for row in rank..rows {
            for &column in &order[rank..] {
                let size = a[(row, column)].to_f64().abs();
                if size > largest.0 && a[(row, column)].is_nonzero() {
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
            if other == rank || a[(other, column)].is_zero() {
                continue;
            }
            let factor = a[(other, column)] / pivot;
            for &k in &order[rank + 1..] {
                a[(other, k)] = a[(other, k)] - a[(rank, k)] * factor;
            }
            a[(other, column)] = Ball::exact(0.0);
            y[other] = y[other] - y[rank] * factor;
        }
        rank += 1;
    }
    let certain = (rank..rows).all(|row| order[rank..].iter().all(|&column| a[(row, column)].is_zero()));
    if y[rank..].iter().any(|rest| rest.is_nonzero() || rest.to_f64().is_nan()) {
        return (Solved::Inconsistent, certain && !y[rank..].iter().any(|rest| rest.to_f64().is_nan()));
    }
    if rank < columns {
        let free = order[rank];
        let direction = (rank + 1 == columns).then(|| {
            let mut direction = vec![Ball::exact(0.0); columns];
            direction[free] = Ball::exact(1.0);
            for (row, &column) in order[..rank].iter().enumerate() {
                direction[column] = -(a[(row, free)] / a[(row, column)]);
            }
            direction
        });
        return (Solved::Many(direction), certain);
    }
    let mut x = vec![Ball::exact(0.0); columns];
    for (row, &column) in order.iter().enumerate() {
        x[column] = y[row] / a[(row, column)];
    }
    (Solved::Unique(x), true)
}

/// G = J M⁻¹ Jᵀ and J v_free; `None` where M has no Cholesky factor. `M = L D Lᵀ`, `Y = L⁻¹ Jᵀ`, `G = Yᵀ D⁻¹ Y`.
pub(crate) fn delassus(mass: &DMatrix<f64>, jacobian: &DMatrix<f64>, free: &DVector<f64>) -> Option<(Matrix, Vec<Ball>)> {
    let (mut lower, jacobian) = (wide(mass), wide(jacobian));
    let (rows, dofs) = jacobian.shape();
    let free: Vec<Ball> = free.iter().map(|v| Ball::exact(*v)).collect();
    let free = times_plus(&jacobian, &free, &vec![Ball::exact(0.0); rows]);
    for row in 0..dofs {
        for column in 0..=row {
            let product = |k: usize| lower[(row, k)] * lower[(k, k)] * lower[(column, k)];
            let sum = (0..column).fold(lower[(row, column)], |sum, k| sum - product(k));
            lower[(row, column)] = if row == column { sum } else { sum / lower[(column, column)] };
        }
        let is_positive = lower[(row, row)].to_f64() > 0.0;
        if !is_positive {
            return None;
        }
    }
    let mut half = jacobian.transpose();
    for mut y in half.column_iter_mut() {
        for dof in 0..dofs {
            y[dof] = (0..dof).fold(y[dof], |sum, k| sum - y[k] * lower[(dof, k)]);
        }
    }
    let mut delassus = Matrix::from_element(rows, rows, Ball::exact(0.0));
    for a in 0..rows {
        for b in 0..=a {
            let product = |k: usize| half[(k, a)] * half[(k, b)] / lower[(k, k)];
            let product = (0..dofs).fold(Ball::exact(0.0), |sum, k| sum + product(k));
            (delassus[(a, b)], delassus[(b, a)]) = (product, product);
        }
    }
    Some((delassus, free))
}
