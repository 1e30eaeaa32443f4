//! Conclusions from the blocks of a paired experiment.
//!
//! Each round gives every candidate one block, in random order. A process's number for a candidate is the *lower decile* of its blocks. A
//! disturbance (another program, a processor's frequency, an unlucky layout of the memory) makes blocks longer, never shorter. So the decile
//! is near the time without it, as the median is not: its spread between processes is half as large. A ratio is that of two deciles of one
//! process, whose blocks alternated.
//!
//! Where a process has its code and data is an accident that lasts as long as it does. So an experiment is made in several processes, one
//! after another, over the length of the study. Each gives one number.
//!
//! A core has *states*: alone it is a third faster than beside a program on its other thread. A state lasts for milliseconds or seconds. Two
//! candidates do not suffer alike, so a ratio has states as well, and a mean over states is that of chance. So it is measured between rounds
//! how crowded the core is, and only those count in which it was alone: [`Steady`]. In one process of ten something else went on all the
//! while. So the least and the largest of eight or more are left out.
//!
//! An estimate is the geometric mean of the others. Its interval is that of a trimmed mean (Yuen, Biometrika 61, 1974), or of a mean:
//! whatever differs between processes or moments is in it. What the whole machine does from one run to the next is in no ratio, but in every
//! time: its [`drift`] is known from the two copies of one program.

use crate::robot::relocation::STACK_PLACES;
use featherbench_results::{NORMAL, STUDENT};

/// Processes of an experiment. With n of them the interval has about the half-width t·s/√n: 1.24 s for five, 0.72 s for ten, 0.47 s for twenty.
pub const PROCESSES: usize = 10;
/// Epochs of a process (rounds in one layout of the memory): two for each place of the stack in a cache line. Times vary more between
/// layouts than between rounds of one layout.
pub const EPOCHS: usize = 2 * STACK_PLACES;
/// The fewest processes of an estimate: two say nothing of their spread.
pub const LEAST: usize = 3;
/// So many processes, or more, are without the least and the largest.
const TRIMMED: usize = 8;
/// The 0.975 quantiles of Student's distribution, from two degrees of freedom on.
const STUDENTS: [f64; 6] =
    [4.302_652_729_911_275, 3.182_446_305_284_263, 2.776_445_105_197_798_7, 2.570_581_836_614_739_5, 2.446_911_848_791_680_6, STUDENT];
/// Two engines differ if the interval of their ratio is farther from one than this.
pub const NOISE: f64 = 0.02;
/// The interval of an A/A ratio must be within 1 ± this: beyond it no time of the experiment counts. A wider interval within it needs no
/// rule: whatever made it wide made the others wide.
pub const VOID: f64 = 0.05;
/// A core is crowded if its contention is so much more than at the quietest moments. Up to this the blocks of kernels are as short as alone, and
/// from 1.1 on a third longer (EPYC, by `timing.jsonl`).
pub const CROWDED: f64 = 1.08;
/// The share of the rounds that counts as the quietest: a single one may be an accident.
const QUIETEST: f64 = 0.02;
/// A process counts if the core was alone in this share of its rounds, or more.
const ALONE: f64 = 0.25;

