//! Products and solutions with a lower triangular tree-sparse factor L and with its transpose, in place: the plain text, for any scalar.
//!
//! Source: the book, section 6.5 and table 6.5. Shapes: L is `nv`×`nv`, x has `nv` numbers. `UNIT` tells what the diagonal of L is: ones, where
//! the array holds D; or what the array holds. No call allocates. Cost of each, with D1 = Σ (d_k − 1): D1 multiply-adds, and with a stored
//! diagonal n products or n divisions.
//!
//! | | order | step at dof k, over its strict ancestors j |
//! |---|---|---|
//! | [`multiply`]: L x | from the leaves | `x_k = L_kk x_k + Σ_j L_kj x_j` |
//! | [`multiply_transposed`]: Lᵀ x | from the root | `x_j += L_kj x_k`, then `x_k = L_kk x_k` |
//! | [`solve`]: L x = b | from the root | `x_k = (x_k − Σ_j L_kj x_j) / L_kk` |
//! | [`solve_transposed`]: Lᵀ x = b | from the leaves | `x_k = x_k / L_kk`, then `x_j −= L_kj x_k` |
//!
//! Each order visits a dof before its number is overwritten for those that still need it.

use crate::TreeSparse;
use featherbench_spatial::Real;
use std::ops::Range;

/// x ← L x.
pub(crate) fn multiply<T: Real, const UNIT: bool>(factor: &TreeSparse<T>, x: &mut [T]) {
    for k in (0..x.len()).rev() {
        let row = &factor.values()[factor.row(k)];
        let mut sum = if UNIT { x[k] } else { row[row.len() - 1] * x[k] };
        for (dofs, entries) in factor.ancestors(k) {
            for (x_j, l) in x[dofs].iter().zip(&row[entries]) {
                sum = l.mul_add(*x_j, sum);
            }
        }
        x[k] = sum;
    }
}

/// x ← Lᵀ x.
pub(crate) fn multiply_transposed<T: Real, const UNIT: bool>(factor: &TreeSparse<T>, x: &mut [T]) {
    for k in 0..x.len() {
        let (x_k, row) = (x[k], &factor.values()[factor.row(k)]);
        for (dofs, entries) in factor.ancestors(k) {
            for (x_j, l) in x[dofs].iter_mut().zip(&row[entries]) {
                *x_j = l.mul_add(x_k, *x_j);
            }
        }
        if !UNIT {
            x[k] = row[row.len() - 1] * x_k;
        }
    }
}

/// Solves L x = b for the dofs of some trees.
#[inline(always)]
pub(crate) fn solve<T: Real, const UNIT: bool>(factor: &TreeSparse<T>, dofs: Range<usize>, x: &mut [T]) {
    for k in dofs {
        let (mut x_k, row) = (x[k], &factor.values()[factor.row(k)]);
        for (dofs, entries) in factor.ancestors(k) {
            for (x_j, l) in x[dofs].iter().zip(&row[entries]) {
                x_k = (-*l).mul_add(*x_j, x_k);
            }
        }
        x[k] = if UNIT { x_k } else { x_k / row[row.len() - 1] };
    }
}

/// Solves Lᵀ x = b.
#[inline(always)]
pub(crate) fn solve_transposed<T: Real, const UNIT: bool>(factor: &TreeSparse<T>, x: &mut [T]) {
    for k in (0..x.len()).rev() {
        let row = &factor.values()[factor.row(k)];
        if !UNIT {
            x[k] = x[k] / row[row.len() - 1];
        }
        let x_k = x[k];
        for (dofs, entries) in factor.ancestors(k) {
            for (x_j, l) in x[dofs].iter_mut().zip(&row[entries]) {
                *x_j = (-*l).mul_add(x_k, *x_j);
            }
        }
    }
}
