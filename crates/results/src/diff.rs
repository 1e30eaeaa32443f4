//! What changed between two runs beyond noise: a pure function over their rows.

use crate::{Kind, Record, Relation};
use std::collections::BTreeMap;

/// An error has moved when it is this many times larger or smaller: rounding in another order of operations stays below.
pub const ERROR_FACTOR: f64 = 4.0;
/// Errors below this are as good as none: four roundings.
pub const ERROR_FLOOR: f64 = 8.9e-16;
/// Two times differ when their ratio is beyond this, or beyond the A/A controls of their experiments where those are wider.
pub const TIME_NOISE: f64 = 0.02;

/// Reasons of rows whose value does not count begin so.
const VOID: &str = "void: ";

/// In which way a row changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// Its verdict is another.
    Verdict,
    /// Its value, a count, is another.
    Count,
    /// Its error moved by more than [`ERROR_FACTOR`].
    Error,
    /// Its time: the intervals of the two runs are apart, and their ratio is beyond the noise.
    Time,
    /// It is in the first run only.
    Gone,
    /// It is in the second run only.
    New,
}

impl Change {
    /// All of them, in the order of a listing.
    pub const ALL: [Self; 6] = [Self::Verdict, Self::Count, Self::Error, Self::Time, Self::Gone, Self::New];

    /// The word for it.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Verdict => "verdict",
            Self::Count => "count",
            Self::Error => "error",
            Self::Time => "time",
            Self::Gone => "gone",
            Self::New => "new",
        }
    }
}

/// A row that changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Changed<'a> {
    /// In which way.
    pub change: Change,
    /// The row in the first run.
    pub before: Option<&'a Record>,
    /// The row in the second run.
    pub after: Option<&'a Record>,
}

impl Changed<'_> {
    /// The value after over the value before, where both are there.
    pub fn factor(&self) -> Option<f64> {
        Some(self.after?.value? / self.before?.value?)
    }
}

/// What changed, and how much was compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Diff<'a> {
    /// The rows that changed, by kind of change and then in the order of the second run.
    pub changes: Vec<Changed<'a>>,
    /// Rows that are in both runs.
    pub compared: usize,
    /// Times that are void in one of the runs, and so were not compared.
    pub void: usize,
}

/// What tells rows of a run apart. Parameters do not: a time may be taken with other settings and is still the same time.
type Key<'a> = ([&'a str; 9], usize);

/// Compares two runs.
pub fn diff<'a>(before: &'a [Record], after: &'a [Record]) -> Diff<'a> {
    let (old, new) = (keyed(before), keyed(after));
    let (old_intervals, new_intervals) = (Intervals::of(before), Intervals::of(after));
    let old_rows: BTreeMap<&Key, &Record> = old.iter().map(|(key, row)| (key, *row)).collect();
    let new_rows: BTreeMap<&Key, &Record> = new.iter().map(|(key, row)| (key, *row)).collect();
    let mut diff = Diff { changes: Vec::new(), compared: 0, void: 0 };
    for (key, row) in &new {
        let Some(&was) = old_rows.get(key) else {
            diff.changes.push(Changed { change: Change::New, before: None, after: Some(row) });
            continue;
        };
        diff.compared += 1;
        let timed = is_time(row) && was.value.is_some() && row.value.is_some();
        if timed && (is_void(was) || is_void(row) || old_intervals.noise_beside(&new_intervals, row).is_nan()) {
            diff.void += 1;
            continue;
        }
        let change = if was.verdict != row.verdict {
            Some(Change::Verdict)
        } else if timed {
            old_intervals.apart(was, &new_intervals, row).then_some(Change::Time)
        } else {
            moved(was, row)
        };
        diff.changes.extend(change.map(|change| Changed { change, before: Some(was), after: Some(row) }));
    }
    let gone = old.iter().filter(|(key, _)| !new_rows.contains_key(key));
    diff.changes.extend(gone.map(|(_, row)| Changed { change: Change::Gone, before: Some(row), after: None }));
    diff.changes.sort_by_key(|changed| changed.change);
    diff
}

