//! Raw samples: the data of an experiment, as the outcome of its cell and as a line of the run's side file.

use super::Paired;
use featherbench_bench::statistics::{Estimate, Steady, quietest, undisturbed};
use featherbench_bench::{Finished, Outcome, Quantity};
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The blocks of an experiment: nanoseconds per call, of every candidate in every round.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Samples {
    /// Calls in a block of each candidate.
    pub calls: Vec<usize>,
    rounds: usize,
    /// Candidate after candidate, each round by round; NaN where there was none. Then how crowded the core was, round by round.
    ns: Vec<f64>,
}

impl Samples {
    /// Memory for the blocks of candidates with these calls.
    pub fn new(calls: Vec<usize>, rounds: usize) -> Self {
        Self { ns: vec![f64::NAN; (calls.len() + 1) * rounds], calls, rounds }
    }

    /// Stores a block.
    pub fn set(&mut self, candidate: usize, round: usize, ns: f64) {
        self.ns[candidate * self.rounds + round] = ns;
    }

    /// Stores how crowded the core was in a round.
    pub fn crowded(&mut self, round: usize, contention: f64) {
        self.set(self.calls.len(), round, contention);
    }

    /// A candidate's blocks, round by round.
    pub fn of(&self, candidate: usize) -> &[f64] {
        &self.ns[candidate * self.rounds..(candidate + 1) * self.rounds]
    }

    /// How crowded the core was, round by round.
    pub fn contention(&self) -> &[f64] {
        self.of(self.calls.len())
    }

    /// As the outcome of a cell: the number of candidates, their calls, their blocks, how crowded the core was.
    pub fn to_values(&self) -> Vec<f64> {
        let calls = self.calls.iter().map(|&calls| calls as f64);
        std::iter::once(self.calls.len() as f64).chain(calls).chain(self.ns.iter().copied()).collect()
    }

    /// Samples from the outcome of a cell; `None` if the numbers are not samples.
    pub fn from_values(values: &[f64]) -> Option<Self> {
        let (&candidates, rest) = values.split_first()?;
        let candidates = candidates as usize;
        let (calls, ns) = rest.split_at_checked(candidates)?;
        let series = candidates + 1;
        let whole = candidates > 0 && ns.len().is_multiple_of(series);
        whole.then(|| Self { calls: calls.iter().map(|&calls| calls as usize).collect(), rounds: ns.len() / series, ns: ns.to_vec() })
    }

    /// The samples of one process of an experiment with so many candidates.
    pub fn of_outcome(outcome: &Outcome, candidates: usize) -> Option<Self> {
        Self::from_values(outcome.values()?).filter(|samples| samples.calls.len() == candidates)
    }
}

/// The blocks of an experiment, process by process.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Processes {
    samples: Vec<Samples>,
    /// Of each candidate, its number of each process; NaN where it has none.
    numbers: Vec<Vec<f64>>,
    /// The processes that count.
    pub steady: Steady,
}

/// How crowded the core was in the quietest rounds of these processes.
pub(crate) fn quietest_of<'s>(samples: impl Iterator<Item = &'s Samples>) -> f64 {
    quietest(&samples.flat_map(Samples::contention).copied().collect::<Vec<_>>())
}

impl Processes {
    /// Of the blocks of each of the processes; the core was alone where it was about as crowded as this.
    pub fn new(samples: Vec<Samples>, quietest: f64) -> Self {
        let candidates = samples.first().map_or(0, |samples| samples.calls.len());
        let steady = Steady::of(samples.iter().map(Samples::contention), quietest);
        let of = |which| (0..).zip(&samples).map(|(process, samples)| undisturbed(&steady.blocks(process, samples.of(which)))).collect();
        let numbers = (0..candidates).map(of).collect();
        Self { samples, numbers, steady }
    }

    /// A candidate's time, in runs of a machine with this drift.
    pub fn time(&self, which: usize, drift: f64) -> Estimate {
        Estimate::time(&self.numbers[which], &self.steady).drifting(drift)
    }

