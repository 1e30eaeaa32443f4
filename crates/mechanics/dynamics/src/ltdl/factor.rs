//! The factorization for `f64`: up to eight rows in eight columns at a time are in registers.
//!
//! It is *left-looking*: a block of rows collects from all rows below it what they subtract, and is then divided. The rows below are
//! consecutive, and so are their first columns, those of the common ancestors. The order of the terms is the book's, the leaves first; two
//! sums take them in turn where the block has four rows or fewer.
//!
//! Accuracy: a row is multiplied by 1/D in place of being divided by D. Two numbers are rounded in place of one: an L can be off by one more
//! unit in the last place. The products L D L are formed from the rounded L, and LᵀDL reproduces M to 1e-16 of its norm in the tests. Errors of
//! M⁻¹ with and without divisions: `docs/kernels/ltdl.md`.
//!
//! For speed (`docs/kernels/ltdl.md`):
//!
//! - No function call for the last, incomplete register: the matrix has padding.
//! - No load that overlaps a narrower store shortly after it.
//! - Masks only on registers that are incomplete.

use super::blocks::{Block, Plan, by_size, down, starts, up};
use super::bushy;
use super::registers::{LANES, load, store, subtract};
use crate::TreeSparse;
use crate::error::Pivot;
use crate::tree_sparse::Row;
use featherbench_spatial::Real;
use std::ops::Range;
use wide::f64x8;

/// Factors the matrix. `coefficients` has [`Plan::scratch`] numbers.
pub(super) fn factor(matrix: &mut TreeSparse<f64>, plan: &Plan, coefficients: &mut [f64]) -> Pivot {
    if plan.single.factor {
        return bushy::factor(matrix, plan.deepest, coefficients);
    }
    let (rows, values) = matrix.parts_mut();
    factor_blocks(rows, values, &plan.blocks, coefficients.as_chunks_mut().0)
}

/// Factors the rows of these blocks. All rows below them stand in `values` too, factored or in the list. `coefficients` has an entry per row.
pub(crate) fn factor_blocks(rows: &[Row], values: &mut [f64], blocks: &[Block], coefficients: &mut [[f64; LANES]]) -> Pivot {
    let mut smallest = Pivot::none();
    for block in blocks.iter().rev() {
        if block.alone() {
            let d = values[rows[block.first].start];
            if !is_positive(d) {
                smallest.note(block.first, d);
            }
        } else if block.size == 1 {
            eliminate_one(rows, values, block, coefficients, &mut smallest);
        } else {
            by_size!(block.size, eliminate(rows, values, block, coefficients, &mut smallest));
        }
    }
    smallest
}

/// A block of one row. Its pivot is computed with the columns of the nearest ancestors.
#[inline(always)]
fn eliminate_one(rows: &[Row], values: &mut [f64], block: &Block, coefficients: &mut [[f64; LANES]], smallest: &mut Pivot) {
    let (shared, start) = (block.shared, rows[block.first].start);
    let below = &rows[block.first + 1..block.end];
    let coefficients = &mut coefficients[..below.len()];

    let mut d = values[start + shared];
    let nearest = shared.saturating_sub(LANES);
    let (mut sum, mut other) = (load(values, start + nearest), f64x8::ZERO);
    let mut end = block.stored_end;
    for (row, coefficients) in below.iter().zip(coefficients.iter_mut()).rev() {
        let l = values[row.start + shared];
        let coefficient = l * values[end - 1];
        coefficients[0] = coefficient;
        d = Real::mul_add(-coefficient, l, d);
        (sum, other) = (other, subtract(sum, coefficient, load(values, row.start + nearest)));
        end = row.start;
    }
    sum += other;
    if !is_positive(d) {
        smallest.note(block.first, d);
    }
    values[start + shared] = d;
    if shared == 0 {
        return;
    }
    let reciprocal = f64x8::splat(1.0 / d);
    // A register is stored when the next one is loaded: a load that overlaps a store waits for it.
    let mut end = nearest;
    let (mut done, mut column) = (sum * reciprocal, nearest);
    while end > 0 {
        let next = end.saturating_sub(LANES);
        let (mut sum, mut other) = (load(values, start + next), f64x8::ZERO);
        for (row, coefficients) in below.iter().zip(coefficients.iter()).rev() {
            (sum, other) = (other, subtract(sum, coefficients[0], load(values, row.start + next)));
        }
        store(values, start + column, done, LANES);
        (done, column) = ((sum + other) * reciprocal, next);
        end = next;
    }
    store(values, start + column, done, if column == nearest { shared - nearest } else { 1 + (nearest - 1) % LANES });
}

