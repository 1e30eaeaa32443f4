//! The factorization and the solution for registers of states and for `f32`: blocks of up to four rows.
//!
//! The text is that of any scalar. Four consecutive dofs, each the parent of the next, share the ancestors of the first, and change an
//! ancestor's row in one pass over it. The operations on each number of the factors keep the order of the plain text. Only quotients are
//! products with 1/D, as in `factor.rs`: an L can be off by one more unit in the last place. Times beside the plain text: `docs/kernels/ltdl.md`.

use super::Plan;
use crate::TreeSparse;
use crate::error::Pivot;
use crate::tree_sparse::BLOCK;
use featherbench_spatial::Real;
use std::ops::Range;

// The arms of `by_block`.
const _: () = assert!(BLOCK == 4);

/// Calls a function with the size of the block, 1 … [`BLOCK`], as a constant.
macro_rules! by_block {
    ($size:expr, $function:ident($($argument:expr),+)) => {
        match $size {
            1 => $function::<T, 1>($($argument),+),
            2 => $function::<T, 2>($($argument),+),
            3 => $function::<T, 3>($($argument),+),
            _ => $function::<T, BLOCK>($($argument),+),
        }
    };
}

/// Factors the matrix.
#[inline(always)]
pub(super) fn factor<T: Real>(matrix: &mut TreeSparse<T>, _: &Plan, _: &mut [T]) -> Pivot {
    let mut smallest = Pivot::none();
    let mut end = matrix.size();
    while end > 0 {
        let size = matrix.block_before(end);
        end -= size;
        by_block!(size, eliminate_block(matrix, end, &mut smallest));
    }
    smallest
}

/// Solves `LᵀDL x = b` in place.
#[inline(always)]
pub(super) fn solve<T: Real>(matrix: &TreeSparse<T>, plan: &Plan, x: &mut [T]) {
    solve_lower_transposed(matrix, plan, x);
    // D z = y
    for (x, d) in x.iter_mut().zip(matrix.diagonal()) {
        *x = *x / d;
    }
    solve_lower(matrix, plan, 0..x.len(), x);
}

/// Solves `Lᵀ x = b` in place, from the leaves.
#[inline(always)]
pub(super) fn solve_lower_transposed<T: Real>(matrix: &TreeSparse<T>, _: &Plan, x: &mut [T]) {
    let mut end = matrix.size();
    while end > 0 {
        let size = matrix.block_before(end);
        end -= size;
        by_block!(size, subtract_from_ancestors(matrix, end, x));
    }
}

/// Solves `L x = b` in place for the dofs of some trees, from the root.
#[inline(always)]
pub(super) fn solve_lower<T: Real>(matrix: &TreeSparse<T>, _: &Plan, dofs: Range<usize>, x: &mut [T]) {
    let mut first = dofs.start;
    while first < dofs.end {
        let size = matrix.block_from(first);
        by_block!(size, subtract_ancestors(matrix, first, x));
        first += size;
    }
}

/// `L_ki = H_ki D_k⁻¹,  H_i· −= L_ki H_k·` for every dof k of a block, the last first, and every strict ancestor i of k.
#[inline(always)]
fn eliminate_block<T: Real, const SIZE: usize>(matrix: &mut TreeSparse<T>, first: usize, smallest: &mut Pivot) {
    let shared = matrix.depth(first) - 1;
    let (places, values) = matrix.parts_mut();
    let (above, rows) = values.split_at_mut(places[first].start);
    let mut rows = split_rows::<T, SIZE>(rows, shared);

    // ancestors in the block
    let mut reciprocals = [T::zero(); SIZE];
    for k in (0..SIZE).rev() {
        let (before, rest) = rows.split_at_mut(k);
        let h_k = &mut *rest[0];
        let d = h_k[shared + k];
        smallest.note(first + k, d.min_lane());
        reciprocals[k] = T::one() / d;
        for (i, h_i) in before.iter_mut().enumerate().rev() {
            let l = h_k[shared + i] * reciprocals[k];
            for (h_i, h_k) in h_i.iter_mut().zip(h_k.iter()) {
                *h_i = (-l).mul_add(*h_k, *h_i);
            }
            h_k[shared + i] = l;
        }
    }
    // ancestors of the block, at position p of each of its rows
    let mut ancestor = places[first].parent;
    for p in (0..shared).rev() {
        let Some(i) = ancestor else { break };
        let l: [T; SIZE] = std::array::from_fn(|k| rows[k][p] * reciprocals[k]);
        let h_i = &mut above[places[i].start..][..=p];
        let h: [&[T]; SIZE] = rows.each_ref().map(|row| &row[..h_i.len()]);
        for j in 0..h_i.len() {
            for k in (0..SIZE).rev() {
                h_i[j] = (-l[k]).mul_add(h[k][j], h_i[j]);
            }
        }
        for (row, l) in rows.iter_mut().zip(l) {
            row[p] = l;
        }
        ancestor = places[i].parent;
    }
}

