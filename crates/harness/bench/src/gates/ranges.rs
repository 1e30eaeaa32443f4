//! The sizes of the known deviations for each robot: data files that `featherbench gate --ranges … --write` writes.
//!
//! `SUITE.csv` has twenty seeds on one processor. `SUITE-PROCESSOR.csv` has runs on another: other vector units round otherwise, and where an
//! answer loses most of its digits the sizes differ by more than two. A range spans all files that have it.
//!
//! A file is sorted CSV, with one row per engine, version, method, quantity, robot and metric.
//! - `deviation`: the id of the deviation in `ci/deviations/ENGINE.toml` that has this size.
//! - `low` and `high`: the smallest and the largest of the worst values of runs with different seeds.
//! - `outside`: the number of those runs in which a row was outside its bound.
//! - `seeds`: the number of runs.

use crate::HarnessError;
use crate::measure::worst;
use featherbench_results::{Culprit, Row};
use std::collections::BTreeMap;
use std::fmt::{self, Write as _};
use std::path::{Path, PathBuf};

/// The largest factor between a value and its range. Another draw, or another processor's rounding, causes little more.
pub const SLACK: f64 = 2.0;
/// The columns of a file, in order.
const COLUMNS: [&str; 11] = ["engine", "version", "method", "quantity", "robot", "metric", "deviation", "low", "high", "outside", "seeds"];

/// The key of a range.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RangeKey {
    /// The engine.
    pub engine: String,
    /// Its version.
    pub version: String,
    /// Its method.
    pub method: String,
    /// The quantity.
    pub quantity: String,
    /// The robot.
    pub robot: String,
    /// The error measure.
    pub metric: String,
}

/// The size of a known deviation on one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// The id of the deviation.
    pub deviation: String,
    /// Smallest of the runs' worst values.
    pub low: f64,
    /// Largest of the runs' worst values.
    pub high: f64,
    /// Runs with a row outside its bound.
    pub outside: u64,
    /// Runs.
    pub seeds: u64,
}

/// The ranges of several files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ranges(BTreeMap<RangeKey, Range>);

impl RangeKey {
    /// Who a condition on this deviation is about.
    pub(crate) fn culprit(&self) -> Culprit {
        let [robot, quantity, method] = [&self.robot, &self.quantity, &self.method].map(String::clone);
        Culprit { robot, quantity, method, ..Culprit::engine(&self.engine) }
    }

    /// The key of a row.
    pub fn of(row: &Row) -> Self {
        Self {
            engine: row.engine.clone(),
            version: row.engine_version.clone(),
            method: row.method.clone(),
            quantity: row.quantity.clone(),
            robot: row.robot.clone(),
            metric: row.metric.clone(),
        }
    }

    /// Whether two keys differ in the version at most.
    pub(super) fn is_alike(&self, other: &Self) -> bool {
        *self == Self { version: self.version.clone(), ..other.clone() }
    }

    fn words(&self) -> [&str; 6] {
        [&self.engine, &self.version, &self.method, &self.quantity, &self.robot, &self.metric]
    }
}

impl fmt::Display for RangeKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words().join(" "))
    }
}

impl Range {
    /// Whether a value is at most as large as known.
    pub fn admits(&self, value: f64) -> bool {
        value <= SLACK * self.high
    }

    /// Whether a run's worst value is smaller than known. If not every run showed the deviation, no value is too small.
    pub fn has_shrunk(&self, value: f64) -> bool {
        self.outside == self.seeds && value < self.low / SLACK
    }

    /// The range of both, which are ranges of one deviation.
    fn joined(self, other: &Self) -> Self {
        Self {
            deviation: self.deviation,
            low: self.low.min(other.low),
            high: worst(self.high, other.high),
            outside: self.outside + other.outside,
            seeds: self.seeds + other.seeds,
        }
    }
}

