//! The solution for `f64` in a tree of short paths and many branches: a dof at a time.
//!
//! There nearly every block would be one row, and all would wait for each other through the one path that is kept beside x. Here
//!
//! - from the leaves, each depth has sums of its own, in one to four registers: `sums[s]` is what the dofs below subtract from each of s
//!   ancestors. `y_k = b_k + sums[s + 1][s]`, and `sums[s] += sums[s + 1] − L_k y_k`. Siblings go on while a dof waits for its descendants.
//! - from the root, the path is single numbers, and `x_k = y_k / D_k − Σ_j L_kj x_j` ends with the parent, whose x is known last. A dof waits for
//!   one multiply-subtract of its own.
//!
//! What bounds it: latency, some ten cycles per depth and way, and the reading of L.

use super::registers::{LANES, load, subtract};
use crate::TreeSparse;
use featherbench_spatial::Real;
use std::ops::Range;
use wide::f64x8;

/// The longest path.
pub(super) const LONGEST: usize = 4 * LANES;

/// Solves `Lᵀ y = b` in place, where no path is longer than `deepest`.
pub(super) fn from_leaves(matrix: &TreeSparse<f64>, deepest: usize, x: &mut [f64]) {
    match deepest.div_ceil(LANES) {
        0 | 1 => rise::<1, { LANES + 1 }>(matrix, x),
        2 => rise::<2, { 2 * LANES + 1 }>(matrix, x),
        _ => rise::<4, { LONGEST + 1 }>(matrix, x),
    }
}

#[inline(never)]
fn rise<const REGISTERS: usize, const DEPTHS: usize>(matrix: &TreeSparse<f64>, x: &mut [f64]) {
    let (rows, values) = matrix.parts();
    let mut sums = [[f64x8::ZERO; REGISTERS]; DEPTHS];
    let mut end = matrix.values().len();
    for (row, x_k) in rows.iter().zip(x).rev() {
        let ancestors = end - row.start - 1;
        end = row.start;
        let [above, below] = &mut sums[ancestors..][..2] else { break };
        *x_k += below[ancestors / LANES].as_array()[ancestors % LANES];
        for (register, (sum, below)) in above.iter_mut().zip(&*below).take(ancestors.div_ceil(LANES)).enumerate() {
            *sum += subtract(*below, *x_k, load(values, row.start + register * LANES));
        }
        below.fill(f64x8::ZERO);
    }
}

/// D z = y, if it `DIVIDES`, and L x = z, in place.
#[inline(never)]
pub(super) fn from_root<const DIVIDES: bool>(matrix: &TreeSparse<f64>, dofs: Range<usize>, x: &mut [f64]) {
    let (rows, values) = matrix.parts();
    let mut path = [0.0; LONGEST];
    for k in dofs {
        let row = &values[matrix.row(k)];
        let (d, row) = row.split_last().expect("a row");
        let mut x_k = if DIVIDES { x[k] / d } else { x[k] };
        for (l, x_j) in row.iter().zip(&path) {
            x_k = Real::mul_add(-*l, *x_j, x_k);
        }
        x[k] = x_k;
        if k + 1 < rows[k].end {
            path[row.len()] = x_k;
        }
    }
}
