//! Known deviations, as data: answers that miss their gate for a known cause, questions that an engine does not offer, and reproductions
//! that show a deviation alone.

use crate::RangeKey;
use featherbench_results::{Row, Verdict};
use serde::Deserialize;

/// Seeds over which the size of a deviation is measured.
pub const SEEDS: u64 = 20;
/// The largest factor between a value and its range. Another draw, or another processor's rounding, causes little more.
pub const SLACK: f64 = 2.0;

/// A known deviation: rows that match may fail or be errors, as `verdict` says.
///
/// The cause is given here, for a class of robots. The size of a failure is given for each robot in [`Ranges`](crate::Ranges).
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Deviation {
    /// The engine.
    pub engine: String,
    /// The engine's version; the deviation does not apply to other versions.
    pub version: String,
    /// The method, or all of them.
    pub method: Option<String>,
    /// The quantities, or all of them.
    pub quantities: Option<Vec<String>>,
    /// The robots: names; a trailing `*` stands for any rest.
    pub robots: Vec<String>,
    /// The states, or all of them.
    pub states: Option<Vec<String>>,
    /// The verdict that it explains: fail or error.
    pub verdict: String,
    /// The cause.
    pub reason: String,
    /// The reproduction that shows the cause alone, if there is one.
    pub reproduction: Option<String>,
}

/// Something that an engine does not offer: its rows stay skips with a known cause.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NotOffered {
    /// The engine.
    pub engine: String,
    /// The engine's version; in another version it may be offered.
    pub version: String,
    /// The quantities, or all of them.
    pub quantities: Option<Vec<String>>,
    /// The robots: names; a trailing `*` stands for any rest.
    pub robots: Vec<String>,
    /// The states, or all of them.
    pub states: Option<Vec<String>>,
    /// The study, or all of them.
    pub study: Option<String>,
    /// Why it is not offered.
    pub reason: String,
}

/// A program that shows a deviation alone: `deviation` of the module `featherbench_oracles.ENGINE.reproductions.NAME`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reproduction {
    /// The file's name without its extension.
    pub name: String,
    /// The engine.
    pub engine: String,
    /// The version for which the range was measured.
    pub version: String,
    /// When the deviation occurs, one sentence.
    pub condition: String,
    /// The meaning of its value.
    pub measure: String,
    /// Smallest and largest value over [`SEEDS`] seeds.
    pub range: [f64; 2],
    /// The public thread about it, or the text `none found`.
    pub upstream: String,
}

impl Deviation {
    /// Whether it is about this row: engine, version, method, quantity, robot and states. Value and verdict do not matter.
    pub fn is_about(&self, row: &Row) -> bool {
        self.version == row.engine_version && self.method.as_ref().is_none_or(|method| *method == row.method) && self.concerns(row)
    }

    /// Whether it is about failures, whose size is measured.
    pub fn is_measured(&self) -> bool {
        self.verdict == Verdict::Fail.as_str()
    }

    /// Whether a range may belong to it.
    pub fn has(&self, key: &RangeKey) -> bool {
        self.is_measured()
            && self.engine == key.engine
            && self.version == key.version
            && self.method.as_ref().is_none_or(|method| *method == key.method)
            && self.quantities.as_ref().is_none_or(|quantities| quantities.contains(&key.quantity))
            && named(&self.robots, &key.robot)
    }

    /// Whether it explains that a row is an error.
    pub(crate) fn explains_error(&self, row: &Row) -> bool {
        row.verdict == Verdict::Error && self.verdict == Verdict::Error.as_str() && self.is_about(row)
    }

    /// Whether it is about the engine, robot, quantity and states of this row, for any method and any version.
    pub(crate) fn concerns(&self, row: &Row) -> bool {
        concerns(&self.engine, self.quantities.as_deref(), &self.robots, self.states.as_deref(), row)
    }

    /// Whether it is the cause of a row's verdict.
    pub(crate) fn excused(&self, row: &Row) -> bool {
        row.verdict == Verdict::Deviation && row.reason.starts_with(&self.reason) && self.is_about(row)
    }
}

impl NotOffered {
    /// Whether it explains why a row is a skip.
    pub(crate) fn explains(&self, row: &Row) -> bool {
        row.verdict == Verdict::Skip && self.version == row.engine_version && self.concerns(row)
    }

    /// Whether it is about the engine, robot, study, quantity and states of this row, for any version.
    pub(crate) fn concerns(&self, row: &Row) -> bool {
        self.study.as_ref().is_none_or(|study| *study == row.study)
            && concerns(&self.engine, self.quantities.as_deref(), &self.robots, self.states.as_deref(), row)
    }
}

fn concerns(engine: &str, quantities: Option<&[String]>, robots: &[String], states: Option<&[String]>, row: &Row) -> bool {
    engine == row.engine
        && named(robots, &row.robot)
        && quantities.is_none_or(|quantities| quantities.contains(&row.quantity))
        && states.is_none_or(|states| states.contains(&row.states))
}

/// Whether a list of names contains a name; a trailing `*` stands for any rest.
pub(crate) fn named(names: &[String], name: &str) -> bool {
    names.iter().any(|known| known.strip_suffix('*').map_or(known == name, |stem| name.starts_with(stem)))
}