/// A value with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The geometric mean of the processes' numbers, of eight and more without the least and the largest.
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
    /// The estimate of the numbers of [`LEAST`] to [`PROCESSES`] processes. NaN of another count, or if one is not positive.
    pub fn of(numbers: &[f64]) -> Self {
        let good = (LEAST..=PROCESSES).contains(&numbers.len()) && numbers.iter().all(|&number| number > 0.0 && number.is_finite());
        if !good {
            return Self { value: f64::NAN, low: f64::NAN, high: f64::NAN };
        }
        // Over the first, so that equal numbers give themselves to the last bit.
        let mut logs: Vec<f64> = numbers.iter().map(|number| (number / numbers[0]).ln()).collect();
        logs.sort_unstable_by(f64::total_cmp);
        let (count, cut) = (logs.len(), usize::from(logs.len() >= TRIMMED));
        let mean = |logs: &[f64]| logs.iter().sum::<f64>() / logs.len() as f64;
        let kept = &logs[cut..count - cut];
        let (value, share) = (mean(kept), kept.len() as f64 / count as f64);
        // The ends count as their neighbours: Winsorized.
        logs[0] = logs[cut];
        logs[count - 1] = logs[count - 1 - cut];
        let middle = mean(&logs);
        let variance = logs.iter().map(|log| (log - middle) * (log - middle)).sum::<f64>() / (count - 1) as f64;
        let freedom = count - 2 * cut - 1;
        Self { value: numbers[0] * value.exp(), low: 0.0, high: 0.0 }
            .with_half(STUDENTS[freedom - 2] * (variance / count as f64).sqrt() / share)
    }

    /// The same value with this half-width of the logarithm of its interval.
    fn with_half(self, half: f64) -> Self {
        Self { low: self.value * (-half).exp(), high: self.value * half.exp(), ..self }
    }

    /// The time of a candidate, of its numbers process by process.
    pub fn time(numbers: &[f64], steady: &Steady) -> Self {
        Self::of(&steady.pick(numbers))
    }

    /// The ratio of a candidate's time to another's, of the numbers of both process by process.
    pub fn ratio(of: &[f64], over: &[f64], steady: &Steady) -> Self {
        let ratios: Vec<f64> = of.iter().zip(over).map(|(of, over)| of / over).collect();
        Self::of(&steady.pick(&ratios))
    }

    /// The time, whose interval holds the mean over runs as well, if the machine's [`drift`] is this.
    #[must_use]
    pub fn drifting(self, drift: f64) -> Self {
        self.with_half((0.5 * (self.high / self.low).ln()).hypot(NORMAL * drift))
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

/// How crowded the core was in the quietest of these rounds. NaN without rounds.
pub fn quietest(contention: &[f64]) -> f64 {
    quantile_of(contention, QUIETEST)
}

/// The rounds and the processes of an experiment that count: those in which the core was at its fastest, alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Steady {
    /// Of each process the rounds that count.
    rounds: Vec<Vec<bool>>,
    kept: Vec<bool>,
    /// How many processes were at the fastest.
    pub fastest: usize,
}

impl Steady {
    /// Of how crowded the core was in each round of each process, and in the quietest rounds of the run. The rounds that are about as quiet
    /// count, and the processes that have enough of them. If those are fewer than [`LEAST`], all count, and there is a complaint.
    pub fn of<'c>(contention: impl IntoIterator<Item = &'c [f64]>, quietest: f64) -> Self {
        let alone = |process: &[f64]| process.iter().map(|&round| round <= CROWDED * quietest).collect::<Vec<bool>>();
        let rounds: Vec<Vec<bool>> = contention.into_iter().map(alone).collect();
        let enough = |rounds: &Vec<bool>| {
            let alone = rounds.iter().filter(|alone| **alone).count();
            alone > 0 && alone as f64 >= ALONE * rounds.len() as f64
        };
        let kept: Vec<bool> = rounds.iter().map(enough).collect();
        let fastest = kept.iter().filter(|kept| **kept).count();
        let kept = if fastest < LEAST { vec![true; kept.len()] } else { kept };
        Self { rounds, kept, fastest }
    }

    /// The blocks of the rounds of a process that count; all of them if too few processes count.
    pub fn blocks(&self, process: usize, blocks: &[f64]) -> Vec<f64> {
        let all = self.fastest < LEAST;
        blocks.iter().zip(&self.rounds[process]).filter(|(_, alone)| all || **alone).map(|(&block, _)| block).collect()
    }

    /// The numbers of the processes that count.
    pub fn pick(&self, numbers: &[f64]) -> Vec<f64> {
        numbers.iter().zip(&self.kept).filter(|(_, kept)| **kept).map(|(&number, _)| number).collect()
    }

    /// Why no time of the experiment counts: the core was at its fastest in too few processes.
    pub fn complaint(&self) -> Option<String> {
        let Self { kept, fastest, .. } = self;
        (*fastest < LEAST).then(|| format!("the core was at its fastest in {fastest} of {} processes, and {LEAST} are needed", kept.len()))
    }
}

/// How far times of the whole machine move from one moment to another: the deviation of their logarithm. Two copies of one program, of each
/// the numbers of the processes that count, differ by their layouts of the memory and move together by this. Zero without copies.
pub fn drift(copies: impl IntoIterator<Item = [Vec<f64>; 2]>) -> f64 {
    let (mut sum, mut freedom) = (0.0, 0.0);
    for copies in copies {
        let [first, second] = copies.map(|numbers| {
            let logs: Vec<f64> = numbers.iter().map(|number| number.ln()).collect();
            let mean = logs.iter().sum::<f64>() / logs.len() as f64;
            logs.into_iter().map(|log| log - mean).collect::<Vec<_>>()
        });
        sum += first.iter().zip(&second).map(|(a, b)| a * b).sum::<f64>();
        freedom += first.len() as f64 - 1.0;
    }
    let variance = sum / freedom;
    if variance > 0.0 { variance.sqrt() } else { 0.0 }
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
