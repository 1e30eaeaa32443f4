//! Findings, in sentences: whether the run passed, and which engines fail on what.

use std::collections::BTreeMap;

use featherbench_results::{Row, RunInfo, Verdict};

use crate::labels;
use crate::numbers::{count, grouped, listed, short};
use crate::section::Section;
use crate::tally::{Tally, severity};

/// The state of a run in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every judged row is inside its gate and every expectation is met.
    Passed,
    /// A row failed or gave no answer, or an expectation is not met.
    Failed,
    /// No row was judged.
    Empty,
}

/// An engine that failed gates on a quantity.
pub struct Failure<'a> {
    /// The engine.
    pub engine: &'a str,
    /// The reference; empty if nothing was compared.
    pub reference: &'a str,
    /// The quantity.
    pub quantity: &'a str,
    /// All its judged rows there.
    pub tally: Tally,
    /// The row that is worst.
    pub worst: &'a Row,
}

/// The contents of the head of the page.
pub struct Findings<'a> {
    /// The run as a whole.
    pub status: Status,
    /// Verdicts of all rows.
    pub tally: Tally,
    /// Expectations that are not met.
    pub unmet: usize,
    /// The engines that fail gates, worst first.
    pub failures: Vec<Failure<'a>>,
    /// The passing row that is closest to its gate.
    pub closest: Option<&'a Row>,
}

impl<'a> Findings<'a> {
    /// Collects a run's rows. Failures about which a section tells itself are not collected again.
    pub fn of(run: &RunInfo, rows: &'a [Row], sections: &[Section]) -> Self {
        let tally = Tally::of(rows.iter().map(|row| row.verdict));
        let unmet = run
            .expected
            .iter()
            .filter(|condition| !matches!(condition.verdict, Verdict::Pass | Verdict::Deviation | Verdict::Info))
            .count();
        let judged = tally.total() - tally.get(Verdict::Info) - tally.get(Verdict::Skip);
        let status = if tally.broken() + unmet > 0 {
            Status::Failed
        } else if judged == 0 {
            Status::Empty
        } else {
            Status::Passed
        };
        let passing = rows.iter().filter(|row| row.verdict == Verdict::Pass && row.margin.is_some());
        Self { status, tally, unmet, failures: failures(rows, sections), closest: passing.min_by_key(|row| severity(row)) }
    }

    /// The first line of the page.
    pub fn headline(&self) -> String {
        let judged = self.tally.total() - self.tally.get(Verdict::Info) - self.tally.get(Verdict::Skip);
        match self.status {
            Status::Empty => "Nothing was judged in this run".into(),
            Status::Passed => match self.tally.get(Verdict::Deviation) {
                0 if judged == 1 => "The one judged row is inside its gate".into(),
                0 => format!("All {} are inside their gates", count(judged, "judged row")),
                known => {
                    format!("{} are inside their gates, {} by known cause", count(judged - known, "judged row"), count(known, "deviation"))
                }
            },
            Status::Failed => {
                let mut parts = Vec::new();
                match self.tally.get(Verdict::Fail) {
                    0 => {}
                    failed => parts.push(format!("{} of {} outside their gates", count(failed, "row"), grouped(judged))),
                }
                match self.tally.get(Verdict::Error) {
                    0 => {}
                    errors => parts.push(format!("{} without an answer", grouped(errors))),
                }
                match self.unmet {
                    0 => {}
                    unmet => parts.push(format!("{} not met", count(unmet, "expectation"))),
                }
                listed(&parts)
            }
        }
    }
}

impl Failure<'_> {
    /// `3 of 124 rows of forward dynamics fail against featherbench`.
    pub fn sentence(&self) -> String {
        let quantity = labels::quantity(self.quantity);
        let total = self.tally.total();
        let mut parts = Vec::new();
        if self.tally.get(Verdict::Fail) > 0 {
            let against = if self.reference.is_empty() { String::new() } else { format!(" against {}", self.reference) };
            parts.push(format!("fails {} of {}{against}", self.tally.get(Verdict::Fail), count(total, "row")));
        }
        if self.tally.get(Verdict::Error) > 0 {
            parts.push(format!("gives no answer in {} of {}", self.tally.get(Verdict::Error), count(total, "row")));
        }
        format!("{quantity}: {}", listed(&parts))
    }

    /// `chain_10, fast, forward 3.0e-9 over 1.0e-12`, or why there is no number.
    pub fn worst_words(&self) -> String {
        let row = self.worst;
        let mut parts: Vec<String> =
            [&row.robot, &row.body, &row.states, &row.cache, &row.method].into_iter().filter(|part| !part.is_empty()).cloned().collect();
        match (row.value, row.bound) {
            (Some(value), Some(bound)) => parts.push(format!("{} {} where {} is allowed", row.metric, short(value), short(bound))),
            _ => parts.push(row.reason.clone()),
        }
        parts.join(", ")
    }
}

fn failures<'a>(rows: &'a [Row], sections: &[Section]) -> Vec<Failure<'a>> {
    let mut found: BTreeMap<(&str, &str, &str), Failure> = BTreeMap::new();
    let told: Vec<&str> =
        sections.iter().filter_map(|section| section.finding.as_ref()).flat_map(|finding| finding.told).copied().collect();
    let told_here = |row: &&Row| !told.contains(&row.study.as_str()) && !matches!(row.verdict, Verdict::Info | Verdict::Skip);
    for row in rows.iter().filter(told_here) {
        let group = found.entry((&row.engine, &row.reference, &row.quantity)).or_insert_with(|| Failure {
            engine: &row.engine,
            reference: &row.reference,
            quantity: &row.quantity,
            tally: Tally::default(),
            worst: row,
        });
        group.tally.add(row.verdict);
        if severity(row) < severity(group.worst) {
            group.worst = row;
        }
    }
    let mut broken: Vec<Failure> = found.into_values().filter(|group| group.tally.broken() > 0).collect();
    broken.sort_by_key(|group| severity(group.worst));
    broken
}
