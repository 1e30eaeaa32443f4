//! Verdicts: how many rows have which, and which row is worst.

use featherbench_results::{Row, Verdict};

use crate::labels;

/// The number of rows with each verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally([usize; 6]);

/// From the worst to the harmless: a group of rows has the first verdict that occurs in it.
pub const BY_GRAVITY: [Verdict; 6] = [Verdict::Fail, Verdict::Error, Verdict::Deviation, Verdict::Pass, Verdict::Skip, Verdict::Info];

/// The position of a verdict in [`BY_GRAVITY`].
pub fn gravity(verdict: Verdict) -> usize {
    BY_GRAVITY.iter().position(|&other| other == verdict).unwrap_or(BY_GRAVITY.len() - 1)
}

/// Orders rows from the worst: by verdict, then by margin. A failure without a margin is the worst.
pub fn worst_first(row: &Row) -> (usize, i64) {
    let unknown = if matches!(row.verdict, Verdict::Fail | Verdict::Error) { i64::MIN } else { i64::MAX };
    // Margins are within ±16: millionths of decades order them like the numbers themselves.
    (gravity(row.verdict), row.margin.map_or(unknown, |margin| (margin * 1e6) as i64))
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

    /// The number of rows with this verdict.
    pub fn get(&self, verdict: Verdict) -> usize {
        self.0[gravity(verdict)]
    }

    /// All of them.
    pub fn total(&self) -> usize {
        self.0.iter().sum()
    }

    /// The number of failures and errors.
    pub fn broken(&self) -> usize {
        self.get(Verdict::Fail) + self.get(Verdict::Error)
    }

    /// The verdict of the whole group.
    pub fn verdict(&self) -> Verdict {
        BY_GRAVITY.into_iter().find(|&verdict| self.get(verdict) > 0).unwrap_or(Verdict::Info)
    }

    /// `12 passed, 1 failed`, without verdicts that do not occur.
    pub fn words(&self) -> String {
        let parts: Vec<String> = BY_GRAVITY
            .into_iter()
            .filter(|&verdict| self.get(verdict) > 0)
            .map(|verdict| format!("{} {}", self.get(verdict), labels::verdict(verdict)))
            .collect();
        parts.join(", ")
    }
}
