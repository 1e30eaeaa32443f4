//! The solution for `f64`: a block of rows at a time, eight columns to a register.
//!
//! In depth-first order the path to a block is that to the block before it, cut. So the numbers that belong to the path are kept
//! consecutively beside x, and a tree is solved like a chain. It is read and written in whole registers at multiples of eight: a load that
//! overlaps a narrower store shortly after it waits for the store to end (`docs/kernels/ltdl.md`).

use super::blocks::{Block, Plan, by_size, down, starts, triangle, up};
use super::bushy;
use super::registers::{LANES, first, load, only, store, subtract};
use crate::tree_sparse::Row;
use crate::{TreeSparse, triangular};
use featherbench_spatial::Real;
use std::ops::Range;
use wide::f64x8;

/// The longest path that a solution keeps beside x.
const LONGEST: usize = 1024;
/// No longer path is kept in most robots: clearing it costs less.
const USUAL: usize = 48;

/// Solves `LᵀDL x = b` in place. The plain text does it where a path is longer than [`LONGEST`].
pub(super) fn solve(matrix: &TreeSparse<f64>, plan: &Plan, x: &mut [f64]) {
    if let [block] = plan.blocks[..] {
        by_size!(block.size, solve_run(matrix.values(), x));
        return;
    }
    if plan.deepest == 1 {
        // Only D.
        x.iter_mut().zip(matrix.values()).for_each(|(x, d)| *x /= d);
        return;
    }
    let by_path = |x: &mut [f64], path: &mut [f64]| {
        if plan.single.from_leaves {
            bushy::from_leaves(matrix, plan.deepest, x);
        } else {
            from_leaves(matrix, &plan.blocks, x, path);
        }
        if plan.single.from_root {
            bushy::from_root::<true>(matrix, 0..x.len(), x);
        } else {
            from_root::<true>(matrix, &plan.blocks, x, path);
        }
    };
    with_path(plan, x, by_path, |x| super::solve_plainly(matrix, x));
}

/// Solves `Lᵀ x = b` in place.
pub(super) fn solve_lower_transposed(matrix: &TreeSparse<f64>, plan: &Plan, x: &mut [f64]) {
    if plan.single.from_leaves {
        return bushy::from_leaves(matrix, plan.deepest, x);
    }
    let by_path = |x: &mut [f64], path: &mut [f64]| from_leaves(matrix, &plan.blocks, x, path);
    with_path(plan, x, by_path, |x| triangular::solve_transposed::<f64, true>(matrix, x));
}

/// Solves `L x = b` in place for the dofs of some trees.
pub(super) fn solve_lower(matrix: &TreeSparse<f64>, plan: &Plan, dofs: Range<usize>, x: &mut [f64]) {
    if plan.single.from_root {
        return bushy::from_root::<false>(matrix, dofs, x);
    }
    let place = |dof: usize| plan.blocks.partition_point(|block| block.first < dof);
    let blocks = &plan.blocks[place(dofs.start)..place(dofs.end)];
    let by_path = |x: &mut [f64], path: &mut [f64]| from_root::<false>(matrix, blocks, x, path);
    with_path(plan, x, by_path, |x| triangular::solve::<f64, true>(matrix, dofs.clone(), x));
}

/// Calls `by_path` with zeros for the longest path, or `plainly` where that is too long.
#[inline(always)]
fn with_path(plan: &Plan, x: &mut [f64], by_path: impl Fn(&mut [f64], &mut [f64]), plainly: impl Fn(&mut [f64])) {
    if plan.deepest <= USUAL {
        by_path(x, &mut [0.0; USUAL + 2 * LANES]);
    } else if plan.deepest <= LONGEST {
        by_path(x, &mut [0.0; LONGEST + 2 * LANES]);
    } else {
        plainly(x);
    }
}

/// A single block, which is a chain of up to eight dofs: everything is in registers, and every place is a constant.
#[inline(never)]
fn solve_run<const SIZE: usize>(values: &[f64], x: &mut [f64]) {
    let x: &mut [f64; SIZE] = x.first_chunk_mut().expect("one number per dof");
    let (mut l, mut y, mut d) = ([[0.0; LANES]; SIZE], [0.0; LANES], [1.0; LANES]);
    up!(k < SIZE {
        let row: &[f64; k + 1] = values[k * (k + 1) / 2..].first_chunk().expect("a row");
        l[k][..k + 1].copy_from_slice(row);
        (y[k], d[k]) = (x[k], l[k][k]);
    });
    // Lᵀ y = b
    down!(k < SIZE {
        down!(j < k {
            y[j] = Real::mul_add(-l[k][j], y[k], y[j]);
        });
    });
    // D z = y
    let mut z = (f64x8::new(y) / f64x8::new(d)).to_array();
    // L x = z
    up!(k < SIZE {
        up!(j < k {
            z[k] = Real::mul_add(-l[k][j], z[j], z[k]);
        });
    });
    x.copy_from_slice(&z[..SIZE]);
}

/// Lᵀ y = b.
#[inline(always)]
fn from_leaves(matrix: &TreeSparse<f64>, blocks: &[Block], x: &mut [f64], path: &mut [f64]) {
    let (rows, values) = matrix.parts();
    for block in blocks.iter().rev().filter(|block| !block.alone()) {
        by_size!(block.size, subtract_from_ancestors(rows, values, block, x, path));
    }
}