/// Rows a of a block: `H_aj = M_aj − Σ_k (L_ka D_k) L_kj` for k below the block and in it, then `L_aj = H_aj / D_a`.
///
/// The parts are functions of their own: the numbers between them pass through memory, where a multiplication reads them best.
#[inline(never)]
fn eliminate<const SIZE: usize>(rows: &[Row], values: &mut [f64], block: &Block, coefficients: &mut [[f64; LANES]], smallest: &mut Pivot) {
    let shared = block.shared;
    let starts: [usize; SIZE] = starts(rows, block);
    let below = block.first + SIZE..block.end;
    let below_rows = &rows[below.clone()];
    let coefficients = &mut coefficients[below];

    let (mut l, mut reciprocals) = ([[0.0; LANES]; SIZE], [0.0; SIZE]);
    // The first columns of the ancestors, which do not fill a register, are loaded before the triangle is stored: a load that overlaps a
    // narrower store waits for its end.
    let partial = shared % LANES;
    let mut sums = [f64x8::ZERO; SIZE];
    if below_rows.is_empty() {
        if partial > 0 {
            sums = subtract_below(values, &starts, 0, below_rows, coefficients);
        }
        eliminate_triangle::<SIZE, true>(values, &starts, shared, block.first, &mut l, &mut reciprocals, smallest);
    } else {
        // L_ka D_k for the rows k below
        let mut end = block.stored_end;
        for (row, coefficients) in below_rows.iter().zip(coefficients.iter_mut()).rev() {
            *coefficients = (load(values, row.start + shared) * f64x8::splat(values[end - 1])).to_array();
            end = row.start;
        }
        // the triangle on the diagonal: columns of the block
        let triangle: [f64x8; SIZE] = subtract_below(values, &starts, shared, below_rows, coefficients);
        for a in 0..SIZE {
            l[a] = triangle[a].to_array();
        }
        if partial > 0 {
            sums = subtract_below(values, &starts, 0, below_rows, coefficients);
        }
        eliminate_triangle::<SIZE, false>(values, &starts, shared, block.first, &mut l, &mut reciprocals, smallest);
    }
    // the columns of the ancestors
    if partial > 0 {
        finish_columns(values, &starts, 0..partial, sums, &l, &reciprocals);
    }
    for column in (partial..shared).step_by(LANES).rev() {
        eliminate_columns(values, &starts, column, below_rows, coefficients, &l, &reciprocals);
    }
}

/// The triangle h on the diagonal: `L_ki = H_ki / D_k`, `H_ij −= L_ki H_kj`. It gives L below its diagonal.
#[inline(never)]
fn eliminate_triangle<const SIZE: usize, const LEAF: bool>(
    values: &mut [f64],
    starts: &[usize; SIZE],
    shared: usize,
    first: usize,
    l: &mut [[f64; LANES]; SIZE],
    reciprocals: &mut [f64; SIZE],
    smallest: &mut Pivot,
) {
    let mut h = *l;
    if LEAF {
        up!(a < SIZE {
            let row: &[f64; a + 1] = values[starts[a] + shared..].first_chunk().expect("a row");
            h[a][..a + 1].copy_from_slice(row);
        });
    }
    down!(k < SIZE {
        let d = h[k][k];
        if !is_positive(d) {
            smallest.note(first + k, d);
        }
        let row = &mut values[starts[k] + shared..][..k + 1];
        row[k] = d;
        reciprocals[k] = 1.0 / d;
        down!(i < k {
            let l_ki = h[k][i] * reciprocals[k];
            (row[i], l[k][i]) = (l_ki, l_ki);
            up!(j <= i {
                h[i][j] = Real::mul_add(-l_ki, h[k][j], h[i][j]);
            });
        });
    });
}

/// False for NaN.
#[inline(always)]
fn is_positive(pivot: f64) -> bool {
    pivot > 0.0
}

/// Eight columns of ancestors: the same for each column j.
#[inline(never)]
fn eliminate_columns<const SIZE: usize>(
    values: &mut [f64],
    starts: &[usize; SIZE],
    column: usize,
    below: &[Row],
    coefficients: &[[f64; LANES]],
    l: &[[f64; LANES]; SIZE],
    reciprocals: &[f64; SIZE],
) {
    let sums: [f64x8; SIZE] = subtract_below(values, starts, column, below, coefficients);
    finish_columns(values, starts, column..column + LANES, sums, l, reciprocals);
}

/// `H_ij −= L_ki H_kj` for k in the block, and `L_kj = H_kj / D_k`.
#[inline(always)]
fn finish_columns<const SIZE: usize>(
    values: &mut [f64],
    starts: &[usize; SIZE],
    columns: Range<usize>,
    mut h: [f64x8; SIZE],
    l: &[[f64; LANES]; SIZE],
    reciprocals: &[f64; SIZE],
) {
    down!(k < SIZE {
        up!(i < k {
            h[i] = subtract(h[i], l[k][i], h[k]);
        });
    });
    for a in 0..SIZE {
        store(values, starts[a] + columns.start, h[a] * f64x8::splat(reciprocals[a]), columns.len());
    }
}

/// `M_aj − Σ_k (L_ka D_k) L_kj` for the rows a of a block, eight columns j and the rows k below, the last first.
#[inline(always)]
fn subtract_below<const SIZE: usize>(
    values: &[f64],
    starts: &[usize; SIZE],
    column: usize,
    below: &[Row],
    coefficients: &[[f64; LANES]],
) -> [f64x8; SIZE] {
    let mut sums = [f64x8::ZERO; SIZE];
    for a in 0..SIZE {
        sums[a] = load(values, starts[a] + column);
    }
    let mut rows = below.iter().zip(coefficients).rev();
    if SIZE <= 4 {
        // A second set of sums: additions to one wait for each other.
        let mut others = [f64x8::ZERO; SIZE];
        while let Some((row, coefficients)) = rows.next() {
            let l = load(values, row.start + column);
            for a in 0..SIZE {
                others[a] = subtract(others[a], coefficients[a], l);
            }
            let Some((row, coefficients)) = rows.next() else { break };
            let l = load(values, row.start + column);
            for a in 0..SIZE {
                sums[a] = subtract(sums[a], coefficients[a], l);
            }
        }
        for a in 0..SIZE {
            sums[a] += others[a];
        }
    } else {
        for (row, coefficients) in rows {
            let l = load(values, row.start + column);
            for a in 0..SIZE {
                sums[a] = subtract(sums[a], coefficients[a], l);
            }
        }
    }
    sums
}
