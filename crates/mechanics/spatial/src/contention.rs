//! How crowded a core is: what a program on its other thread takes from this one.
//!
//! It stands here because it is compiled with the optimisation of kernels. Elsewhere the step of a loop is a call, and nothing fills the core.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Rows of the matrices of the work that needs all of the core.
const SIZE: usize = 16;
/// Their products in a trial: some microseconds.
const PRODUCTS: usize = 8;
/// Steps of the chain in a trial: about as long.
const STEPS: usize = 1200;
/// Trials, of which the shortest counts: an interruption makes one longer.
const TRIALS: usize = 3;

/// Aligned to a cache line: loads that cross one would take longer in one place of the stack than in another.
#[repr(align(64))]
struct Matrix([[f64; SIZE]; SIZE]);

/// The time of products of matrices over that of a chain in which each step waits for the one before. It takes some ten microseconds.
///
/// A core of two threads shares its width and its first cache, and not the latency of an operation. Beside another program the products take
/// longer, by an eighth and up to two times, and the chain does not. Otherwise its number varies by about 1 %: a change of the frequency changes
/// both alike.
///
/// ```
/// assert!(featherbench_spatial::contention() > 0.0);
/// ```
pub fn contention() -> f64 {
    let matrix = Matrix(std::array::from_fn(|row| std::array::from_fn(|column| (1 + row + column) as f64)));
    let mut product = Matrix([[0.0; SIZE]; SIZE]);
    let (mut wide, mut waiting) = (Duration::MAX, Duration::MAX);
    for _ in 0..TRIALS {
        wide = wide.min(time(&mut || {
            for _ in 0..PRODUCTS {
                multiply(black_box(&matrix), black_box(&matrix), &mut product);
                black_box(&product);
            }
        }));
        waiting = waiting.min(time(&mut || {
            black_box(chain(black_box(1)));
        }));
    }
    wide.as_secs_f64() / waiting.as_secs_f64().max(1e-9)
}

fn time(work: &mut dyn FnMut()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}

/// The entries of a row do not wait for each other.
#[inline(never)]
fn multiply(a: &Matrix, b: &Matrix, product: &mut Matrix) {
    for (factors, row) in a.0.iter().zip(&mut product.0) {
        *row = [0.0; SIZE];
        for (factor, other) in factors.iter().zip(&b.0) {
            for (entry, other) in row.iter_mut().zip(other) {
                *entry += factor * other;
            }
        }
    }
}

/// The steps of a linear congruential generator (Knuth), each mixed with its upper bits.
#[inline(never)]
fn chain(mut x: u64) -> u64 {
    for _ in 0..STEPS {
        x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        x ^= x >> 29;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_products_are_products() {
        let a = Matrix(std::array::from_fn(|row| std::array::from_fn(|column| (3 * row + column) as f64)));
        let shift = Matrix(std::array::from_fn(|row| std::array::from_fn(|column| f64::from((row + 1) % SIZE == column))));
        let mut product = Matrix([[f64::NAN; SIZE]; SIZE]);
        multiply(&a, &shift, &mut product);
        for (row, entries) in product.0.iter().enumerate() {
            for (column, entry) in entries.iter().enumerate() {
                assert_eq!(*entry, a.0[row][(column + SIZE - 1) % SIZE], "{row}, {column}");
            }
        }
    }

    /// No step of the chain can be left out: another start gives another end.
    #[test]
    fn the_chain_depends_on_its_start() {
        let ends: std::collections::BTreeSet<u64> = (0..1000).map(chain).collect();
        assert_eq!(ends.len(), 1000);
    }

    #[test]
    fn it_is_a_number() {
        assert!((0..100).all(|_| (1e-3..1e3).contains(&contention())));
    }
}
