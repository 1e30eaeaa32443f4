//! The sizes of the known deviations for each robot: data files that `featherbench gate --ranges … --write` writes.
//!
//! A file is sorted CSV, with one row per engine, version, method, quantity, robot and metric.
//! - `low` and `high`: the smallest and the largest of the worst values of runs with different seeds.
//! - `outside`: the number of those runs in which a row was outside its bound.
//! - `seeds`: the number of runs.

use crate::measure::worst;
use crate::{Deviation, HarnessError, SLACK};
use featherbench_results::{Row, Verdict};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// The columns of a file, in order.
const COLUMNS: [&str; 10] = ["engine", "version", "method", "quantity", "robot", "metric", "low", "high", "outside", "seeds"];

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
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

    fn words(&self) -> [&str; 6] {
        [&self.engine, &self.version, &self.method, &self.quantity, &self.robot, &self.metric]
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

    /// The range of both.
    fn joined(self, other: Self) -> Self {
        Self {
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
        let io = |source| HarnessError::io(folder, source);
        let entries = std::fs::read_dir(folder).map_err(io)?.map(|entry| entry.map(|entry| entry.path()).map_err(io));
        let mut paths = entries.collect::<Result<Vec<_>, HarnessError>>()?;
        paths.retain(|path| path.extension().is_some_and(|ending| ending == "csv"));
        paths.sort();
        for path in paths {
            let text = std::fs::read_to_string(&path).map_err(|source| HarnessError::io(&path, source))?;
            for (key, range) in Self::parse(&text, &path)?.0 {
                let known = all.0.get(&key).copied();
                all.0.insert(key, known.map_or(range, |known| known.joined(range)));
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
            let &[engine, version, method, quantity, robot, metric, low, high, outside, seeds] = words.as_slice() else {
                return Err(bad(number, format!("{} columns, not {}", words.len(), COLUMNS.len())));
            };
            let float = |name: &str, word: &str| {
                let value = word.parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
                value.ok_or_else(|| bad(number, format!("{name}: '{word}' is no size of a deviation")))
            };
            let count =
                |name: &str, word: &str| word.parse::<u64>().map_err(|_| bad(number, format!("{name}: '{word}' is no number of runs")));
            let range = Range {
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
            let Range { low, high, outside, seeds } = range;
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{},{low:e},{high:e},{outside},{seeds}", key.words().join(","));
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

impl FromIterator<(RangeKey, Range)> for Ranges {
    fn from_iter<T: IntoIterator<Item = (RangeKey, Range)>>(ranges: T) -> Self {
        Self(ranges.into_iter().collect())
    }
}

/// Ranges while runs are added.
#[derive(Clone, Debug, Default)]
pub struct RangesMeter(BTreeMap<RangeKey, Vec<Worst>>);

/// The worst value of one run.
#[derive(Clone, Copy, Debug)]
struct Worst {
    value: f64,
    outside: bool,
}

impl RangesMeter {
    /// Adds the rows of one run. Rows of a deviation with the verdict `fail` count with their value, whether they miss their bound in this
    /// run or not.
    pub fn add(&mut self, deviations: &[Deviation], records: &[Row]) {
        let mut run: BTreeMap<RangeKey, Worst> = BTreeMap::new();
        for row in records.iter().filter(|row| row.bound.is_some()) {
            let Some(value) = row.value.filter(|_| deviations.iter().any(|known| known.is_measured() && known.is_about(row))) else {
                continue;
            };
            let outside = matches!(row.verdict, Verdict::Fail | Verdict::Deviation);
            let known = run.entry(RangeKey::of(row)).or_insert(Worst { value, outside });
            *known = Worst { value: worst(known.value, value), outside: known.outside || outside };
        }
        for (key, found) in run {
            self.0.entry(key).or_default().push(found);
        }
    }

    /// The ranges of the keys that were outside their bound in one of the runs.
    pub fn ranges(&self) -> Ranges {
        let range = |runs: &Vec<Worst>| Range {
            low: -runs.iter().map(|run| -run.value).fold(f64::NEG_INFINITY, worst),
            high: runs.iter().map(|run| run.value).fold(0.0, worst),
            outside: runs.iter().filter(|run| run.outside).count() as u64,
            seeds: runs.len() as u64,
        };
        let known = self.0.iter().map(|(key, runs)| (key.clone(), range(runs))).filter(|(_, range)| range.outside > 0);
        Ranges(known.collect())
    }

    /// How far the extreme run of each key is from the others, as sorted factors: largest / second largest. And second smallest / smallest,
    /// if every run was outside its bound. [`SLACK`] is chosen from them.
    pub fn leaps(&self) -> (Vec<f64>, Vec<f64>) {
        let (mut up, mut down) = (Vec::new(), Vec::new());
        for runs in self.0.values().filter(|runs| runs.len() > 1 && runs.iter().any(|run| run.outside)) {
            let mut values: Vec<f64> = runs.iter().map(|run| run.value).collect();
            values.sort_unstable_by(f64::total_cmp);
            let last = values.len() - 1;
            up.push(values[last] / values[last - 1]);
            if runs.iter().all(|run| run.outside) {
                down.push(values[1] / values[0]);
            }
        }
        up.sort_unstable_by(f64::total_cmp);
        down.sort_unstable_by(f64::total_cmp);
        (up, down)
    }
}
