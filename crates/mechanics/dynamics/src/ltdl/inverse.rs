//! The inverse and the selected inverse for `f64`: a block of rows at a time, eight columns to a register.
//!
//! Only the triangle below the diagonal is computed, and the entries above it that later rows need. The rest is copied at the end, in
//! squares that are transposed in registers, which is faster than scalar copies (`docs/kernels/ltdl.md`).

use super::blocks::{Block, Plan, starts, triangle, up};
use super::registers::{LANES, load, store, subtract};
use crate::TreeSparse;
use featherbench_spatial::Real;
use std::ops::Range;
use wide::{f64x4, f64x8};

/// Writes the inverse X, row after row.
pub(super) fn inverse(matrix: &TreeSparse<f64>, plan: &Plan, inverse: &mut [f64]) {
    if !plan.inverse_fits() {
        return super::invert(matrix, inverse);
    }
    for block in &plan.blocks {
        rows_of_block::<false>(matrix, block, inverse, matrix.size());
    }
    mirror(matrix.size(), inverse);
}

/// Writes the selected inverse. `square` has no meaning before or afterwards; it grows where it is too small.
///
/// In the square stands X of the path to the dofs of a block: row and column p belong to the ancestor at position p. A later block has the
/// beginning of that path in common.
pub(super) fn select(matrix: &TreeSparse<f64>, plan: &Plan, square: &mut Vec<f64>, inverse: &mut TreeSparse<f64>) {
    // A register that is loaded from a row ends before the next one.
    let width = plan.deepest + LANES;
    square.resize(plan.deepest * width, 0.0);
    for block in &plan.blocks {
        rows_of_block::<true>(matrix, block, square, width);
        for a in 0..block.size {
            let row = inverse.row(block.first + a);
            let length = row.len();
            inverse.values_mut()[row].copy_from_slice(&square[(block.shared + a) * width..][..length]);
        }
    }
}

/// The rows of a block of the inverse, or of the square of its `SELECTED` entries. A row has `n` numbers.
#[inline(always)]
fn rows_of_block<const SELECTED: bool>(matrix: &TreeSparse<f64>, block: &Block, inverse: &mut [f64], n: usize) {
    // Rows and registers for each: about eight sums, so that additions do not wait for each other.
    match block.size {
        1 => rows_of_inverse::<1, 8, SELECTED>(matrix, block, inverse, n),
        2 => rows_of_inverse::<2, 4, SELECTED>(matrix, block, inverse, n),
        3 => rows_of_inverse::<3, 2, SELECTED>(matrix, block, inverse, n),
        4 => rows_of_inverse::<4, 2, SELECTED>(matrix, block, inverse, n),
        5 => rows_of_inverse::<5, 1, SELECTED>(matrix, block, inverse, n),
        6 => rows_of_inverse::<6, 1, SELECTED>(matrix, block, inverse, n),
        7 => rows_of_inverse::<7, 1, SELECTED>(matrix, block, inverse, n),
        _ => rows_of_inverse::<8, 1, SELECTED>(matrix, block, inverse, n),
    }
}

/// Where ancestors stand in the array: by their dofs, or by their positions on the path.
#[inline(always)]
fn places<const SELECTED: bool>(dofs: &Range<usize>, entries: &Range<usize>) -> Range<usize> {
    if SELECTED { entries.clone() } else { dofs.clone() }
}

/// The rows of a block up to the diagonal, and the block's columns in the rows of its ancestors.
///
/// Later rows need X above the diagonal only there: a column c between an ancestor j and a row i is a dof that j supports.
#[inline(never)]
fn rows_of_inverse<const SIZE: usize, const WIDE: usize, const SELECTED: bool>(
    matrix: &TreeSparse<f64>,
    block: &Block,
    inverse: &mut [f64],
    n: usize,
) {
    let (rows, values) = matrix.parts();
    let shared = block.shared;
    let begin = if SELECTED { shared } else { block.first };
    let starts: [usize; SIZE] = starts(rows, block);
    let l = triangle(values, &starts, shared);
    let factors = Rows { matrix, block, starts };

    // X_kc = −Σ_j L_kj X_jc for columns c left of the block
    let mut column = 0;
    if shared == 0 && begin > 0 {
        // Another tree begins.
        for a in 0..SIZE {
            inverse[(begin + a) * n..][..begin].fill(0.0);
        }
        column = begin;
    }
    while column + WIDE * LANES <= begin {
        columns::<SIZE, WIDE, SELECTED>(&factors, &l, inverse, n, column, LANES);
        column += WIDE * LANES;
    }
    while column < begin {
        columns::<SIZE, 1, SELECTED>(&factors, &l, inverse, n, column, LANES.min(begin - column));
        column += LANES;
    }
    // X_jk = X_kj for ancestors j of the block
    for (dofs, entries) in matrix.ancestors(block.first) {
        for j in places::<SELECTED>(&dofs, &entries) {
            let column: [f64; SIZE] = std::array::from_fn(|a| inverse[(begin + a) * n + j]);
            inverse[j * n + begin..][..SIZE].copy_from_slice(&column);
        }
    }
    // the block itself: X_ks = [k = s] / D_k − Σ_j L_kj X_js for s ≤ k
    let sums: [[f64x8; 1]; SIZE] = sums::<SIZE, 1, SELECTED>(&factors, inverse, n, begin);
    let mut x = sums.map(|[sum]| sum.to_array());
    up!(k < SIZE {
        x[k][k] += 1.0 / l[k][k];
        up!(s <= k {
            up!(t < k {
                x[k][s] = Real::mul_add(-l[k][t], x[t][s], x[k][s]);
            });
            x[s][k] = x[k][s];
        });
    });
    for a in 0..SIZE {
        inverse[(begin + a) * n + begin..][..SIZE].copy_from_slice(&x[a][..SIZE]);
    }
}

