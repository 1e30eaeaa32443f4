//! Known deviations of one engine, as data: answers that miss their gate for a known cause, and reproductions that show a deviation alone.

use crate::engine::lack::among;
use crate::{HarnessError, RangeKey, RobotClass};
use featherbench_results::{Properties, Row, Verdict};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Seeds over which the size of a deviation is measured.
pub const SEEDS: u64 = 20;
/// What a deviation without a reproduction says in the place of its name.
const NOT_REPRODUCED: &str = "not reproduced";

/// A known deviation: rows that match may fail or be errors, as `verdict` says.
///
/// The cause is given here, for a class of robots. The size of a failure is given for each robot in [`Ranges`](crate::Ranges).
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Deviation {
    /// The engine: the name of the file.
    #[serde(skip)]
    pub engine: String,
    /// The engine's version, from the head of the file; the deviation does not apply to other versions.
    #[serde(skip)]
    pub version: String,
    /// The file, for errors.
    #[serde(skip)]
    pub(crate) file: PathBuf,
    /// Its name among the deviations of the engine.
    pub id: String,
    /// The method, or all of them.
    pub method: Option<String>,
    /// The quantities, or all of them.
    pub quantities: Option<Vec<String>>,
    /// The states, or all of them.
    pub states: Option<Vec<String>>,
    /// The verdict that it explains: fail or error.
    pub verdict: Verdict,
    /// The cause.
    pub reason: String,
    /// The reproduction that shows the cause alone, or `not reproduced`.
    pub reproduction: String,
    /// The robots.
    #[serde(flatten)]
    pub class: RobotClass,
    /// Keys that nothing above has taken.
    #[serde(flatten)]
    unknown: BTreeMap<String, toml::Value>,
}

/// A program that shows a deviation alone: `deviation` of the module `featherbench_oracles.ENGINE.reproductions.NAME`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reproduction {
    /// The engine: the name of the file.
    #[serde(skip)]
    pub engine: String,
    /// The version for which the range was measured, from the head of the file.
    #[serde(skip)]
    pub version: String,
    /// The program's file name without its extension, after `ENGINE_`.
    pub name: String,
    /// When the deviation occurs, one sentence.
    pub condition: String,
    /// The meaning of its value.
    pub measure: String,
    /// Smallest and largest value over [`SEEDS`] seeds.
    pub range: [f64; 2],
    /// The public thread about it, or the text `none found`.
    pub upstream: String,
}

/// The known deviations of one engine: `ci/deviations/ENGINE.toml`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviationFile {
    version: String,
    #[serde(default)]
    pub(crate) deviation: Vec<Deviation>,
    #[serde(default)]
    pub(crate) reproduction: Vec<Reproduction>,
}

