//! Medians and exponents with percentile bootstrap intervals.
//!
//! A draw takes n of the n blocks of calls at each size, with replacement. The median at each size and the exponent through these
//! medians follow from it. The interval contains the middle of all draws' values. It shows how noise within one process changes the value. It
//! does not show how another process, with its data elsewhere, would.

use featherbench_bench::statistics::quantile_of;
use featherbench_report::fit::power_law;
use featherbench_robots::Random;

/// Draws.
const DRAWS: usize = 500;
/// Fraction of the draws inside the interval.
const LEVEL: f64 = 0.95;
/// An exponent is fitted to sizes from the largest down to this fraction of it: two decades.
const DECADES: f64 = 1e-2;

/// A value with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub(super) value: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Interval {
    fn of(value: f64, draws: &[f64]) -> Self {
        let tail = 0.5 * (1.0 - LEVEL);
        Self { value, low: quantile_of(draws, tail), high: quantile_of(draws, 1.0 - tail) }
    }
}

/// The median of values.
pub(super) fn median(values: &[f64]) -> f64 {
    quantile_of(values, 0.5)
}

fn drawn(blocks: &[f64], random: &mut Random) -> Vec<f64> {
    blocks.iter().map(|_| blocks[random.below(blocks.len())]).collect()
}

/// The median of blocks, and its interval.
pub(super) fn of_median(blocks: &[f64], random: &mut Random) -> Interval {
    let draws: Vec<f64> = (0..DRAWS).map(|_| median(&drawn(blocks, random))).collect();
    Interval::of(median(blocks), &draws)
}

/// The fewest sizes of a fit: through three a line goes nearly always.
const FEWEST: usize = 4;

/// The exponent p of time ~ nᵖ over the last two decades of sizes, of (n, blocks); `None` if fewer than [`FEWEST`] sizes are there.
pub(super) fn of_exponent(sizes: &[(f64, &[f64])], random: &mut Random) -> Option<Interval> {
    let largest = sizes.last()?.0;
    let last: Vec<_> = sizes.iter().filter(|(n, _)| *n >= DECADES * largest).collect();
    if last.len() < FEWEST {
        return None;
    }
    let value = power_law(last.iter().map(|(n, blocks)| (*n, median(blocks))))?.slope;
    let draw = |random: &mut Random| Some(power_law(last.iter().map(|(n, blocks)| (*n, median(&drawn(blocks, random)))))?.slope);
    let draws: Option<Vec<f64>> = (0..DRAWS).map(|_| draw(random)).collect();
    Some(Interval::of(value, &draws?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_the_last_decades_is_found_within_its_interval() {
        let mut noise = Random::new(1, 0);
        let sizes = [10.0_f64, 100.0, 300.0, 1000.0, 3000.0, 10_000.0];
        // Quadratic; the first size is more than two decades away, and off.
        let blocks: Vec<Vec<f64>> = sizes
            .iter()
            .map(|n| (0..15).map(|_| (if *n < 50.0 { 1.0 } else { 1e-9 * n * n }) * (1.0 + 0.05 * noise.unit())).collect())
            .collect();
        let pairs: Vec<(f64, &[f64])> = sizes.iter().copied().zip(blocks.iter().map(Vec::as_slice)).collect();
        let Interval { value, low, high } = of_exponent(&pairs, &mut Random::new(2, 0)).unwrap();
        assert!((value - 2.0).abs() < 0.02 && low <= value && value <= high && high - low < 0.05, "{value} [{low}, {high}]");
        assert_eq!(of_exponent(&pairs[..2], &mut Random::new(2, 0)), None);
    }

    #[test]
    fn the_interval_of_a_median_contains_it() {
        let blocks = [5.0, 1.0, 3.0, 2.0, 4.0];
        let Interval { value, low, high } = of_median(&blocks, &mut Random::new(3, 0));
        assert!(value == 3.0 && (1.0..=3.0).contains(&low) && (3.0..=5.0).contains(&high) && low < high);
        assert!(of_median(&[], &mut Random::new(3, 0)).value.is_nan());
    }
}
