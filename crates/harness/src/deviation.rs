//! Known deviations, as data: rows that are no pass for a cause that is known, and reproductions that show such a cause by itself.

use record::{Record, Verdict};
use serde::Deserialize;

/// Seeds over which the range of a deviation is measured.
pub const SEEDS: u64 = 20;
/// How far outside its range a value may lie, as a factor: a twenty-first draw, or another processor's rounding, moves it by little more.
pub const SLACK: f64 = 2.0;

/// A known deviation: rows that match may fail, be skipped or be errors, as it says.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Deviation {
    /// The engine.
    pub engine: String,
    /// The engine's version; another version makes the deviation void.
    pub version: String,
    /// The method, or all of them.
    pub method: Option<String>,
    /// The quantities, or all of them.
    pub quantities: Option<Vec<String>>,
    /// The models: names, a trailing `*` standing for any rest.
    pub models: Vec<String>,
    /// The cases, or all of them.
    pub cases: Option<Vec<String>>,
    /// The verdict that it explains: fail, skip or error.
    pub verdict: String,
    /// The cause.
    pub reason: String,
    /// Smallest and largest of the worst values of [`SEEDS`] runs, each with other states. A value beyond it stays a failure, and a thorough
    /// run whose worst value lies below it fails the gate; both by more than [`SLACK`].
    pub range: Option<[f64; 2]>,
    /// The reproduction that shows the cause by itself, where there is one.
    pub reproduction: Option<String>,
}

/// A program that shows a deviation by itself: `oracles/reproductions/NAME.py`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reproduction {
    /// The file's name without its ending.
    pub name: String,
    /// The engine.
    pub engine: String,
    /// The version for which the range was measured.
    pub version: String,
    /// When it shows, one sentence.
    pub condition: String,
    /// What its value is.
    pub measure: String,
    /// Smallest and largest value over [`SEEDS`] seeds.
    pub range: [f64; 2],
    /// The public thread about it, or the words `none found`.
    pub upstream: String,
}

impl Deviation {
    pub(crate) fn explains(&self, row: &Record) -> bool {
        self.verdict == row.verdict.as_str() && self.covers(row)
    }

    /// Whether it is about this row and its value, whatever became of it.
    pub(crate) fn covers(&self, row: &Record) -> bool {
        let within = |value: f64| self.range.is_none_or(|[_, high]| value <= SLACK * high);
        self.is_about(row) && row.value.is_none_or(within)
    }

    /// Whether it is about this row, of whatever size its value is.
    fn is_about(&self, row: &Record) -> bool {
        self.version == row.engine_version && self.method.as_ref().is_none_or(|method| *method == row.method) && self.concerns(row)
    }

    /// Whether it is about the engine, robot, quantity and case of this row, by whatever method and in whatever version.
    pub(crate) fn concerns(&self, row: &Record) -> bool {
        self.engine == row.engine
            && named(&self.models, &row.model)
            && self.quantities.as_ref().is_none_or(|quantities| quantities.contains(&row.quantity))
            && self.cases.as_ref().is_none_or(|cases| cases.contains(&row.case))
    }

    /// The worst value of the rows of a run that it explains, or would if they were smaller.
    pub fn worst(&self, records: &[Record]) -> Option<f64> {
        let broken = |row: &&Record| matches!(row.verdict, Verdict::Fail | Verdict::Deviation) && row.bound.is_some() && self.is_about(row);
        records.iter().filter(broken).filter_map(|row| row.value).reduce(crate::measure::worst)
    }

    /// Whether a row is there because of it.
    pub(crate) fn excused(&self, row: &Record) -> bool {
        row.verdict == Verdict::Deviation && row.reason.starts_with(&self.reason) && self.covers(row)
    }
}

/// Whether a list of names, a trailing `*` standing for any rest, holds a name.
pub(crate) fn named(names: &[String], name: &str) -> bool {
    names.iter().any(|known| known.strip_suffix('*').map_or(known == name, |stem| name.starts_with(stem)))
}