impl DeviationFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`HarnessError`], naming file and entry.
    pub fn read(path: &Path) -> Result<Self, HarnessError> {
        Self::parse(&std::fs::read_to_string(path).map_err(|source| HarnessError::io(path, source))?, path)
    }

    /// The deviations of a text; the name of `path` without its extension is the engine's.
    ///
    /// # Errors
    /// [`HarnessError`], naming file and entry.
    pub fn parse(text: &str, path: &Path) -> Result<Self, HarnessError> {
        let wrong = |message: String| HarnessError::Config { path: path.to_owned(), message };
        let mut read: Self = toml::from_str(text).map_err(|error| wrong(error.to_string()))?;
        let engine = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        for known in &mut read.deviation {
            (known.engine, known.version, known.file) = (engine.clone(), read.version.clone(), path.to_owned());
        }
        for known in &mut read.reproduction {
            (known.engine, known.version) = (engine.clone(), read.version.clone());
        }
        read.check().map_err(wrong)?;
        Ok(read)
    }

    /// What no type says.
    fn check(&self) -> Result<(), String> {
        for Reproduction { name, engine, range: [low, high], .. } in &self.reproduction {
            if !name.starts_with(&format!("{engine}_")) {
                return Err(format!("reproduction '{name}': its name does not begin with {engine}_"));
            }
            if !(0.0 < *low && low <= high && high.is_finite()) {
                return Err(format!("reproduction '{name}': range [{low}, {high}] is not that of a deviation"));
            }
        }
        let mut ids = BTreeSet::new();
        for (index, known) in self.deviation.iter().enumerate() {
            let wrong = |message: String| Err(format!("deviation '{}': {message}", known.id));
            if let Some(key) = known.unknown.keys().next() {
                return wrong(format!("unknown key '{key}'"));
            }
            if known.id.is_empty() || !known.id.chars().all(|c| c.is_ascii_alphanumeric() || c == '-') {
                return wrong("an id is made of letters, digits and hyphens".into());
            }
            if !ids.insert(&known.id) {
                return wrong("another deviation of the engine has the same id".into());
            }
            if !matches!(known.verdict, Verdict::Fail | Verdict::Error) {
                return wrong(format!(
                    "verdict '{}' is none of fail, error (what an engine does not offer is a [[{}.lacks]] of oracles/engines.toml)",
                    known.verdict, known.engine
                ));
            }
            if let Some(kind) = known.class.unknown_joint() {
                return wrong(format!("there is no kind of joint '{kind}'"));
            }
            if known.reproduction != NOT_REPRODUCED && self.reproduction.iter().all(|shown| shown.name != known.reproduction) {
                let told = &known.reproduction;
                return wrong(format!("there is no [[reproduction]] named '{told}' (a deviation without one says \"{NOT_REPRODUCED}\")"));
            }
            if let Some(other) = self.deviation[..index].iter().find(|other| known.repeats(other)) {
                return wrong(format!("it is about rows that '{}' is about: nothing tells them apart", other.id));
            }
        }
        Ok(())
    }
}

impl Deviation {
    /// Whether it is about this row of a robot with these properties: engine, version, method, quantity, states and robot. Value and verdict
    /// do not matter.
    pub fn is_about(&self, row: &Row, properties: Option<&Properties>) -> bool {
        self.version == row.engine_version
            && self.method.as_ref().is_none_or(|method| *method == row.method)
            && self.concerns(row)
            && self.class.holds(&row.robot, properties)
    }

    /// Whether it is about failures, whose size is measured.
    pub fn is_measured(&self) -> bool {
        self.verdict == Verdict::Fail
    }

    /// Whether a range of this key may belong to it: engine, version, method and quantity.
    pub fn has(&self, key: &RangeKey) -> bool {
        self.is_measured()
            && self.engine == key.engine
            && self.version == key.version
            && self.method.as_ref().is_none_or(|method| *method == key.method)
            && among(&self.quantities, &key.quantity)
    }

    /// Whether it is about the engine, quantity and states of this row, for any method, any version and any robot.
    pub(crate) fn concerns(&self, row: &Row) -> bool {
        self.engine == row.engine && among(&self.quantities, &row.quantity) && among(&self.states, &row.states)
    }

    /// Whether two deviations of one engine may be about the same answer of the same robot.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let common = |a: &Option<Vec<String>>, b: &Option<Vec<String>>| match (a, b) {
            (Some(a), Some(b)) => a.iter().any(|name| b.contains(name)),
            _ => true,
        };
        let method = self.method.is_none() || other.method.is_none() || self.method == other.method;
        let same = self.engine == other.engine && self.version == other.version && self.verdict == other.verdict;
        same && method && common(&self.quantities, &other.quantities) && common(&self.states, &other.states)
    }

    /// Whether nothing tells the rows of two deviations apart. Failures are told apart by the ranges, which name their deviation.
    fn repeats(&self, other: &Self) -> bool {
        !self.is_measured() && self.class == other.class && self.overlaps(other)
    }

    /// An error about it, naming its file.
    pub(crate) fn error(&self, message: &str) -> HarnessError {
        HarnessError::Config { path: self.file.clone(), message: format!("deviation '{}': {message}", self.id) }
    }
}
