//! `X = −M⁻¹ A` for many columns at once, by the factors `M = LᵀDL`.
//!
//! Source: the book, section 6.5, for one column. Shape: A has `nv` rows of so many columns, row after row; X takes its place.
//! Some columns go through the whole factorization together, in registers: 32 of `f64`. Those that remain go in smaller blocks.
//! Cost: two multiply-adds per strict ancestor and column, one division per dof and block of columns. Nothing here allocates.

use crate::TreeSparse;
use featherbench_spatial::Real;

/// `X = −M⁻¹ A` in place; rows have `width` numbers.
pub(super) fn solve_negated<T: Real>(factors: &TreeSparse<T>, x: &mut [T], width: usize) {
    let solve: [(usize, Solve<T>); 5] = [
        (32, solve_columns::<T, 32>),
        (16, solve_columns::<T, 16>),
        (8, solve_columns::<T, 8>),
        (4, solve_columns::<T, 4>),
        (1, solve_columns::<T, 1>),
    ];
    // Of registers, four are as much as 32 numbers.
    let widest = if size_of::<T>() <= 8 { 32 } else { 4 };
    let mut column = 0;
    for (block, solve) in solve {
        while block <= widest && column + block <= width {
            solve(factors, x, width, column);
            column += block;
        }
    }
}

/// From factors, rows, their width and the first column.
type Solve<T> = fn(&TreeSparse<T>, &mut [T], usize, usize);

/// `W` columns.
#[inline(never)]
fn solve_columns<T: Real, const W: usize>(factors: &TreeSparse<T>, x: &mut [T], width: usize, column: usize) {
    let place = |row: usize| row * width + column;
    // Lᵀ Y = A, from the leaves: Y_j· −= L_kj Y_k·
    for k in (0..factors.size()).rev() {
        let (above, below) = x.split_at_mut(place(k));
        let Some(row_k) = below.first_chunk::<W>() else { break };
        let (row_k, l_k) = (*row_k, &factors.values()[factors.row(k)]);
        for (dofs, entries) in factors.ancestors(k) {
            for (j, l) in dofs.zip(&l_k[entries]) {
                if let Some(row_j) = above[place(j)..].first_chunk_mut::<W>() {
                    subtract(*l, &row_k, row_j);
                }
            }
        }
    }
    // Z = −D⁻¹ Y, then L X = Z, from the root: X_k· −= L_kj X_j·
    for (k, d) in factors.diagonal().enumerate() {
        let (above, below) = x.split_at_mut(place(k));
        let Some(row_k) = below.first_chunk_mut::<W>() else { break };
        let scale = -(T::one() / d);
        let mut sum = row_k.map(|x| x * scale);
        let l_k = &factors.values()[factors.row(k)];
        for (dofs, entries) in factors.ancestors(k) {
            for (j, l) in dofs.zip(&l_k[entries]) {
                if let Some(row_j) = above[place(j)..].first_chunk::<W>() {
                    subtract(*l, row_j, &mut sum);
                }
            }
        }
        *row_k = sum;
    }
}

/// `y −= l x`.
#[inline(always)]
fn subtract<T: Real, const W: usize>(l: T, x: &[T; W], y: &mut [T; W]) {
    for w in 0..W {
        y[w] = (-l).mul_add(x[w], y[w]);
    }
}
