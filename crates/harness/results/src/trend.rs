//! Trends: one number over several runs of a suite, and where it changed beyond noise.
//!
//! # The rule
//! Two values of a number are *apart*:
//!
//! - Times are apart when their intervals are, and their ratio is beyond [`TIME_NOISE`](crate::TIME_NOISE).
//! - Errors are apart when they differ by a factor of [`ERROR_FACTOR`].
//! - Counts are apart when they differ.
//!
//! A *change point* lies between two runs if each of the last three values before it is apart from each of the first three after it, all on the
//! same side. The values before it are those since the change point before. So a single run out of line is none. Under no change, six values
//! have this order in one of ten cases (2·3!·3!/6!: the exact rank test of Mann and Whitney, Ann. Math. Stat. 18, 1947). That alone would be
//! weak. The widths of the intervals make it rare. With fewer than three values on a side it is not *confirmed*.

use std::collections::BTreeMap;

use crate::diff::{Key, half_width, is_count, is_time, keyed};
use crate::{ERROR_FACTOR, ERROR_FLOOR, Kind, Row, TIME_NOISE};

/// Values on each side of a change point.
pub const BESIDE: usize = 3;

/// What a number is: that decides when two values are apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Trended {
    /// An error.
    Error,
    /// A time with its interval.
    Time,
    /// A count.
    Count,
}

/// The number in one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The index of the run.
    pub run: usize,
    /// The value.
    pub value: f64,
    /// The half-width of the logarithm of a time's interval.
    pub half_width: f64,
}

/// A number over the runs that have it.
#[derive(Clone, Debug)]
pub struct Trend<'a> {
    /// Its row in the last of them.
    pub row: &'a Row,
    /// What it is.
    pub kind: Trended,
    /// Its values, run by run.
    pub points: Vec<Point>,
}

/// Where a number changed beyond noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChangePoint {
    /// The index of the last run before it.
    pub before: usize,
    /// The index of the first run after it.
    pub after: usize,
    /// The median of the values after it over that before it.
    pub factor: f64,
    /// Whether there are three values on each side.
    pub confirmed: bool,
}

/// The numbers that at least two runs have. `machines` has a name for the machine of each run: times of others than the last one's are left out,
/// and so are times that do not count.
pub fn trends<'a>(runs: &[&'a [Row]], machines: &[String]) -> Vec<Trend<'a>> {
    let mut found: BTreeMap<Key<'a>, Trend<'a>> = BTreeMap::new();
    for (run, rows) in runs.iter().enumerate() {
        for (key, row) in keyed(rows) {
            let Some(value) = row.value.filter(|value| value.is_finite()) else { continue };
            let kind = match (is_time(row), row.kind) {
                (true, _) => Trended::Time,
                (false, Kind::Measured) => continue,
                (false, Kind::Exact) if is_count(row) => Trended::Count,
                (false, Kind::Exact) => Trended::Error,
            };
            let half_width = half_width(row);
            if kind == Trended::Time && (!row.valid || half_width.is_nan() || machines.get(run) != machines.last()) {
                continue;
            }
            let trend = found.entry(key).or_insert_with(|| Trend { row, kind, points: Vec::new() });
            (trend.row, trend.kind) = (row, kind);
            trend.points.push(Point { run, value, half_width });
        }
    }
    found.into_values().filter(|trend| trend.points.len() > 1).collect()
}

impl Trend<'_> {
    /// The change points, from the first.
    pub fn change_points(&self) -> Vec<ChangePoint> {
        let (mut changes, mut start) = (Vec::new(), 0);
        for at in 1..self.points.len() {
            let before = &self.points[start.max(at.saturating_sub(BESIDE))..at];
            let after = &self.points[at..self.points.len().min(at + BESIDE)];
            let pairs = || before.iter().flat_map(|a| after.iter().map(move |b| (a, b)));
            if pairs().all(|(a, b)| self.rises(a, b)) || pairs().all(|(a, b)| self.rises(b, a)) {
                changes.push(ChangePoint {
                    before: self.points[at - 1].run,
                    after: self.points[at].run,
                    factor: median(after) / median(before),
                    confirmed: before.len() == BESIDE && after.len() == BESIDE,
                });
                start = at;
            }
        }
        changes
    }

    /// Whether the second value is apart from the first, and larger.
    fn rises(&self, a: &Point, b: &Point) -> bool {
        match self.kind {
            Trended::Count => b.value > a.value,
            Trended::Error => floored(b.value) > ERROR_FACTOR * floored(a.value),
            Trended::Time => {
                let log = (b.value / a.value).ln();
                log > a.half_width + b.half_width && log > TIME_NOISE.ln_1p()
            }
        }
    }
}

/// An error; below the floor all are alike.
fn floored(error: f64) -> f64 {
    if error.abs() > ERROR_FLOOR { error.abs() } else { ERROR_FLOOR }
}

fn median(points: &[Point]) -> f64 {
    let mut values: Vec<f64> = points.iter().map(|point| point.value).collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { (values[middle - 1] + values[middle]) / 2.0 }
}