/// D z = y, if it `DIVIDES`, and L x = z.
#[inline(always)]
fn from_root<const DIVIDES: bool>(matrix: &TreeSparse<f64>, blocks: &[Block], x: &mut [f64], path: &mut [f64]) {
    let (rows, values) = matrix.parts();
    for block in blocks {
        if block.alone() {
            if DIVIDES {
                x[block.first] /= values[rows[block.first].start];
            }
        } else if DIVIDES {
            by_size!(block.size, divide_and_subtract_ancestors(rows, values, block, x, path));
        } else {
            by_size!(block.size, only_subtract_ancestors(rows, values, block, x, path));
        }
    }
}

/// `x_j −= L_kj x_k` for every dof k of a block, the last first, and every strict ancestor j of k.
///
/// `path[p]` holds what the dofs visited so far subtract from the ancestor at depth p of the path; it is zero below the path.
#[inline(never)]
fn subtract_from_ancestors<const SIZE: usize>(rows: &[Row], values: &[f64], block: &Block, x: &mut [f64], path: &mut [f64]) {
    let shared = block.shared;
    let starts: [usize; SIZE] = starts(rows, block);
    let x: &mut [f64; SIZE] = x[block.first..].first_chunk_mut().expect("the block's dofs");
    let sums: &[f64; SIZE] = path[shared..].first_chunk().expect("the block's part of the path");
    let mut y: [f64; SIZE] = std::array::from_fn(|a| x[a] + sums[a]);

    let l = triangle(values, &starts, shared);
    down!(k < SIZE {
        down!(j < k {
            y[j] = Real::mul_add(-l[k][j], y[k], y[j]);
        });
    });
    *x = y;
    // Whole registers at multiples of eight: a load that overlaps a narrower store would wait for it.
    for column in (0..shared).step_by(LANES) {
        let (mut even, mut odd) = (load(path, column), f64x8::ZERO);
        for a in (0..SIZE).rev() {
            let sum = if a % 2 == 0 { &mut even } else { &mut odd };
            *sum = subtract(*sum, y[a], load(values, starts[a] + column));
        }
        let sum = first(shared - column).select(even + odd, f64x8::ZERO);
        store(path, column, sum, LANES);
    }
    let column = shared.next_multiple_of(LANES);
    if column < shared + SIZE {
        store(path, column, f64x8::ZERO, LANES);
    }
}

/// `x_k = x_k / D_k − Σ_j L_kj x_j` for every dof k of a block, the first first, and every strict ancestor j of k.
///
/// `path[p]` holds x of the ancestor at depth p of the path.
#[inline(always)]
fn divide_and_subtract_ancestors<const SIZE: usize>(rows: &[Row], values: &[f64], block: &Block, x: &mut [f64], path: &mut [f64]) {
    subtract_ancestors::<SIZE, true>(rows, values, block, x, path);
}

/// The same without the division by D_k.
#[inline(always)]
fn only_subtract_ancestors<const SIZE: usize>(rows: &[Row], values: &[f64], block: &Block, x: &mut [f64], path: &mut [f64]) {
    subtract_ancestors::<SIZE, false>(rows, values, block, x, path);
}

/// Both.
#[inline(never)]
fn subtract_ancestors<const SIZE: usize, const DIVIDES: bool>(
    rows: &[Row],
    values: &[f64],
    block: &Block,
    x: &mut [f64],
    path: &mut [f64],
) {
    let shared = block.shared;
    let starts: [usize; SIZE] = starts(rows, block);
    let mut sums = [f64x8::ZERO; SIZE];
    let whole = shared - shared % LANES;
    for column in (0..whole).step_by(LANES) {
        let x = load(path, column);
        for a in 0..SIZE {
            sums[a] = x.mul_neg_add(load(values, starts[a] + column), sums[a]);
        }
    }
    if whole < shared {
        let mask = first(shared - whole);
        let x = mask.select(load(path, whole), f64x8::ZERO);
        for a in 0..SIZE {
            let l = mask.select(load(values, starts[a] + whole), f64x8::ZERO);
            sums[a] = x.mul_neg_add(l, sums[a]);
        }
    }

    let l = triangle(values, &starts, shared);
    let x: &mut [f64; SIZE] = x[block.first..].first_chunk_mut().expect("the block's dofs");
    let (mut y, mut d) = ([0.0; LANES], [1.0; LANES]);
    up!(a < SIZE {
        (y[a], d[a]) = (x[a], l[a][a]);
    });
    if DIVIDES {
        y = (f64x8::new(y) / f64x8::new(d)).to_array();
    }
    for a in 0..SIZE {
        y[a] += sums[a].reduce_add();
    }
    up!(k < SIZE {
        up!(j < k {
            y[k] = Real::mul_add(-l[k][j], y[j], y[k]);
        });
    });
    x.copy_from_slice(&y[..SIZE]);
    if block.first + SIZE < block.end {
        // Whole registers again.
        let (column, lane) = (whole, shared - whole);
        let mut register = load(path, column);
        up!(a < SIZE {
            register = only(lane + a).select(f64x8::splat(y[a]), register);
        });
        store(path, column, register, LANES);
        if lane + SIZE > LANES {
            let mut register = f64x8::ZERO;
            up!(a < SIZE {
                register = only((lane + a).wrapping_sub(LANES)).select(f64x8::splat(y[a]), register);
            });
            store(path, column + LANES, register, LANES);
        }
    }
}