/// `x_j −= L_kj x_k` for every dof k of a block, the last first, and every strict ancestor j of k.
#[inline(always)]
fn subtract_from_ancestors<T: Real, const SIZE: usize>(matrix: &TreeSparse<T>, first: usize, x: &mut [T]) {
    let (shared, rows) = rows::<T, SIZE>(matrix, first);
    let mut x_k = [T::zero(); SIZE];
    for k in (0..SIZE).rev() {
        x_k[k] = -x[first + k];
        for (x_j, l) in x[first..first + k].iter_mut().zip(&rows[k][shared..]) {
            *x_j = l.mul_add(x_k[k], *x_j);
        }
    }
    for (dofs, entries) in matrix.ancestors(first) {
        let x_j = &mut x[dofs];
        let l: [&[T]; SIZE] = rows.map(|row| &row[entries.start..][..x_j.len()]);
        for j in 0..x_j.len() {
            for k in (0..SIZE).rev() {
                x_j[j] = l[k][j].mul_add(x_k[k], x_j[j]);
            }
        }
    }
}

/// `x_k −= L_kj x_j` for every dof k of a block, the first first, and every strict ancestor j of k.
#[inline(always)]
fn subtract_ancestors<T: Real, const SIZE: usize>(matrix: &TreeSparse<T>, first: usize, x: &mut [T]) {
    let (shared, rows) = rows::<T, SIZE>(matrix, first);
    let mut x_k: [T; SIZE] = std::array::from_fn(|k| x[first + k]);
    for (dofs, entries) in matrix.ancestors(first) {
        let x_j = &x[dofs];
        let l: [&[T]; SIZE] = rows.map(|row| &row[entries.start..][..x_j.len()]);
        for j in 0..x_j.len() {
            for k in 0..SIZE {
                x_k[k] = (-l[k][j]).mul_add(x_j[j], x_k[k]);
            }
        }
    }
    for k in 0..SIZE {
        for j in 0..k {
            x_k[k] = (-rows[k][shared + j]).mul_add(x_k[j], x_k[k]);
        }
    }
    x[first..first + SIZE].copy_from_slice(&x_k);
}

/// The rows of a block, and how many strict ancestors its first dof has.
#[inline(always)]
fn rows<T: Real, const SIZE: usize>(matrix: &TreeSparse<T>, first: usize) -> (usize, [&[T]; SIZE]) {
    let rows = std::array::from_fn(|k| &matrix.values()[matrix.row(first + k)]);
    (matrix.depth(first) - 1, rows)
}

/// The rows of a block at the beginning of a slice. Row k of the block has `shared` + k + 1 entries; its first dof has `shared` strict
/// ancestors.
#[inline(always)]
fn split_rows<T, const SIZE: usize>(mut values: &mut [T], shared: usize) -> [&mut [T]; SIZE] {
    std::array::from_fn(|k| {
        let (row, rest) = std::mem::take(&mut values).split_at_mut(shared + k + 1);
        values = rest;
        row
    })
}
