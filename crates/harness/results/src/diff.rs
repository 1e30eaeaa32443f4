//! The changes between two runs beyond noise: a pure function of their rows.

use crate::names::words;
use crate::{Kind, Relation, Row};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// An error has changed if it is this many times larger or smaller: rounding in another order of operations causes less.
pub const ERROR_FACTOR: f64 = 4.0;
/// Errors below this count as zero: four roundings.
pub const ERROR_FLOOR: f64 = 8.9e-16;
/// Two times differ if their ratio is beyond this, and chance is not a likely cause.
pub const TIME_NOISE: f64 = 0.01;
/// Half-widths of the intervals of times are so many standard errors: the 0.975 quantile of Student's distribution with seven degrees of
/// freedom, of ten processes without the least and the largest. Intervals hold 95 %. Of fewer processes they are wider, and their errors count
/// as larger.
pub const STUDENT: f64 = 2.364_624_251_592_784_4;
/// The 0.975 quantile of the normal distribution: the half-width of an interval over a deviation that is known.
pub const NORMAL: f64 = 1.959_963_984_540_054_2;
/// The share of the times that are told as changed, and changed by chance alone, is on average at most this.
///
/// Every time has its *p-value*: how likely chance makes a difference as large, by Student's distribution with 14 degrees of freedom. From the
/// smallest on, the k-th of n counts as changed if it, or a later one, is at most k/n of this share (Benjamini and Hochberg, J. R. Stat. Soc. B
/// 57, 1995). So one slower time among hundreds needs more evidence than a hundred slower ones.
pub const FALSE_SHARE: f64 = 0.05;
/// The fewest times of which a common factor is formed.
pub const COMMON: usize = 20;

words! {
    /// The kind of a change, in the order of a listing.
    Change {
        /// The verdict differs.
        Verdict = "verdict",
        /// The value, a count, differs.
        Count = "count",
        /// The error changed by more than [`ERROR_FACTOR`].
        Error = "error",
        /// Its time: the ratio, over the factor that all times have in common, is beyond the noise and beyond chance.
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
    /// The factor that the times of the two runs have in common: the machine's, or that of a change to everything. Times are compared over it,
    /// ratios as they are. 1 with fewer than [`COMMON`] times.
    pub common: f64,
}

/// The columns that identify a row in a run. Parameters are not among them: the same time may be taken with other settings.
pub(crate) type Key<'a> = ([&'a str; 11], usize);

