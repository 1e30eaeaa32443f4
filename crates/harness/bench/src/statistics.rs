//! Conclusions from the blocks of a paired experiment.
//!
//! Each round gives every candidate one block, in random order. A *ratio* is formed within a round, of two blocks that ran within
//! milliseconds of each other. Then the median over the rounds is taken. A disturbance that lasts for a while (another program, a
//! processor's frequency) is on both sides of such a ratio and cancels. In the ratio of two medians it need not.
//!
//! Intervals are percentile bootstrap intervals. Whole epochs (rounds in one layout of the memory) are drawn with replacement, with all
//! blocks of their rounds. The median is taken of each draw, and the interval contains the middle of these medians. So it shows how much
//! the median would vary in other layouts too. Every draw comes from a generator with a seed.

use featherbench_robots::Random;

/// Epochs of an experiment, and so the fewest rounds. Times vary more between layouts than between rounds of one layout. With thirty epochs
/// of ten rounds a third of all A/A ratios had an interval slightly wider than the noise. The same time is better spent on many epochs.
pub const EPOCHS: usize = 60;
/// Fraction of the bootstrap's medians inside an interval that is reported.
pub const LEVEL: f64 = 0.95;
/// The same for an A/A ratio. A robot has about twenty of them; chance alone must not invalidate it more often than once in fifty runs.
pub const CONTROL_LEVEL: f64 = 0.999;
/// Two engines differ if the interval of their ratio is farther from one than this. The interval of an A/A ratio must be within it.
pub const NOISE: f64 = 0.02;
/// Number of bootstrap draws: one median is then beyond each end of an interval at [`CONTROL_LEVEL`].
const RESAMPLES: usize = 2000;

/// A median with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The median of the samples.
    pub value: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// The result of comparing an engine with the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// It takes longer, by more than the noise.
    Slower,
    /// It takes less time, by more than the noise.
    Faster,
    /// This experiment cannot tell them apart.
    Alike,
}

impl Estimate {
    /// The median of samples. The fraction `level` of the bootstrap's medians is in its interval. NaN without samples, or if one is NaN.
    pub fn median(samples: &[f64], level: f64, random: &mut Random) -> Self {
        if samples.is_empty() || samples.iter().any(|sample| sample.is_nan()) {
            return Self { value: f64::NAN, low: f64::NAN, high: f64::NAN };
        }
        // If there are fewer samples than epochs, each is an epoch. Samples that do not fill an epoch are not drawn.
        let epoch = (samples.len() / EPOCHS).max(1);
        let epochs = samples.len() / epoch;
        // A draw is how often it takes each epoch. Sorted once, the samples with these weights give the median of every draw.
        let mut sorted: Vec<(f64, usize)> = samples[..epoch * epochs].iter().enumerate().map(|(k, &sample)| (sample, k / epoch)).collect();
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut taken = vec![0; epochs];
        let mut medians: Vec<f64> = (0..RESAMPLES)
            .map(|_| {
                taken.fill(0);
                for _ in 0..epochs {
                    taken[draw(random, epochs)] += 1;
                }
                weighted_median(&sorted, &taken)
            })
            .collect();
        medians.sort_unstable_by(f64::total_cmp);
        let tail = 0.5 * (1.0 - level);
        Self { value: median(&mut samples.to_vec()), low: quantile(&medians, tail), high: quantile(&medians, 1.0 - tail) }
    }

    /// The median over the rounds of the ratio of an engine's block to the reference's.
    pub fn ratio(engine: &[f64], reference: &[f64], level: f64, random: &mut Random) -> Self {
        let ratios: Vec<f64> = engine.iter().zip(reference).map(|(a, b)| a / b).collect();
        Self::median(&ratios, level, random)
    }

    /// The pace: a difference exists if the interval is beyond 1 ± noise, not just beyond one.
    pub fn pace(&self) -> Pace {
        if self.low > 1.0 + NOISE {
            Pace::Slower
        } else if self.high < 1.0 / (1.0 + NOISE) {
            Pace::Faster
        } else {
            Pace::Alike
        }
    }

    /// Why the experiment is not valid: the interval of this ratio of two copies of one program is wider than 1 ± [`NOISE`]. `None` if it
    /// is within. (Within it the two may really differ, as their data are at different places. No finding is made from so little.)
    pub fn complaint(&self) -> Option<String> {
        let Self { value, low, high } = self;
        let good = *low >= 1.0 - NOISE && *high <= 1.0 + NOISE;
        (!good)
            .then(|| format!("the second copy of featherbench over the first is {value:.4} [{low:.4}, {high:.4}]: not 1 within ± {NOISE}"))
    }
}

/// Uniform among 0 … count−1, from 32 bits: four draws from one block of the generator.
pub fn draw(random: &mut Random, count: usize) -> usize {
    ((u64::from(random.bits32()) * count as u64) >> 32) as usize
}

/// The median of sorted samples, or the mean of the two in the middle. A sample counts once for each time that its epoch was taken.
///
/// All epochs have the same number of samples, and of n epochs n are taken. So the number of samples is that of `sorted`.
pub fn weighted_median(sorted: &[(f64, usize)], taken: &[usize]) -> f64 {
    let (middle, odd) = (sorted.len() / 2, sorted.len() % 2 == 1);
    // The sample with `below` others under it.
    let mut walk = sorted.iter();
    let mut passed = 0;
    let mut at = |below: usize, last: f64| {
        let mut value = last;
        while passed <= below {
            let Some(&(sample, epoch)) = walk.next() else { return f64::NAN };
            (value, passed) = (sample, passed + taken[epoch]);
        }
        value
    };
    if odd {
        return at(middle, f64::NAN);
    }
    let lower = at(middle - 1, f64::NAN);
    0.5 * (lower + at(middle, lower))
}

/// The median of the samples, or the mean of the two in the middle; it reorders them.
pub fn median(samples: &mut [f64]) -> f64 {
    let (middle, odd) = (samples.len() / 2, samples.len() % 2 == 1);
    let (below, &mut upper, _) = samples.select_nth_unstable_by(middle, f64::total_cmp);
    if odd {
        return upper;
    }
    let lower = below.iter().copied().max_by(f64::total_cmp).unwrap_or(f64::NAN);
    0.5 * (lower + upper)
}

/// The value below which a fraction of the sorted samples is, between samples by interpolation. NaN without samples.
pub fn quantile(sorted: &[f64], fraction: f64) -> f64 {
    let at = fraction * (sorted.len().saturating_sub(1)) as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    match (sorted.get(low), sorted.get(high)) {
        (Some(a), Some(b)) => a + (b - a) * at.fract(),
        _ => f64::NAN,
    }
}

/// The same of samples in any order. A NaN is at an end, by its sign.
pub fn quantile_of(samples: &[f64], fraction: f64) -> f64 {
    let mut sorted = samples.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    quantile(&sorted, fraction)
}
