//! The changes between two runs beyond noise: a pure function of their rows.

use crate::names::words;
use crate::{Kind, Relation, Row};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// An error has changed if it is this many times larger or smaller: rounding in another order of operations causes less.
pub const ERROR_FACTOR: f64 = 4.0;
/// Errors below this count as zero: four roundings.
pub const ERROR_FLOOR: f64 = 8.9e-16;
/// Two times differ if their ratio is beyond this, or beyond the A/A ratios of their experiments if those are wider.
pub const TIME_NOISE: f64 = 0.02;

words! {
    /// The kind of a change, in the order of a listing.
    Change {
        /// The verdict differs.
        Verdict = "verdict",
        /// The value, a count, differs.
        Count = "count",
        /// The error changed by more than [`ERROR_FACTOR`].
        Error = "error",
        /// Its time: the intervals of the two runs are apart, and their ratio is beyond the noise.
        Time = "time",
        /// It is in the first run only.
        Gone = "gone",
        /// It is in the second run only.
        New = "new",
    }
}

/// A row that changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Changed<'a> {
    /// The kind of change.
    pub change: Change,
    /// The row in the first run.
    pub before: Option<&'a Row>,
    /// The row in the second run.
    pub after: Option<&'a Row>,
}

impl Changed<'_> {
    /// The value after over the value before, if both exist.
    pub fn factor(&self) -> Option<f64> {
        Some(self.after?.value? / self.before?.value?)
    }
}

/// The changes, and how many rows were compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Diff<'a> {
    /// The rows that changed, by kind of change and then from the largest factor.
    pub changes: Vec<Changed<'a>>,
    /// Rows that are in both runs.
    pub compared: usize,
    /// Times that are not valid in one of the runs, and so were not compared.
    pub invalid: usize,
}

/// The columns that identify a row in a run. Parameters are not among them: the same time may be taken with other settings.
pub(crate) type Key<'a> = ([&'a str; 11], usize);

/// Compares two runs.
pub fn diff<'a>(before: &'a [Row], after: &'a [Row]) -> Diff<'a> {
    let (old, new) = (keyed(before), keyed(after));
    let (old_noise, new_noise) = (Noise::of(before), Noise::of(after));
    let old_rows: BTreeMap<&Key, &Row> = old.iter().map(|(key, row)| (key, *row)).collect();
    let new_rows: BTreeMap<&Key, &Row> = new.iter().map(|(key, row)| (key, *row)).collect();
    let mut diff = Diff { changes: Vec::new(), compared: 0, invalid: 0 };
    for (key, row) in &new {
        let Some(&was) = old_rows.get(key) else {
            diff.changes.push(Changed { change: Change::New, before: None, after: Some(row) });
            continue;
        };
        diff.compared += 1;
        let timed = is_time(row) && was.value.is_some() && row.value.is_some();
        if timed && (!was.valid || !row.valid || old_noise.beside(&new_noise, row).is_nan()) {
            diff.invalid += 1;
            continue;
        }
        let change = if was.verdict != row.verdict {
            Some(Change::Verdict)
        } else if timed {
            apart(was, row, old_noise.beside(&new_noise, row)).then_some(Change::Time)
        } else {
            moved(was, row)
        };
        diff.changes.extend(change.map(|change| Changed { change, before: Some(was), after: Some(row) }));
    }
    let gone = old.iter().filter(|(key, _)| !new_rows.contains_key(key));
    diff.changes.extend(gone.map(|(_, row)| Changed { change: Change::Gone, before: Some(row), after: None }));
    // A factor has no size where a value is zero or missing: those come first.
    let size = |changed: &Changed| changed.factor().map_or(f64::INFINITY, |factor| factor.abs().ln().abs());
    let larger = |a: &Changed, b: &Changed| size(b).total_cmp(&size(a));
    diff.changes.sort_by(|a, b| a.change.cmp(&b.change).then_with(|| larger(a, b)));
    diff
}

