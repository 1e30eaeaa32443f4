//! Counting verdicts.

use featherbench_results::Verdict;

/// How many rows have which verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally([usize; 6]);

/// From the worst to the harmless: a group of rows is called by the first that it holds.
pub const BY_GRAVITY: [Verdict; 6] = [Verdict::Fail, Verdict::Error, Verdict::Deviation, Verdict::Pass, Verdict::Skip, Verdict::Info];

/// Where a verdict stands in [`BY_GRAVITY`].
pub fn gravity(verdict: Verdict) -> usize {
    BY_GRAVITY.iter().position(|&other| other == verdict).unwrap_or(BY_GRAVITY.len() - 1)
}

impl Tally {
    /// Counts verdicts.
    pub fn of(verdicts: impl IntoIterator<Item = Verdict>) -> Self {
        let mut tally = Self::default();
        verdicts.into_iter().for_each(|verdict| tally.add(verdict));
        tally
    }

    /// Counts one more.
    pub fn add(&mut self, verdict: Verdict) {
        self.0[gravity(verdict)] += 1;
    }

    /// How many have this verdict.
    pub fn get(&self, verdict: Verdict) -> usize {
        self.0[gravity(verdict)]
    }

    /// All of them.
    pub fn total(&self) -> usize {
        self.0.iter().sum()
    }

    /// How many were due and not kept: failures and errors.
    pub fn broken(&self) -> usize {
        self.get(Verdict::Fail) + self.get(Verdict::Error)
    }

    /// The verdict of the whole group.
    pub fn verdict(&self) -> Verdict {
        BY_GRAVITY.into_iter().find(|&verdict| self.get(verdict) > 0).unwrap_or(Verdict::Info)
    }

    /// `12 passed, 1 failed`, leaving out what there is none of.
    pub fn words(&self) -> String {
        let parts: Vec<String> = BY_GRAVITY
            .into_iter()
            .filter(|&verdict| self.get(verdict) > 0)
            .map(|verdict| format!("{} {}", self.get(verdict), crate::labels::verdict(verdict)))
            .collect();
        parts.join(", ")
    }
}
