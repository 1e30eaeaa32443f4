//! The peak of a core, with which the times of kernels are compared: fused multiply-adds of doubles.
//!
//! It stands here because it is compiled with the optimisation of kernels.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// A vector register of doubles of this build.
#[cfg(target_feature = "avx512f")]
type Vector = wide::f64x8;
#[cfg(all(target_feature = "avx", not(target_feature = "avx512f")))]
type Vector = wide::f64x4;
#[cfg(not(target_feature = "avx"))]
type Vector = wide::f64x2;

/// Doubles in a vector register of this build.
pub const LANES: usize = size_of::<Vector>() / size_of::<f64>();

/// The number of chains: more than the latency of a multiply-add (4 cycles, 5 on older processors) times the number of units (2; 4 on ARM).
/// With the two constants they need no more than the registers, of which AVX-512 has as many as ARM.
const CHAINS: usize = if cfg!(any(target_feature = "avx512f", target_arch = "aarch64")) { 20 } else { 12 };
/// Number of blocks, of which the best counts: a limit is the peak of the machine, not its usual performance.
const BLOCKS: usize = 200;
/// Multiply-adds in each chain of a block.
const STEPS: usize = 20_000;
/// Multiply-adds of a block of vectors, and of one of single doubles.
const VECTOR_WORK: usize = SCALAR_WORK * LANES;
const SCALAR_WORK: usize = STEPS * CHAINS;
/// The start of the first chain, and the constants: numbers that neither overflow nor underflow.
const START: f64 = 1.0;
const M: f64 = 0.999;
const C: f64 = 1e-3;

/// The peak of the core at hand: fused multiply-adds of doubles per nanosecond in full vector registers of this build, the best of 200 blocks.
/// It takes some milliseconds.
///
/// ```
/// // An operation per joint takes at least this long, in nanoseconds.
/// assert!(1.0 / featherbench_spatial::peak::multiply_adds_per_ns() > 0.0);
/// ```
pub fn multiply_adds_per_ns() -> f64 {
    rate(VECTOR_WORK, || {
        black_box(vector_chains(black_box(START), black_box(M), black_box(C)));
    })
}

/// The same of single doubles: a peak that is not well above it was not measured with vectors.
pub fn single_multiply_adds_per_ns() -> f64 {
    rate(SCALAR_WORK, || {
        black_box(scalar_chains(black_box(START), black_box(M), black_box(C)));
    })
}

/// Multiply-adds per nanosecond of a block with this number of them; the best of many blocks.
fn rate(work: usize, mut block: impl FnMut()) -> f64 {
    let times = (0..BLOCKS).map(|_| {
        let start = Instant::now();
        block();
        start.elapsed()
    });
    best(work, times)
}

/// Multiply-adds per nanosecond, by the shortest of these times.
fn best(work: usize, times: impl Iterator<Item = Duration>) -> f64 {
    work as f64 / times.min().unwrap_or_default().as_nanos() as f64
}

/// x ← x·m + c in every lane of every chain, by vector instructions. Each lane starts with another number, so that no two are merged.
///
/// The type determines the instruction: whether a loop over arrays is vectorised depends on the build's flags.
#[inline(never)]
fn vector_chains(start: f64, m: f64, c: f64) -> [[f64; LANES]; CHAINS] {
    let (m, c) = (Vector::splat(m), Vector::splat(c));
    let mut x: [Vector; CHAINS] =
        std::array::from_fn(|chain| Vector::from(std::array::from_fn::<f64, LANES, _>(|lane| start + (chain * LANES + lane) as f64)));
    for _ in 0..STEPS {
        for chain in &mut x {
            *chain = chain.mul_add(m, c);
        }
    }
    x.map(Into::into)
}

/// The same of single doubles: the first lane of each chain.
#[inline(never)]
fn scalar_chains(start: f64, m: f64, c: f64) -> [f64; CHAINS] {
    let mut x: [f64; CHAINS] = std::array::from_fn(|chain| start + (chain * LANES) as f64);
    for _ in 0..STEPS {
        for chain in &mut x {
            *chain = crate::Real::mul_add(*chain, m, c);
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every lane of every chain has its own multiply-adds, as counted for the peak, equal to the bit to a loop over one number.
    #[test]
    fn the_chains_compute_what_they_say() {
        let (vector, scalar) = (vector_chains(START, M, C), scalar_chains(START, M, C));
        let mut counted = 0;
        for (chain, lanes) in vector.iter().enumerate() {
            for (lane, x) in lanes.iter().enumerate() {
                let start = START + (chain * LANES + lane) as f64;
                let alone = (0..STEPS).fold(start, |x, _| {
                    counted += 1;
                    // Without such an instruction the crate rounds twice.
                    if cfg!(any(target_feature = "fma", target_arch = "aarch64")) { x.mul_add(M, C) } else { x * M + C }
                });
                assert_eq!(*x, alone, "chain {chain}, lane {lane}");
            }
            assert!((scalar[chain] - lanes[0]).abs() <= 1e-12, "chain {chain}");
        }
        assert_eq!((counted, counted / LANES), (VECTOR_WORK, SCALAR_WORK));
    }

    /// A chain waits for its own result, and others go on meanwhile.
    #[test]
    fn the_chains_fill_the_units() {
        let (latency, units, registers) = if cfg!(target_arch = "aarch64") { (4, 4, 32) } else { (5, 2, if LANES == 8 { 32 } else { 16 }) };
        assert!(CHAINS >= latency * units && CHAINS + 2 <= registers);
        assert!([2, 4, 8].contains(&LANES));
    }

    #[test]
    fn a_rate_is_that_of_the_best_block() {
        assert_eq!(best(1000, [500, 50, 100].into_iter().map(Duration::from_nanos)), 20.0);
        assert_eq!(best(1000, std::iter::empty()), f64::INFINITY, "which no row takes for a value");
    }
}
