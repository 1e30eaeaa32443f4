//! Products with dense matrices, row after row, and a factorization of a general one with row exchanges.
//!
//! Source: Golub and Van Loan, *Matrix Computations*, §3.4 (LU with partial pivoting). Cost: n³/3 multiply-adds for the factors, n² for a
//! solution. A call does not allocate.

use super::error::magnitude;
use featherbench_spatial::Real;

/// `result += matrix · x`; `result` has one number per row of the matrix.
pub(super) fn add_product<T: Real>(matrix: &[T], x: &[T], result: &mut [T]) {
    if x.is_empty() {
        return;
    }
    for (row, result) in matrix.chunks_exact(x.len()).zip(result) {
        *result = row.iter().zip(x).fold(*result, |sum, (m, x)| m.mul_add(*x, sum));
    }
}

/// `result += matrixᵀ · x`; `x` has one number per row of the matrix.
pub(super) fn add_transpose_product<T: Real>(matrix: &[T], x: &[T], result: &mut [T]) {
    if result.is_empty() {
        return;
    }
    for (row, x) in matrix.chunks_exact(result.len()).zip(x) {
        for (m, result) in row.iter().zip(result.iter_mut()) {
            *result = m.mul_add(*x, *result);
        }
    }
}

/// `result += factor · x`
pub(super) fn add_scaled<T: Real>(factor: T, x: &[T], result: &mut [T]) {
    for (x, result) in x.iter().zip(result) {
        *result = factor.mul_add(*x, *result);
    }
}

/// The factors `P A = L U` of a square matrix, in its place.
#[derive(Clone, Debug)]
pub(super) struct Lu<T> {
    /// The matrix, then its factors, row after row.
    pub(super) values: Vec<T>,
    /// The row that stands at each place.
    order: Vec<usize>,
    scratch: Vec<T>,
}

impl<T: Real> Lu<T> {
    pub(super) fn new(n: usize) -> Self {
        Self { values: vec![T::zero(); n * n], order: vec![0; n], scratch: vec![T::zero(); n] }
    }

    /// Factors the matrix in `values`; false if a pivot is zero or not finite.
    pub(super) fn factor(&mut self) -> bool {
        let n = self.order.len();
        let a = &mut self.values;
        for (k, row) in self.order.iter_mut().enumerate() {
            *row = k;
        }
        for k in 0..n {
            let size = |a: &[T], row: usize| magnitude(a[row * n + k]);
            let pivot = (k + 1..n).fold(k, |best, row| if size(a, row) > size(a, best) { row } else { best });
            let usable = size(a, pivot) > 0.0 && size(a, pivot).is_finite();
            if !usable {
                return false;
            }
            if pivot != k {
                self.order.swap(k, pivot);
                (0..n).for_each(|column| a.swap(k * n + column, pivot * n + column));
            }
            for row in k + 1..n {
                let factor = a[row * n + k] / a[k * n + k];
                a[row * n + k] = factor;
                for column in k + 1..n {
                    a[row * n + column] = (-factor).mul_add(a[k * n + column], a[row * n + column]);
                }
            }
        }
        true
    }

    /// `x = A⁻¹ x`
    pub(super) fn solve(&mut self, x: &mut [T]) {
        let (n, a) = (self.order.len(), &self.values);
        for (y, &row) in self.scratch.iter_mut().zip(&self.order) {
            *y = x[row];
        }
        for k in 0..n {
            x[k] = (0..k).fold(self.scratch[k], |sum, j| (-a[k * n + j]).mul_add(x[j], sum));
        }
        for k in (0..n).rev() {
            let sum = (k + 1..n).fold(x[k], |sum, j| (-a[k * n + j]).mul_add(x[j], sum));
            x[k] = sum / a[k * n + k];
        }
    }

    /// `x = A⁻ᵀ x`
    pub(super) fn transpose_solve(&mut self, x: &mut [T]) {
        let (n, a) = (self.order.len(), &self.values);
        for k in 0..n {
            let sum = (0..k).fold(x[k], |sum, j| (-a[j * n + k]).mul_add(x[j], sum));
            x[k] = sum / a[k * n + k];
        }
        for k in (0..n).rev() {
            x[k] = (k + 1..n).fold(x[k], |sum, j| (-a[j * n + k]).mul_add(x[j], sum));
        }
        self.scratch.copy_from_slice(x);
        for (y, &row) in self.scratch.iter().zip(&self.order) {
            x[row] = *y;
        }
    }
}