/// A block's rows of the factors, and where they begin.
struct Rows<'a, const SIZE: usize> {
    matrix: &'a TreeSparse<f64>,
    block: &'a Block,
    starts: [usize; SIZE],
}

/// The rows of a block in some registers of columns, of which the last is written in `count` lanes.
#[inline(always)]
fn columns<const SIZE: usize, const WIDE: usize, const SELECTED: bool>(
    factors: &Rows<'_, SIZE>,
    l: &[[f64; LANES]; SIZE],
    inverse: &mut [f64],
    n: usize,
    column: usize,
    count: usize,
) {
    let mut x: [[f64x8; WIDE]; SIZE] = sums::<SIZE, WIDE, SELECTED>(factors, inverse, n, column);
    let begin = if SELECTED { factors.block.shared } else { factors.block.first };
    up!(k < SIZE {
        up!(j < k {
            let (above, rest) = x.split_at_mut(k);
            for (x_k, x_j) in rest[0].iter_mut().zip(above[j]) {
                *x_k = subtract(*x_k, l[k][j], x_j);
            }
        });
    });
    for (a, x) in x.into_iter().enumerate() {
        for (w, x) in x.into_iter().enumerate() {
            let place = (begin + a) * n + column + w * LANES;
            if place + LANES <= inverse.len() {
                store(inverse, place, x, count);
            } else {
                // The last row ends with the array.
                for (out, x) in inverse[place..].iter_mut().zip(x.to_array()).take(count) {
                    *out = x;
                }
            }
        }
    }
}

/// `−Σ_j L_kj X_jc` over the strict ancestors j of a block, for its dofs k and some registers of columns c.
#[inline(always)]
fn sums<const SIZE: usize, const WIDE: usize, const SELECTED: bool>(
    factors: &Rows<'_, SIZE>,
    inverse: &[f64],
    n: usize,
    column: usize,
) -> [[f64x8; WIDE]; SIZE] {
    let Rows { matrix, block, starts } = factors;
    let values = matrix.values();
    let mut sums = [[f64x8::ZERO; WIDE]; SIZE];
    for (dofs, entries) in matrix.ancestors(block.first) {
        let places = places::<SELECTED>(&dofs, &entries);
        let mut l = [&values[..0]; SIZE];
        for a in 0..SIZE {
            l[a] = &values[starts[a] + entries.start..][..dofs.len()];
        }
        for p in 0..dofs.len() {
            let row = &inverse[(places.start + p) * n + column..][..WIDE * LANES];
            for (a, sums) in sums.iter_mut().enumerate() {
                for (w, sum) in sums.iter_mut().enumerate() {
                    *sum = subtract(*sum, l[a][p], load(row, w * LANES));
                }
            }
        }
    }
    sums
}

/// Rows and columns of a square that is transposed in registers.
const SQUARE: usize = 4;

/// Copies the triangle below the diagonal to the one above it.
fn mirror(n: usize, inverse: &mut [f64]) {
    for i in (0..n).step_by(SQUARE) {
        let whole = if i + SQUARE <= n { i } else { 0 };
        for j in (0..whole).step_by(SQUARE) {
            let mut square = [f64x4::ZERO; SQUARE];
            for a in 0..SQUARE {
                square[a] = f64x4::new(*inverse[(i + a) * n + j..].first_chunk().expect("a row of the square"));
            }
            for (b, column) in f64x4::transpose(square).into_iter().enumerate() {
                inverse[(j + b) * n + i..][..SQUARE].copy_from_slice(column.as_array());
            }
        }
        for i in i..(i + SQUARE).min(n) {
            for j in whole..i {
                inverse[j * n + i] = inverse[i * n + j];
            }
        }
    }
}
