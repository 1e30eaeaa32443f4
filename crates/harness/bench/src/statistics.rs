//! Conclusions from the blocks of a paired experiment.
//!
//! Each round gives every candidate one block, in random order. A process's number for a candidate is the *lower decile* of its blocks. A
//! disturbance (another program, a processor's frequency, an unlucky layout of the memory) makes blocks longer, never shorter. So the decile
//! is near the time without it, as the median is not: its spread between processes is half as large. A ratio is that of two deciles of one
//! process, whose blocks alternated.
//!
//! Where a process has its code and data is an accident that lasts as long as it does. So an experiment is made in several processes, one
//! after another, over the length of the study. Each gives one number. In one of ten something else went on all the while. So the least and
//! the largest are left out. An estimate is the geometric mean of the others. Its interval is that of a trimmed mean (Yuen, Biometrika 61,
//! 1974): whatever differs between processes or moments is in it.

use crate::robot::relocation::STACK_PLACES;
use featherbench_results::STUDENT;

/// Processes of an experiment. With n of them the interval has about the half-width t·s/√n: 1.24 s for five, 0.72 s for ten, 0.47 s for twenty.
pub const PROCESSES: usize = 10;
/// Epochs of a process (rounds in one layout of the memory): two for each place of the stack in a cache line. Times vary more between
/// layouts than between rounds of one layout.
pub const EPOCHS: usize = 2 * STACK_PLACES;
/// The share of the processes that an estimate is a mean of.
const KEPT: f64 = 0.8;
/// Two engines differ if the interval of their ratio is farther from one than this.
pub const NOISE: f64 = 0.02;
/// The interval of an A/A ratio must be within 1 ± this: beyond it no time of the experiment counts. A wider interval within it needs no
/// rule: whatever made it wide made the others wide.
pub const VOID: f64 = 0.05;
/// A value with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The geometric mean of the processes' numbers, without the least and the largest.
    pub value: f64,
    /// Lower end of its 95 % interval.
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
    /// The estimate of the numbers of [`PROCESSES`] processes. NaN if there are not as many, or one is not positive.
    pub fn of(numbers: &[f64]) -> Self {
        let good = numbers.len() == PROCESSES && numbers.iter().all(|&number| number > 0.0 && number.is_finite());
        if !good {
            return Self { value: f64::NAN, low: f64::NAN, high: f64::NAN };
        }
        // Over the first, so that equal numbers give themselves to the last bit.
        let mut logs: Vec<f64> = numbers.iter().map(|number| (number / numbers[0]).ln()).collect();
        logs.sort_unstable_by(f64::total_cmp);
        let (count, kept) = (PROCESSES as f64, &logs[1..PROCESSES - 1]);
        let mean = kept.iter().sum::<f64>() / kept.len() as f64;
        // The ends count as their neighbours: Winsorized.
        logs[0] = logs[1];
        logs[PROCESSES - 1] = logs[PROCESSES - 2];
        let middle = logs.iter().sum::<f64>() / count;
        let variance = logs.iter().map(|log| (log - middle) * (log - middle)).sum::<f64>() / (count - 1.0);
        let half = STUDENT * (variance / count).sqrt() / KEPT;
        let value = numbers[0] * mean.exp();
        Self { value, low: value * (-half).exp(), high: value * half.exp() }
    }

    /// The time of a candidate, of its blocks process by process.
    pub fn time<'s>(processes: impl IntoIterator<Item = &'s [f64]>) -> Self {
        Self::of(&processes.into_iter().map(undisturbed).collect::<Vec<_>>())
    }

    /// The ratio of a candidate's time to another's, of the blocks of both process by process.
    pub fn ratio<'s>(processes: impl IntoIterator<Item = (&'s [f64], &'s [f64])>) -> Self {
        Self::of(&processes.into_iter().map(|(of, over)| undisturbed(of) / undisturbed(over)).collect::<Vec<_>>())
    }

    /// The ratio, whose interval is wider by what an A/A ratio misses 1: two copies of one program differ by so much in these processes.
    #[must_use]
    pub fn widened(self, control: &Self) -> Self {
        let missed = (control.low.max(1.0 / control.high)).max(1.0);
        Self { low: self.low / missed, high: self.high * missed, ..self }
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

    /// Why the experiment is not valid: the interval of this ratio of two copies of one program is not within 1 ± [`VOID`]. `None` if it is.
    pub fn complaint(&self) -> Option<String> {
        let Self { value, low, high } = self;
        let good = *low >= 1.0 - VOID && *high <= 1.0 + VOID;
        (!good)
            .then(|| format!("the second copy of featherbench over the first is {value:.4} [{low:.4}, {high:.4}]: not 1 within ± {VOID}"))
    }
}

/// The lower decile of the blocks of a process. NaN without blocks, or if one is NaN.
pub fn undisturbed(blocks: &[f64]) -> f64 {
    if blocks.iter().any(|block| block.is_nan()) { f64::NAN } else { quantile_of(blocks, 0.1) }
}

/// The median of the samples, or the mean of the two in the middle; it reorders them. NaN without samples, or if one is NaN.
pub fn median(samples: &mut [f64]) -> f64 {
    if samples.is_empty() || samples.iter().any(|sample| sample.is_nan()) {
        return f64::NAN;
    }
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
