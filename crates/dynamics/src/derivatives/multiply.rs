//! `X = −B A` for a dense square matrix B and a dense A of many columns, four rows and sixteen columns at a time.
//!
//! Source: the definition of the product. Shapes: B is `nv`×`nv`, A and X have `nv` rows of so many columns, row after row.
//! Sixteen columns of four rows stay in registers while a whole row of B passes. So each number that is read serves four or sixteen products.
//! Cost: one multiply-add per row, dof and column. Nothing here allocates.

use featherbench_spatial::Real;

const ROWS: usize = 4;
const COLUMNS: usize = 16;

/// `X = −B A`; B has `n` rows, A and X have rows of `width` numbers. The last blocks begin earlier, so that they are whole.
pub(super) fn multiply_negated<T: Real>(n: usize, b: &[T], a: &[T], width: usize, x: &mut [T]) {
    if n < ROWS || width < COLUMNS {
        for row in 0..n {
            (0..width).for_each(|column| block::<T, 1, 1>(n, b, a, width, x, row, column));
        }
        return;
    }
    for column in (0..width).step_by(COLUMNS) {
        for row in (0..n).step_by(ROWS) {
            block::<T, ROWS, COLUMNS>(n, b, a, width, x, row.min(n - ROWS), column.min(width - COLUMNS));
        }
    }
}

/// `R` rows and `C` columns of X.
#[inline(never)]
fn block<T: Real, const R: usize, const C: usize>(n: usize, b: &[T], a: &[T], width: usize, x: &mut [T], row: usize, column: usize) {
    let rows: [&[T]; R] = std::array::from_fn(|r| &b[(row + r) * n..][..n]);
    let mut sums = [[T::zero(); C]; R];
    for j in 0..n {
        let Some(a_j) = a[j * width + column..].first_chunk::<C>() else { break };
        for r in 0..R {
            let b = -rows[r][j];
            for c in 0..C {
                sums[r][c] = b.mul_add(a_j[c], sums[r][c]);
            }
        }
    }
    for (r, sums) in sums.iter().enumerate() {
        x[(row + r) * width + column..][..C].copy_from_slice(sums);
    }
}