impl Ranges {
    /// Reads every `.csv` file of a folder; no ranges if there is no folder. If two files have the same key (a robot of two suites), the
    /// range spans both.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and column.
    pub fn read(folder: &Path) -> Result<Self, HarnessError> {
        let mut all = Self::default();
        if !folder.is_dir() {
            return Ok(all);
        }
        for path in files(folder, "csv")? {
            let text = std::fs::read_to_string(&path).map_err(|source| HarnessError::io(&path, source))?;
            for (key, range) in Self::parse(&text, &path)?.0 {
                let both = match all.0.remove(&key) {
                    None => range,
                    Some(known) if known.deviation == range.deviation => known.joined(&range),
                    Some(known) => {
                        let message = format!("{key}: this is a size of '{}', in another file of '{}'", range.deviation, known.deviation);
                        return Err(HarnessError::Config { path, message });
                    }
                };
                all.0.insert(key, both);
            }
        }
        Ok(all)
    }

    /// The ranges of one text; `path` is its name in errors.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and column.
    pub fn parse(text: &str, path: &Path) -> Result<Self, HarnessError> {
        let bad = |line: usize, what: String| HarnessError::Config { path: path.to_owned(), message: format!("line {line}: {what}") };
        let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line));
        let head = COLUMNS.join(",");
        if lines.next().map(|(_, line)| line) != Some(&head) {
            return Err(bad(1, format!("the columns are not {head}; write the file again with `featherbench gate --ranges … --write`")));
        }
        let mut all = BTreeMap::new();
        for (number, line) in lines {
            let words: Vec<&str> = line.split(',').collect();
            let &[engine, version, method, quantity, robot, metric, deviation, low, high, outside, seeds] = words.as_slice() else {
                return Err(bad(number, format!("{} columns, not {}", words.len(), COLUMNS.len())));
            };
            let float = |name: &str, word: &str| {
                let value = word.parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
                value.ok_or_else(|| bad(number, format!("{name}: '{word}' is no size of a deviation")))
            };
            let count =
                |name: &str, word: &str| word.parse::<u64>().map_err(|_| bad(number, format!("{name}: '{word}' is no number of runs")));
            let range = Range {
                deviation: deviation.to_owned(),
                low: float("low", low)?,
                high: float("high", high)?,
                outside: count("outside", outside)?,
                seeds: count("seeds", seeds)?,
            };
            if range.low > range.high || range.high == 0.0 {
                return Err(bad(number, format!("low, high: [{low}, {high}] is not the range of a deviation")));
            }
            if range.outside == 0 || range.outside > range.seeds {
                return Err(bad(number, format!("outside, seeds: outside in {outside} of {seeds} runs is no known deviation")));
            }
            let [engine, version, method, quantity, robot, metric] = [engine, version, method, quantity, robot, metric].map(str::to_owned);
            if all.insert(RangeKey { engine, version, method, quantity, robot, metric }, range).is_some() {
                return Err(bad(number, "the same engine, version, method, quantity, robot and metric stand on an earlier line".into()));
            }
        }
        Ok(Self(all))
    }

    /// The text of a file: sorted, numbers in the shortest form that reads back to the same bits.
    pub fn to_csv(&self) -> String {
        let mut text = COLUMNS.join(",") + "\n";
        for (key, range) in &self.0 {
            let Range { deviation, low, high, outside, seeds } = range;
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{},{deviation},{low:e},{high:e},{outside},{seeds}", key.words().join(","));
        }
        text
    }

    /// The range of a row's engine, version, method, quantity, robot and metric.
    pub fn get(&self, row: &Row) -> Option<&Range> {
        self.0.get(&RangeKey::of(row))
    }

    /// The range of a key.
    pub fn of(&self, key: &RangeKey) -> Option<&Range> {
        self.0.get(key)
    }

    /// All of them, sorted.
    pub fn iter(&self) -> impl Iterator<Item = (&RangeKey, &Range)> {
        self.0.iter()
    }
}

/// The files of a folder with an extension, sorted.
pub(crate) fn files(folder: &Path, extension: &str) -> Result<Vec<PathBuf>, HarnessError> {
    let io = |source| HarnessError::io(folder, source);
    let entries = std::fs::read_dir(folder).map_err(io)?.map(|entry| entry.map(|entry| entry.path()).map_err(io));
    let mut paths = entries.collect::<Result<Vec<_>, HarnessError>>()?;
    paths.retain(|path| path.extension().is_some_and(|ending| ending == extension));
    paths.sort();
    Ok(paths)
}

impl FromIterator<(RangeKey, Range)> for Ranges {
    fn from_iter<T: IntoIterator<Item = (RangeKey, Range)>>(ranges: T) -> Self {
        Self(ranges.into_iter().collect())
    }
}
