//! The lock file of the suites, `ci/counts.csv`: how many cells and rows a complete run of each suite has.
//!
//! `featherbench gate RUN --counts --write` writes it. A complete run that has others fails: a study that asks less than it did is noticed.

use crate::HarnessError;
use featherbench_results::{Culprit, Expectation, GateKind, Kind, Row, RunInfo, Verdict};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Name of the file in the folder of gates.
pub const COUNTS_NAME: &str = "counts.csv";
/// The first line of the file.
const HEAD: &str = "suite,study,engine,quantity,cells,rows";

/// Cells and rows of complete runs, by suite, study, engine and quantity.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts(BTreeMap<[String; 4], Count>);

/// The counts of a study for an engine and a quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Cells with rows.
    pub cells: u64,
    /// Rows that pass, or have a value with a known deviation. Near a gate, the rounding of another processor may turn one into the other.
    /// The row must exist in any case.
    pub rows: u64,
}

impl Counts {
    /// Reads the file.
    ///
    /// # Errors
    /// [`HarnessError`], naming file and line.
    pub fn read(path: &Path) -> Result<Self, HarnessError> {
        let text = std::fs::read_to_string(path).map_err(|source| HarnessError::io(path, source))?;
        Self::parse(&text, path)
    }

    /// The counts of a text; `path` is its name in errors.
    ///
    /// # Errors
    /// [`HarnessError`], naming file and line.
    pub fn parse(text: &str, path: &Path) -> Result<Self, HarnessError> {
        let wrong = |line: usize, what: String| HarnessError::Config { path: path.to_owned(), message: format!("line {line}: {what}") };
        if text.lines().next() != Some(HEAD) {
            return Err(wrong(1, format!("the first line is not '{HEAD}'")));
        }
        let mut counts = BTreeMap::new();
        for (line, text) in text.lines().enumerate().skip(1) {
            let fields: Vec<&str> = text.split(',').collect();
            let [suite, study, engine, quantity, cells, rows] = fields[..] else {
                return Err(wrong(line + 1, format!("it has {} columns, not 6", fields.len())));
            };
            let number = |name: &str, text: &str| text.parse().map_err(|error| wrong(line + 1, format!("{name} '{text}': {error}")));
            let count = Count { cells: number("cells", cells)?, rows: number("rows", rows)? };
            let key = [suite, study, engine, quantity].map(str::to_owned);
            if counts.insert(key, count).is_some() {
                return Err(wrong(line + 1, format!("{suite} {study} {engine} {quantity} occurs twice")));
            }
        }
        Ok(Self(counts))
    }

    /// The counts of a run: those of the rows that come out the same on every machine, of our engine and of the others that are named.
    pub fn of(suite: &str, engines: &[String], rows: &[Row]) -> Self {
        let mut found: BTreeMap<[String; 4], (BTreeSet<&str>, u64)> = BTreeMap::new();
        // A row without a quantity says that an engine offers nothing of a study.
        let counted =
            |row: &&Row| row.kind == Kind::Exact && !row.quantity.is_empty() && (row.engine == crate::OWN || engines.contains(&row.engine));
        for row in rows.iter().filter(counted) {
            let (cells, count) = found.entry([suite, &row.study, &row.engine, &row.quantity].map(str::to_owned)).or_default();
            cells.insert(&row.cell);
            *count += u64::from(accounted(row));
        }
        Self(found.into_iter().map(|(key, (cells, rows))| (key, Count { cells: cells.len() as u64, rows })).collect())
    }

    /// The same file with the counts of one suite in the place of those it had.
    pub fn with(&self, suite: &str, counts: Self) -> Self {
        let others = self.0.iter().filter(|([of, ..], _)| of != suite).map(|(key, count)| (key.clone(), *count));
        Self(others.chain(counts.0).collect())
    }

    /// The file's text.
    pub fn to_csv(&self) -> String {
        let lines = self.0.iter().map(|(key, Count { cells, rows })| format!("{},{cells},{rows}\n", key.join(",")));
        [format!("{HEAD}\n")].into_iter().chain(lines).collect()
    }

    /// One condition for each study and engine that the file names for the suite: a complete run has these cells and rows. A study that the
    /// run left out has no condition. Neither has an engine that is not named: an external one, or one that answers live where the counts are
    /// those of recorded answers.
    pub fn conditions(&self, run: &RunInfo, engines: &[String], rows: &[Row]) -> Vec<Expectation> {
        let due: BTreeMap<_, _> = self.0.iter().filter(|([suite, ..], _)| *suite == run.suite).collect();
        if due.is_empty() {
            return Vec::new();
        }
        let found = Self::of(&run.suite, engines, rows);
        let conducted = |study: &String| run.studies.contains(study);
        let pairs: BTreeSet<(&String, &String)> =
            due.keys().map(|[_, study, engine, _]| (study, engine)).filter(|(study, _)| conducted(study)).collect();
        let of = |(study, engine): (&String, &String)| {
            let here = |key: &&[String; 4]| (&key[1], &key[2]) == (study, engine);
            let keys: BTreeSet<&[String; 4]> = due.keys().copied().chain(found.0.keys()).filter(here).collect();
            let count = |key: &[String; 4]| {
                (due.get(key).map_or_else(Count::default, |count| **count), found.0.get(key).copied().unwrap_or_default())
            };
            let sum = |which: fn((Count, Count)) -> Count| keys.iter().map(|key| which(count(key)).rows).sum::<u64>();
            let others = || keys.iter().copied().filter(|key| count(key).0 != count(key).1);
            let words = |key: &[String; 4]| {
                let (due, found) = count(key);
                format!("{}: {} cells and {} rows, not {} and {}", key[3], found.cells, found.rows, due.cells, due.rows)
            };
            let other: Vec<String> = others().map(words).collect();
            let quantity = others().next().map(|key| key[3].clone()).unwrap_or_default();
            let what = format!("cells and rows of {engine} in the study {study} as {COUNTS_NAME} has them");
            let culprit = Culprit { study: study.clone(), quantity, ..Culprit::engine(engine) };
            let mut condition = Expectation::new(GateKind::Counts, what, sum(|(due, _)| due), sum(|(_, found)| found)).about(culprit);
            if !other.is_empty() {
                condition.verdict = Verdict::Fail;
                condition.reason = other.join("; ");
            }
            condition
        };
        pairs.into_iter().map(of).collect()
    }
}

/// Whether a row counts: it passes, or has a value with a known deviation.
fn accounted(row: &Row) -> bool {
    row.verdict == Verdict::Pass || row.verdict == Verdict::Deviation && row.value.is_some()
}
