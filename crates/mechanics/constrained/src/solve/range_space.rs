//! The range-space method: multipliers first, from the Delassus matrix.
//!
//! Computes `G λ = b − J M⁻¹(τ − h)`, then `v̇ = M⁻¹ (τ − h + Jᵀλ)`. G comes from propagation through the articulated bodies and `M⁻¹` from
//! the articulated-body algorithm, so no matrix of the size of the robot is factored. G is factored with diagonal pivots: `Pᵀ G P = L D
//! Lᵀ`, which ends where the largest pivot left is at most `tolerance` times the first.
//!
//! Source: the book, chapter 8 (multipliers from `J M⁻¹ Jᵀ`, with redundant rows dropped); N. J. Higham, *Accuracy and Stability of
//! Numerical Algorithms* (2002), section 10.3, for the pivots. G has the squares of what the rows have: a dependent row is seen at 10⁻¹²,
//! which is 10⁻⁶ of a row's length. Between 10⁻¹⁰ and 10⁻⁶ its rank can therefore be less than that of [`Kkt`](super::Kkt).
//! Cost: O(n m) for G, m r² / 2 for its factors. It allocates.

use super::{Equations, Method, Solution, check_tolerance};
use crate::delassus::by_propagation;
use crate::error::Error;
use featherbench_dynamics::Aba;
use nalgebra::DMatrix;

/// The range-space method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeSpace {
    /// What a pivot may be of the largest, and count as zero.
    pub tolerance: f64,
}

impl Default for RangeSpace {
    /// 10⁻¹²: rounding leaves about m·10⁻¹⁶ of a dependent row's pivot, and some hundred times that on badly scaled rows.
    fn default() -> Self {
        Self { tolerance: 1e-12 }
    }
}

impl Method for RangeSpace {
    fn name(&self) -> &'static str {
        "range-space"
    }

    fn solve(&self, equations: &Equations<'_>) -> Result<Solution, Error> {
        check_tolerance("tolerance of the range-space method", self.tolerance)?;
        let model = equations.model;
        let (nv, zeros) = (model.topology.nv(), vec![0.0; model.topology.nv()]);
        let g = by_propagation(model, equations.q, equations.rows.rows())?;
        // At v = 0 without gravity the articulated bodies solve M x = f.
        let mut aba = Aba::new(&model.topology);
        let mut free = vec![0.0; nv];
        aba.run(model, equations.q, &zeros, &zeros, None, &mut free)?;
        aba.solve(model, equations.force, &mut free)?;
        let (multipliers, rank) = solve_pivoted(g, &equations.shortfall(&free)?, self.tolerance);
        let mut change = vec![0.0; nv];
        aba.solve(model, &equations.constraint_force(&multipliers), &mut change)?;
        let acceleration = free.iter().zip(change).map(|(free, change)| free + change).collect();
        let solution = equations.judged(acceleration, multipliers)?;
        equations.consistent(solution, &free, rank)
    }
}

/// The solution of `G λ = c` with λ = 0 on dependent rows, and the rank.
fn solve_pivoted(mut g: DMatrix<f64>, c: &[f64], tolerance: f64) -> (Vec<f64>, usize) {
    let m = c.len();
    let mut order: Vec<usize> = (0..m).collect();
    let (mut rank, mut first) = (0, 0.0);
    while let Some((next, pivot)) = (rank..m).map(|k| (k, g[(k, k)])).max_by(|a, b| a.1.total_cmp(&b.1)) {
        if rank == 0 {
            first = pivot;
        }
        if pivot <= tolerance * first {
            break;
        }
        g.swap_rows(rank, next);
        g.swap_columns(rank, next);
        order.swap(rank, next);
        for row in rank + 1..m {
            let factor = g[(row, rank)] / pivot;
            for column in rank + 1..=row {
                let value = (-factor).mul_add(g[(column, rank)], g[(row, column)]);
                (g[(row, column)], g[(column, row)]) = (value, value);
            }
        }
        // L below the diagonal, once D L has been used.
        for row in rank + 1..m {
            g[(row, rank)] /= pivot;
        }
        rank += 1;
    }
    let mut x: Vec<f64> = order[..rank].iter().map(|row| c[*row]).collect();
    for k in 0..rank {
        for j in 0..k {
            x[k] -= g[(k, j)] * x[j];
        }
    }
    for k in (0..rank).rev() {
        x[k] /= g[(k, k)];
        for j in k + 1..rank {
            x[k] -= g[(j, k)] * x[j];
        }
    }
    let mut lambda = vec![0.0; m];
    order.iter().zip(x).for_each(|(row, x)| lambda[*row] = x);
    (lambda, rank)
}
