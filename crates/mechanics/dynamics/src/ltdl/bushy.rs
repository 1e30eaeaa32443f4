//! Factorization and solution for `f64` in a tree of short paths and many branches: a dof at a time.
//!
//! There nearly every block would be one row. All would wait for each other through what they share: rows of the matrix in the
//! factorization, and one path beside x in a solution. Here
//!
//! - in the factorization, each depth has sums of its own: the triangle S(s) is what the dofs below subtract from the rows of s ancestors.
//!   `H_k = M_k + S(s + 1)_s`, `L_k = H_k / D_k`, and `S(s)_i += S(s + 1)_i − L_ki H_k`. The last child of a dof, which comes first, writes S(s)
//!   in place of adding to it, so nothing is cleared.
//! - from the leaves, each depth has sums of its own, in one to four registers: `sums[s]` is what the dofs below subtract from each of s
//!   ancestors. `y_k = b_k + sums[s + 1][s]`, and `sums[s] += sums[s + 1] − L_k y_k`. Siblings go on while a dof waits for its descendants.
//! - from the root, the path is single numbers, and `x_k = y_k / D_k − Σ_j L_kj x_j` ends with the parent, whose x is known last. A dof waits for
//!   one multiply-subtract of its own.
//!
//! Where no path is longer than five dofs, a factorization is the book's text on single numbers, with one division per dof.
//!
//! A factorization takes a multiply-subtract, an addition and a store per dof and ancestor. What bounds both: `docs/kernels/ltdl.md`.

use super::registers::{LANES, load, store, subtract};
use crate::TreeSparse;
use crate::error::Pivot;
use crate::tree_sparse::Row;
use featherbench_spatial::Real;
use std::ops::Range;
use wide::f64x8;

/// The longest path.
pub(super) const LONGEST: usize = 4 * LANES;

/// The longest path of a factorization.
pub(super) const DEEPEST: usize = 2 * LANES;
/// The most dofs of a factorization. Threads would gain nothing on so few: so [`ParallelLtdl`](crate::ParallelLtdl) has the same bits by leaving
/// such trees to one thread.
pub(super) const MOST: usize = 1024;
/// Where no path is longer, a factorization takes a number at a time: registers would be nearly empty.
const SHORT: usize = 5;

/// Factors the matrix, where no path is longer than `deepest`, which is at most [`DEEPEST`]. `factors` has the length of the matrix's
/// numbers, and a register more.
pub(super) fn factor(matrix: &mut TreeSparse<f64>, deepest: usize, factors: &mut [f64]) -> Pivot {
    let end = matrix.values().len();
    let (rows, values) = matrix.parts_mut();
    if deepest <= SHORT {
        return eliminate_numbers(rows, values, end);
    }
    let smallest = if deepest <= LANES {
        eliminate::<1, { LANES * (LANES + 1) / 2 }>(rows, values, end, factors)
    } else {
        eliminate::<2, { DEEPEST * (DEEPEST + 1) / 2 }>(rows, values, end, factors)
    };
    values[..end].copy_from_slice(&factors[..end]);
    smallest
}

/// The book's text, with one division per dof.
#[inline(never)]
fn eliminate_numbers(rows: &[Row], values: &mut [f64], mut end: usize) -> Pivot {
    let mut smallest = Pivot::none();
    for (k, row) in rows.iter().enumerate().rev() {
        let (above, h) = values[..end].split_at_mut(row.start);
        end = row.start;
        let Some((d, h)) = h.split_last_mut() else { break };
        if !is_positive(*d) {
            smallest.note(k, *d);
        }
        let (reciprocal, mut ancestor) = (1.0 / *d, row.parent);
        for p in (0..h.len()).rev() {
            let Some(i) = ancestor else { break };
            let l = h[p] * reciprocal;
            for (h_i, h_k) in above[rows[i].start..][..=p].iter_mut().zip(&h[..=p]) {
                *h_i = Real::mul_add(-l, *h_k, *h_i);
            }
            h[p] = l;
            ancestor = rows[i].parent;
        }
    }
    smallest
}

/// The factors are written apart: a load of a row reads what follows the row too, and would wait for it to be stored.
#[inline(never)]
fn eliminate<const REGISTERS: usize, const SUMS: usize>(rows: &[Row], values: &[f64], mut end: usize, factors: &mut [f64]) -> Pivot {
    let mut sums = [[f64x8::ZERO; REGISTERS]; SUMS];
    let mut smallest = Pivot::none();
    for k in (0..rows.len()).rev() {
        let (start, shared) = (rows[k].start, end - rows[k].start - 1);
        let mut h: [f64x8; REGISTERS] = load_row(values, start, end);
        let mut d = values[start + shared];
        end = start;
        let (above, below) = sums[shared * shared.saturating_sub(1) / 2..].split_at_mut(shared);
        let leaf = rows[k].end == k + 1;
        if !leaf {
            let of_k = &below[shared];
            for (h, sum) in h.iter_mut().zip(of_k) {
                *h += *sum;
            }
            d += of_k[shared / LANES].as_array()[shared % LANES];
        }
        if !is_positive(d) {
            smallest.note(k, d);
        }
        factors[start + shared] = d;
        let Some(parent) = rows[k].parent else { continue };
        let reciprocal = f64x8::splat(1.0 / d);
        let l = h.map(|h| (h * reciprocal).to_array());
        for (register, l) in l.iter().enumerate() {
            if register == 0 || shared > register * LANES {
                store(factors, start + register * LANES, f64x8::new(*l), shared - register * LANES);
            }
        }
        let l = l.as_flattened();
        match (leaf, rows[k].end == rows[parent].end) {
            (true, true) => pass_on(above, l, &h, |_, _, _| f64x8::ZERO),
            (true, false) => pass_on(above, l, &h, |sum, _, _| sum),
            (false, true) => pass_on(above, l, &h, |_, i, register| below[i][register]),
            (false, false) => pass_on(above, l, &h, |sum, i, register| sum + below[i][register]),
        }
    }
    smallest
}

/// The registers with the numbers of a row; what follows the row is in them too.
#[inline(always)]
fn load_row<const REGISTERS: usize>(values: &[f64], start: usize, end: usize) -> [f64x8; REGISTERS] {
    std::array::from_fn(|register| {
        let at = start + register * LANES;
        if register == 0 || at < end { load(values, at) } else { f64x8::ZERO }
    })
}

/// `S_i = before − L_ki H_k` for each ancestor i, in the columns up to i.
#[inline(always)]
fn pass_on<const REGISTERS: usize>(
    above: &mut [[f64x8; REGISTERS]],
    l: &[f64],
    h: &[f64x8; REGISTERS],
    before: impl Fn(f64x8, usize, usize) -> f64x8,
) {
    for (i, (sums, l)) in above.iter_mut().zip(l).enumerate() {
        for (register, (sum, h)) in sums.iter_mut().zip(h).enumerate() {
            if register == 0 || i >= register * LANES {
                *sum = subtract(before(*sum, i, register), *l, *h);
            }
        }
    }
}

/// False for NaN.
#[inline(always)]
fn is_positive(pivot: f64) -> bool {
    pivot > 0.0
}

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