/// Compares two runs.
pub fn diff<'a>(before: &'a [Row], after: &'a [Row]) -> Diff<'a> {
    let (old, new) = (keyed(before), keyed(after));
    let old_rows: BTreeMap<&Key, &Row> = old.iter().map(|(key, row)| (key, *row)).collect();
    let new_rows: BTreeMap<&Key, &Row> = new.iter().map(|(key, row)| (key, *row)).collect();
    let both = || new.iter().filter_map(|(key, row)| Some((*old_rows.get(key)?, *row)));
    let common = common(both());
    let shift = |row: &Row| common.filter(|_| is_absolute(row));
    let times = both().filter(|(was, row)| is_time(row) && was.valid && row.valid && was.verdict == row.verdict);
    let level = level(times.filter_map(|(was, row)| p_value(was, row, shift(row))).collect());
    let mut diff = Diff { changes: Vec::new(), compared: 0, invalid: 0, common: common.unwrap_or(1.0) };
    for (key, row) in &new {
        let Some(&was) = old_rows.get(key) else {
            diff.changes.push(Changed { change: Change::New, before: None, after: Some(row) });
            continue;
        };
        diff.compared += 1;
        let timed = is_time(row) && was.value.is_some() && row.value.is_some();
        if timed && (!was.valid || !row.valid || half_width(was).is_nan() || half_width(row).is_nan()) {
            diff.invalid += 1;
            continue;
        }
        let change = if was.verdict != row.verdict {
            Some(Change::Verdict)
        } else if timed {
            apart(was, row, shift(row), level).then_some(Change::Time)
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

/// Whether a time is in nanoseconds, which depend on the machine's state as ratios do not.
fn is_absolute(row: &Row) -> bool {
    row.metric == "ns_per_call"
}

/// The median ratio of the absolute times that count in both runs, if there are not few.
fn common<'a>(pairs: impl Iterator<Item = (&'a Row, &'a Row)>) -> Option<f64> {
    let both = pairs.filter(|(was, row)| is_time(row) && is_absolute(row) && was.valid && row.valid);
    let mut ratios: Vec<f64> = both.filter_map(|(was, row)| Some(row.value? / was.value?)).filter(|ratio| ratio.is_finite()).collect();
    ratios.sort_unstable_by(f64::total_cmp);
    (ratios.len() >= COMMON).then(|| ratios[ratios.len() / 2])
}

/// The half-width of the logarithm of a time's interval; zero without one. NaN if an end is NaN.
pub(crate) fn half_width(row: &Row) -> f64 {
    let value = row.value.unwrap_or(f64::NAN);
    let ends = [row.ci_high, row.ci_low].map(|end| end.unwrap_or(value));
    // A value that was lost is a change of its own.
    if value.is_nan() || ends == [value; 2] { 0.0 } else { 0.5 * (ends[0] / ends[1]).ln() }
}

/// The half-width without what the whole machine does from run to run, the parameter `drift` of a time: a common factor holds that.
fn own_half_width(row: &Row) -> f64 {
    /// That of the parameters; older runs have none.
    #[derive(Deserialize)]
    struct Params {
        #[serde(default)]
        drift: f64,
    }
    let drift = serde_json::from_str(&row.params).map_or(0.0, |Params { drift }| NORMAL * drift);
    let half = half_width(row);
    let own = half * half - drift * drift;
    // A NaN stays one. Of an interval that is all drift, rounding may leave less than zero.
    if own < 0.0 { 0.0 } else { own.sqrt() }
}

/// How likely chance makes the logarithm of the ratio of two times, over a common factor, as large as it is. `None` if it is NaN.
fn p_value(was: &Row, row: &Row, common: Option<f64>) -> Option<f64> {
    let log = (row.value? / was.value? / common.unwrap_or(1.0)).ln().abs();
    let half_width = if common.is_some() { own_half_width } else { half_width };
    let error = half_width(was).hypot(half_width(row)) / STUDENT;
    // A difference of two numbers without intervals is one.
    let t = if log == 0.0 { 0.0 } else { log / error };
    (!t.is_nan()).then(|| beyond(t))
}

/// How likely Student's variable with 14 degrees of freedom is beyond ±t (Abramowitz and Stegun, Handbook of Mathematical Functions, 26.7.4).
fn beyond(t: f64) -> f64 {
    const FREEDOM: u32 = 14;
    let angle = (t / f64::from(FREEDOM).sqrt()).atan();
    let square = angle.cos().powi(2);
    // 1 + 1/2 c² (1 + 3/4 c² (1 + 5/6 c² (…)))
    let series = (1..FREEDOM / 2).rev().fold(1.0, |sum, k| 1.0 + sum * square * f64::from(2 * k - 1) / f64::from(2 * k));
    1.0 - angle.sin() * series
}

/// The p-value up to which times have changed, so that [`FALSE_SHARE`] holds; negative if none has.
fn level(mut p_values: Vec<f64>) -> f64 {
    p_values.sort_unstable_by(f64::total_cmp);
    let count = p_values.len() as f64;
    let within = |(k, p): &(usize, f64)| *p <= FALSE_SHARE * (k + 1) as f64 / count;
    p_values.into_iter().enumerate().rev().find(within).map(|(_, p)| p).unwrap_or(-1.0)
}

/// Whether two times differ by more than a common factor: their ratio over it is beyond the noise, and chance is not a likely cause; or one of
/// the two is NaN.
fn apart(before: &Row, after: &Row, common: Option<f64>, level: f64) -> bool {
    let (value, other) = (after.value.unwrap_or(f64::NAN), before.value.unwrap_or(f64::NAN));
    let log = (value / other / common.unwrap_or(1.0)).ln().abs();
    value.is_nan() != other.is_nan() || log > TIME_NOISE.ln_1p() && p_value(before, after, common).is_some_and(|p| p <= level)
}