    /// The ratio of a candidate's time to another's.
    pub fn ratio(&self, which: usize, over: usize) -> Estimate {
        Estimate::ratio(&self.numbers[which], &self.numbers[over], &self.steady)
    }

    /// The numbers of a candidate and of the first one, of the processes that count: two copies of one program say how the machine drifts.
    pub fn beside_the_first(&self, which: usize) -> [Vec<f64>; 2] {
        [which, 0].map(|which| self.steady.pick(&self.numbers[which]))
    }

    /// Whether a candidate answered to the last round of the last process.
    pub fn answered(&self, which: usize) -> bool {
        self.samples.iter().all(|samples| samples.of(which).iter().all(|block| !block.is_nan()))
    }

    /// The blocks of a candidate in all processes, also of those that do not count.
    pub fn all(&self, which: usize) -> Vec<f64> {
        self.samples.iter().flat_map(|samples| samples.of(which)).copied().collect()
    }
}

/// A candidate of an experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Candidate {
    /// The engine's name.
    pub engine: String,
    /// Its version.
    pub version: String,
    /// What it answers: the experiment's quantity, or the same in another precision.
    pub quantity: String,
    /// Its method.
    pub method: String,
    /// Whether it is the A/A replicate.
    pub control: bool,
    /// Whether its times are estimates.
    pub estimate: bool,
}

impl Candidate {
    /// The arithmetic of its answers.
    pub fn precision(&self) -> &'static str {
        Quantity::parse(&self.quantity).map_or("f64", Quantity::precision)
    }
}

/// The raw samples of every experiment as lines of JSON. Each has cell, robot, quantity, cache regime, process, candidate, and calls of a block.
/// Then come the nanoseconds per call of its blocks, round by round (`null` where there is none). The last line of a process tells how
/// crowded the core was in each round.
pub(super) fn lines(finished: &[Finished]) -> String {
    let mut text = String::new();
    for (cell, outcome) in finished {
        let Some(Paired { cache, process, candidates, .. }) = Paired::of(cell) else { continue };
        let Some(samples) = Samples::of_outcome(outcome, candidates.len()) else { continue };
        for (which, candidate) in candidates.iter().enumerate() {
            // A tenth of a picosecond is far below the resolution of a clock; the outcomes keep every bit.
            let ns: Vec<Option<f64>> = samples.of(which).iter().map(|ns| ns.is_finite().then(|| (ns * 1e4).round() / 1e4)).collect();
            let line = json!({
                "cell": cell.id(), "model": cell.robot, "quantity": candidate.quantity, "cache": cache, "process": process,
                "engine": candidate.engine, "method": candidate.method, "control": candidate.control, "estimate": candidate.estimate,
                "calls": samples.calls[which], "ns": ns,
            });
            text += &line.to_string();
            text.push('\n');
        }
        let contention: Vec<f64> = samples.contention().iter().map(|number| (number * 1e4).round() / 1e4).collect();
        let line = json!({
            "cell": cell.id(), "model": cell.robot, "quantity": cell.quantity, "cache": cache, "process": process, "contention": contention,
        });
        text += &line.to_string();
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_survive_being_an_outcome() {
        let mut samples = Samples::new(vec![7, 1], 3);
        samples.set(1, 2, 5.5);
        samples.crowded(1, 1.3);
        let again = Samples::from_values(&samples.to_values()).unwrap();
        assert_eq!(again.calls, [7, 1]);
        assert_eq!(again.of(1)[2], 5.5);
        assert!(again.of(0).iter().chain(&again.of(1)[..2]).all(|ns| ns.is_nan()));
        assert!(again.contention()[1] == 1.3 && again.contention()[0].is_nan());
        for damaged in [&[][..], &[2.0], &[2.0, 7.0], &[2.0, 7.0, 1.0, 0.5], &[0.0]] {
            assert_eq!(Samples::from_values(damaged), None, "{damaged:?}");
        }
    }
}
