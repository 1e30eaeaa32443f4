//! Conclusions from the blocks of a paired experiment.
//!
//! Each round gives every candidate one block, in random order. A *ratio* is formed within a round, of two blocks that ran within
//! milliseconds of each other. Then the median over the rounds of a process is taken. A disturbance that lasts for a while (another program, a
//! processor's frequency) is on both sides of such a ratio and cancels. In the ratio of two medians it need not.
//!
//! Where a process has its code and data is an accident that lasts as long as it does. So an experiment is made in several processes, one
//! after another, over the length of the study. Each gives one number, its median. An estimate is the geometric mean of these, and its
//! interval is Student's, of their logarithms: whatever differs between processes or moments is in it.

/// Processes of an experiment. With n of them the interval has the half-width t·s/√n: 1.24 s for five, 0.72 s for ten, 0.47 s for twenty.
pub const PROCESSES: usize = 10;
/// Epochs of a process (rounds in one layout of the memory). Times vary more between layouts than between rounds of one layout.
pub const EPOCHS: usize = 6;
/// Two engines differ if the interval of their ratio is farther from one than this.
pub const NOISE: f64 = 0.02;
/// The interval of an A/A ratio must be within 1 ± this: beyond it no time of the experiment counts. A wider interval within it needs no
/// rule: whatever made it wide made the others wide.
pub const VOID: f64 = 0.05;
/// The 0.975 quantile of Student's distribution with [`PROCESSES`] − 1 degrees of freedom: intervals hold 95 %.
const STUDENT: f64 = 2.262_157_162_798_205;

/// A value with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The geometric mean of the processes' medians.
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
    /// The estimate of the medians of [`PROCESSES`] processes. NaN if there are not as many, or one is no positive number.
    pub fn of(medians: &[f64]) -> Self {
        let good = medians.len() == PROCESSES && medians.iter().all(|&median| median > 0.0 && median.is_finite());
        if !good {
            return Self { value: f64::NAN, low: f64::NAN, high: f64::NAN };
        }
        let count = PROCESSES as f64;
        // Over the first, so that equal medians give themselves to the last bit.
        let logs = || medians.iter().map(|median| (median / medians[0]).ln());
        let mean = logs().sum::<f64>() / count;
        let variance = logs().map(|log| (log - mean) * (log - mean)).sum::<f64>() / (count - 1.0);
        let half = STUDENT * (variance / count).sqrt();
        let value = medians[0] * mean.exp();
        Self { value, low: value * (-half).exp(), high: value * half.exp() }
    }

    /// The time of a candidate, of its blocks process by process.
    pub fn time<'s>(processes: impl IntoIterator<Item = &'s [f64]>) -> Self {
        Self::of(&processes.into_iter().map(|blocks| median(&mut blocks.to_vec())).collect::<Vec<_>>())
    }

    /// The ratio of a candidate's time to another's, of the blocks of both process by process.
    pub fn ratio<'s>(processes: impl IntoIterator<Item = (&'s [f64], &'s [f64])>) -> Self {
        let median_ratio = |(of, over): (&[f64], &[f64])| median(&mut of.iter().zip(over).map(|(a, b)| a / b).collect::<Vec<_>>());
        Self::of(&processes.into_iter().map(median_ratio).collect::<Vec<_>>())
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
