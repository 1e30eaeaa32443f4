//! Constrained accelerations in double-double arithmetic: what other answers are compared with.
//!
//! Computes, from M, h, J and J̇v in 32 digits and with `G = J M⁻¹ Jᵀ`,
//!
//! ```text
//! G λ = −J̇v − J M⁻¹(τ − h)        v̇ = M⁻¹(τ − h + Jᵀλ)
//! ```
//!
//! G is factored with diagonal pivots, and pivots below [`REDUNDANT`] of the first count as zero: their rows depend on others. It uses dense
//! matrices and no tree, so it shares neither factors nor the decision about rank with [`Kkt`](crate::Kkt). Frames, shapes and units: as
//! [`Constrained`](crate::Constrained). Cost: n³/6 + n² m / 2 + m r². It allocates.

use crate::constraint::Constraints;
use crate::delassus::{cholesky, forward};
use crate::error::Error;
use crate::rows::Rows;
use featherbench_dynamics::{DimensionError, bias_force, mass_matrix};
use featherbench_model::Model;
use featherbench_spatial::{DoubleDouble, Real};
use nalgebra::DMatrix;

/// A pivot of G that is zero, of the first. States are doubles: they lie 10⁻¹⁶ beside the constraints, where a redundant row keeps 10⁻¹⁶ of its
/// length and 10⁻³² of its pivot. An independent row has 10⁻²⁰ where it is 10⁻¹⁰ of its length from the others.
pub const REDUNDANT: f64 = 1e-24;

type Matrix = DMatrix<DoubleDouble>;

/// v̇ at a state, rounded once.
///
/// # Errors
/// [`Error`]: an argument does not fit or is not finite, a dof meets no inertia, or a weld is half a turn off.
///
/// ```
/// use featherbench_constrained::{accelerations, systems::Ladder};
/// let ladder = Ladder::default();
/// let four_bar = ladder.mechanism()?;
/// let found = accelerations(&four_bar.model, &four_bar.constraints, &ladder.spread(0.5), &ladder.spread(0.3), &[0.0; 3])?;
/// assert!((found[0] - ladder.acceleration(0.5)).abs() < 1e-15 * ladder.acceleration(0.5).abs());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn accelerations(model: &Model<f64>, constraints: &Constraints, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Vec<f64>, Error> {
    let n = model.topology.nv();
    DimensionError::expect("joint forces tau", n, tau.len())?;
    crate::rows::expect_finite("joint forces tau", tau)?;
    let wide = |x: &[f64]| x.iter().map(|x| DoubleDouble::from_f64(*x)).collect::<Vec<_>>();
    let (q, v) = (wide(q), wide(v));
    let mut rows = Rows::<DoubleDouble>::new(constraints);
    rows.run(model, constraints, &q, &v)?;
    let lower = cholesky(&mass_matrix(model, &q)?)?;
    let bias = bias_force(model, &q, &v)?;
    let mut start: Vec<_> = tau.iter().zip(bias).map(|(tau, h)| DoubleDouble::from_f64(*tau) - h).collect();
    // Y = L⁻¹Jᵀ and w = L⁻¹(τ − h), so that G = YᵀY and J M⁻¹(τ − h) = Yᵀw.
    let mut half = Matrix::from_column_slice(n, constraints.rows(), rows.jacobian());
    half.column_iter_mut().for_each(|mut column| forward(&lower, column.as_mut_slice()));
    forward(&lower, &mut start);
    let due: Vec<_> = rows.biases().zip(half.column_iter()).map(|(bias, y)| -bias - dot(y.as_slice(), &start)).collect();
    let lambda = pivoted(&half, due);
    for (column, lambda) in half.column_iter().zip(lambda) {
        start.iter_mut().zip(column.iter()).for_each(|(w, y)| *w = y.mul_add(lambda, *w));
    }
    backward(&lower, &mut start);
    Ok(start.iter().map(|x| x.to_f64()).collect())
}

fn dot(a: &[DoubleDouble], b: &[DoubleDouble]) -> DoubleDouble {
    a.iter().zip(b).fold(DoubleDouble::zero(), |sum, (a, b)| a.mul_add(*b, sum))
}

/// x ← L⁻ᵀx.
fn backward(lower: &Matrix, x: &mut [DoubleDouble]) {
    for row in (0..x.len()).rev() {
        let sum = (row + 1..x.len()).fold(x[row], |sum, k| (-lower[(k, row)]).mul_add(x[k], sum));
        x[row] = sum / lower[(row, row)];
    }
}

/// λ with YᵀY λ = c on the independent rows, and zero on the others.
fn pivoted(half: &Matrix, mut c: Vec<DoubleDouble>) -> Vec<DoubleDouble> {
    let m = half.ncols();
    let mut g = Matrix::from_fn(m, m, |a, b| dot(half.column(a).as_slice(), half.column(b).as_slice()));
    let mut order: Vec<usize> = (0..m).collect();
    let (mut rank, mut first) = (0, 0.0);
    while let Some((next, pivot)) = (rank..m).map(|k| (k, g[(k, k)].to_f64())).max_by(|a, b| a.1.total_cmp(&b.1)) {
        if rank == 0 {
            first = pivot;
        }
        if pivot <= REDUNDANT * first {
            break;
        }
        g.swap_rows(rank, next);
        g.swap_columns(rank, next);
        order.swap(rank, next);
        c.swap(rank, next);
        for row in rank + 1..m {
            let factor = g[(row, rank)] / g[(rank, rank)];
            for column in rank..m {
                g[(row, column)] = (-factor).mul_add(g[(rank, column)], g[(row, column)]);
            }
            c[row] = (-factor).mul_add(c[rank], c[row]);
        }
        rank += 1;
    }
    let mut lambda = vec![DoubleDouble::zero(); m];
    for k in (0..rank).rev() {
        let sum = (k + 1..rank).fold(c[k], |sum, j| (-g[(k, j)]).mul_add(lambda[order[j]], sum));
        lambda[order[k]] = sum / g[(k, k)];
    }
    lambda
}