/// Rows with what tells them apart; those that nothing does are numbered.
fn keyed(rows: &[Record]) -> Vec<(Key<'_>, &Record)> {
    let mut seen: BTreeMap<[&str; 9], usize> = BTreeMap::new();
    rows.iter()
        .map(|row| {
            let count = seen.entry(identity(row)).or_default();
            *count += 1;
            ((identity(row), *count), row)
        })
        .collect()
}

fn identity(row: &Record) -> [&str; 9] {
    [&row.study, &row.model, &row.engine, &row.method, &row.scalar, &row.quantity, &row.case, &row.metric, &row.reference]
}

/// Whether a row is a time, or a ratio of times: what has an interval.
fn is_time(row: &Record) -> bool {
    row.kind == Kind::Measured && matches!(row.metric.as_str(), "ns_per_call" | "ratio")
}

fn is_void(row: &Record) -> bool {
    row.reason.starts_with(VOID)
}

/// How an exact value changed, if it did.
fn moved(before: &Record, after: &Record) -> Option<Change> {
    if before.kind == Kind::Measured || after.kind == Kind::Measured {
        return None;
    }
    let (was, is) = (before.value?, after.value?);
    // What has a unit of its own, or must equal its bound, is a count; a pure number is an error.
    let count = after.unit != "1" || after.relation == Some(Relation::Eq);
    if count {
        return (was != is).then_some(Change::Count);
    }
    // NaN.max(x) is x: an error that is no number would be as good as none.
    if was.is_nan() || is.is_nan() {
        return (was.is_nan() != is.is_nan()).then_some(Change::Error);
    }
    let (was, is) = (was.abs().max(ERROR_FLOOR), is.abs().max(ERROR_FLOOR));
    (is > was * ERROR_FACTOR || was > is * ERROR_FACTOR).then_some(Change::Error)
}

/// The intervals of a run's times, and the noise of its experiments.
struct Intervals<'a> {
    ends: BTreeMap<[&'a str; 9], f64>,
    /// By model, quantity and case: how far the control's interval reaches from 1.
    noise: BTreeMap<[&'a str; 3], f64>,
}

impl<'a> Intervals<'a> {
    fn of(rows: &'a [Record]) -> Self {
        let measured = || rows.iter().filter(|row| row.kind == Kind::Measured).filter_map(|row| Some((row, row.value?)));
        let mut noise: BTreeMap<[&str; 3], f64> = BTreeMap::new();
        for (row, value) in measured().filter(|(row, _)| row.metric == "control_low" || row.metric == "control_high") {
            let reach = noise.entry([&row.model, &row.quantity, &row.case]).or_default();
            *reach = larger(*reach, (value - 1.0).abs());
        }
        Self { ends: measured().map(|(row, value)| (identity(row), value)).collect(), noise }
    }

    /// The interval of a time; a time without one is its own.
    fn ends(&self, row: &'a Record) -> (f64, f64) {
        let value = row.value.unwrap_or(f64::NAN);
        let stem = if row.metric == "ratio" { ["ratio_low", "ratio_high"] } else { ["ns_low", "ns_high"] };
        let end = |metric| {
            let mut key = identity(row);
            key[7] = metric;
            self.ends.get(&key).copied().unwrap_or(value)
        };
        (end(stem[0]), end(stem[1]))
    }

    /// The noise of a time in both runs; NaN where a control is no number, and nothing can be told.
    fn noise_beside(&self, after: &Self, row: &Record) -> f64 {
        let key = [row.model.as_str(), row.quantity.as_str(), row.case.as_str()];
        [self.noise.get(&key), after.noise.get(&key)].into_iter().flatten().copied().fold(TIME_NOISE, larger)
    }

    /// Whether two times differ: disjoint intervals, and a ratio beyond the noise of both runs; or one of the two is no number.
    fn apart(&self, before: &'a Record, after: &Self, row: &'a Record) -> bool {
        let (was, is) = (self.ends(before), after.ends(row));
        let noise = self.noise_beside(after, row);
        let disjoint = is.0 > was.1 || is.1 < was.0;
        let (value, other) = (row.value.unwrap_or(f64::NAN), before.value.unwrap_or(f64::NAN));
        let ratio = value / other;
        value.is_nan() != other.is_nan() || disjoint && (ratio > 1.0 + noise || ratio < 1.0 / (1.0 + noise))
    }
}

/// The larger of two numbers; NaN when either is, so that no fold can lose one.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}
