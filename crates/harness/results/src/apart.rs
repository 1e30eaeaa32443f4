//! Two suites that differ: what only one of two runs has is no change.

use crate::{Change, Changed, Diff, RunInfo};

/// How many rows only one of two runs has whose suites differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Apart {
    /// The names of the suites.
    pub suites: [String; 2],
    /// Rows of the first run alone, and of the second.
    pub only: [usize; 2],
}

impl Apart {
    /// Takes rows of one run alone out of the changes, if the suites differ by name or by content.
    pub fn of(before: &RunInfo, after: &RunInfo, found: &mut Diff) -> Option<Self> {
        if before.suite == after.suite && before.suite_hash == after.suite_hash {
            return None;
        }
        let count = |change: Change| found.changes.iter().filter(|changed| changed.change == change).count();
        let only = [count(Change::Gone), count(Change::New)];
        found.changes.retain(|changed| !changed.is_unmatched());
        Some(Self { suites: [before.suite.clone(), after.suite.clone()], only })
    }

    /// All of it in one sentence, without its point.
    pub fn sentence(&self) -> String {
        let ([a, b], [gone, new]) = (&self.suites, self.only);
        let what = if a == b {
            format!("the suite '{a}' changed between the two runs")
        } else {
            format!("the runs are of two suites, '{a}' and '{b}'")
        };
        format!("{what}: {gone} rows are in the first run only and {new} in the second only")
    }
}

impl Changed<'_> {
    /// Whether only one of the two runs has it.
    pub fn is_unmatched(&self) -> bool {
        matches!(self.change, Change::Gone | Change::New)
    }
}