/// Rows with the columns that identify them. Rows that have the same columns are numbered.
pub(crate) fn keyed(rows: &[Row]) -> Vec<(Key<'_>, &Row)> {
    let mut seen: BTreeMap<[&str; 11], usize> = BTreeMap::new();
    rows.iter()
        .map(|row| {
            let count = seen.entry(identity(row)).or_default();
            *count += 1;
            ((identity(row), *count), row)
        })
        .collect()
}

fn identity(row: &Row) -> [&str; 11] {
    [
        &row.study,
        &row.robot,
        &row.engine,
        &row.method,
        &row.precision,
        &row.quantity,
        &row.states,
        &row.body,
        &row.cache,
        &row.metric,
        &row.reference,
    ]
}

/// Whether a row is a time, or a ratio of times: rows with an interval.
pub(crate) fn is_time(row: &Row) -> bool {
    row.kind == Kind::Measured && matches!(row.metric.as_str(), "ns_per_call" | "ratio")
}

/// Whether an exact value is a count: it has a unit, or must equal its bound. Any other pure number is an error.
pub(crate) fn is_count(row: &Row) -> bool {
    row.unit != "1" || row.relation == Some(Relation::Eq)
}

/// The kind of change of an exact value, if it changed.
fn moved(before: &Row, after: &Row) -> Option<Change> {
    if before.kind == Kind::Measured || after.kind == Kind::Measured {
        return None;
    }
    let (was, is) = (before.value?, after.value?);
    if is_count(after) {
        return (was != is).then_some(Change::Count);
    }
    // NaN.max(x) is x: a NaN would count as zero.
    if was.is_nan() || is.is_nan() {
        return (was.is_nan() != is.is_nan()).then_some(Change::Error);
    }
    let (was, is) = (was.abs().max(ERROR_FLOOR), is.abs().max(ERROR_FLOOR));
    (is > was * ERROR_FACTOR || was > is * ERROR_FACTOR).then_some(Change::Error)
}

/// The noise of a run's experiments by robot, quantity and cache: the larger distance of the A/A interval's ends from 1.
pub(crate) struct Noise<'a>(BTreeMap<[&'a str; 3], f64>);

impl<'a> Noise<'a> {
    pub(crate) fn of(rows: &'a [Row]) -> Self {
        let mut noise: BTreeMap<[&str; 3], f64> = BTreeMap::new();
        for row in rows.iter().filter(|row| row.kind == Kind::Measured && row.metric == "control") {
            let reach = noise.entry([&row.robot, &row.quantity, &row.cache]).or_default();
            *reach = [row.ci_low, row.ci_high].into_iter().flatten().fold(*reach, |reach, end| larger(reach, (end - 1.0).abs()));
        }
        Self(noise)
    }

    /// The noise of a time in this run; NaN if it is not known.
    pub(crate) fn of_row(&self, row: &Row) -> f64 {
        self.beside(self, row)
    }

    /// The noise of a time in both runs; NaN if an A/A ratio is NaN, and the noise is not known.
    fn beside(&self, after: &Self, row: &Row) -> f64 {
        let key = [row.robot.as_str(), row.quantity.as_str(), row.cache.as_str()];
        [self.0.get(&key), after.0.get(&key)].into_iter().flatten().copied().fold(TIME_NOISE, larger)
    }
}

/// The interval of a time; without one, the time itself.
pub(crate) fn interval(row: &Row) -> (f64, f64) {
    let value = row.value.unwrap_or(f64::NAN);
    (row.ci_low.unwrap_or(value), row.ci_high.unwrap_or(value))
}

/// Whether two times differ: disjoint intervals, and a ratio beyond the noise of both runs; or one of the two is NaN.
fn apart(before: &Row, after: &Row, noise: f64) -> bool {
    let (was, is) = (interval(before), interval(after));
    let disjoint = is.0 > was.1 || is.1 < was.0;
    let (value, other) = (after.value.unwrap_or(f64::NAN), before.value.unwrap_or(f64::NAN));
    let ratio = value / other;
    value.is_nan() != other.is_nan() || disjoint && (ratio > 1.0 + noise || ratio < 1.0 / (1.0 + noise))
}

/// The larger of two numbers; NaN when either is, so that a fold keeps every NaN.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}
