//! What all rows of a run share: `run.json`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::file::{atomic_write, read_text};
use crate::names::words;
use crate::{ResultsError, Verdict};

/// Format of `run.json` and `schema.json` that this version writes and reads.
pub const RUN_FORMAT: u32 = 1;

/// Provenance of a run. Text that could not be found out is empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunInfo {
    /// [`RUN_FORMAT`] when it was written; [`write`](Self::write) sets it.
    pub format: u32,
    /// Id of the run, as in the records.
    pub run: String,
    /// Name of the suite.
    pub suite: String,
    /// Content hash of the suite file.
    pub suite_hash: String,
    /// The exact command that reproduces the run.
    pub command: String,
    /// When it started, as the caller wrote it (RFC 3339 by custom).
    pub started: String,
    /// Version of featherbench.
    pub version: String,
    /// The source it was built from.
    pub git: GitInfo,
    /// Content hash of the program.
    pub binary_hash: String,
    /// Version of the compiler.
    pub rustc: String,
    /// Build profile.
    pub profile: String,
    /// Target features that were in effect, sorted.
    pub target_features: Vec<String>,
    /// The machine.
    pub host: Host,
    /// Seed of the run, from which each cell's is made.
    pub seed: u64,
    /// Whether the engines themselves answered, not recordings of them.
    pub live: bool,
    /// How many rows `rows.csv` holds.
    pub rows: u64,
    /// Who answered, or should have.
    pub engines: Vec<EngineInfo>,
    /// What they were asked about.
    pub models: Vec<ModelInfo>,
    /// Wall time of each phase, in seconds.
    pub seconds: BTreeMap<String, f64>,
    /// How many passing rows the suite expects, and what was found.
    pub expected: Vec<Expectation>,
    /// In which conventions the engines differ from ours, or do not.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conventions: Vec<Convention>,
}

/// The source revision.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GitInfo {
    /// Commit hash.
    pub revision: String,
    /// Whether the working tree differed from it.
    pub dirty: bool,
}

/// The machine on which a run took place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Host {
    /// Model name of the processor.
    pub cpu: String,
    /// Logical cores.
    pub cores: u64,
    /// Cores that timing was pinned to.
    pub affinity: String,
    /// Frequency governor.
    pub governor: String,
    /// One-minute load average at the start.
    pub load: Option<f64>,
    /// Kernel and its version.
    pub kernel: String,
    /// Main memory in bytes.
    pub memory: Option<u64>,
}

words! {
    /// Where an engine's answers came from.
    EngineSource {
        /// Our own kernels, in this process.
        Own = "own",
        /// Answers recorded earlier, read from a file.
        Recorded = "recorded",
        /// The engine itself, asked during the run.
        Live = "live",
    }
}

/// One engine of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EngineInfo {
    /// Name, as in the records.
    pub name: String,
    /// The version it reports.
    pub version: String,
    /// Where its answers came from.
    pub source: EngineSource,
    /// Build flags and the like, by name.
    pub build: BTreeMap<String, String>,
    /// `ok`, or a word for what went wrong.
    pub status: String,
    /// Why, where the status is not `ok`.
    pub reason: String,
}

words! {
    /// Where a model came from.
    ModelOrigin {
        /// A generator of ours.
        Generated = "generated",
        /// A description of a real robot.
        Robot = "robot",
    }
}

/// One model of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelInfo {
    /// Name, as in the records.
    pub name: String,
    /// Content hash of its description.
    pub hash: String,
    /// Generated, or a real robot.
    pub origin: ModelOrigin,
    /// Licence of the description.
    pub licence: String,
    /// Where the description was taken from, or the generator's call.
    pub source: String,
    /// Length of the configuration vector.
    pub nq: u64,
    /// Degrees of freedom.
    pub nv: u64,
    /// Moving bodies.
    pub bodies: u64,
    /// Joints on the longest path from base to leaf.
    pub depth: u64,
    /// What is unusual about it: numbers that were normalised, bodies without mass.
    #[serde(default)]
    pub notes: Vec<String>,
}

/// A convention of an engine beside ours.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Convention {
    /// The engine, as in the records.
    pub engine: String,
    /// What it is about: free v, screw pitch, armature.
    pub topic: String,
    /// What the engine does.
    pub theirs: String,
    /// What we do.
    pub ours: String,
    /// The function that converts, or how it comes that none is needed.
    pub conversion: String,
    /// The test that asks the engine itself, and fails if the convention were otherwise.
    pub test: String,
}

/// A condition on the number of rows: the suite's own gate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// What is counted: "drake: passing rows of fd".
    pub what: String,
    /// How many the suite asks for.
    pub expected: u64,
    /// How many there are.
    pub found: u64,
    /// The judgement.
    pub verdict: Verdict,
    /// Why it is not a pass.
    pub reason: String,
}

impl RunInfo {
    /// Reads a `run.json`; unknown fields, another format and a truncated file are errors.
    pub fn read(path: &Path) -> Result<Self, ResultsError> {
        Self::parse(&read_text(path)?, path)
    }

    /// The text of a `run.json`; `path` is what errors call it.
    pub fn parse(text: &str, path: &Path) -> Result<Self, ResultsError> {
        /// Read first, so that another format is named as such and not as an unknown field.
        #[derive(Deserialize)]
        struct Format {
            format: u32,
        }
        let json = |source| ResultsError::Json { path: path.to_owned(), source };
        let Format { format } = serde_json::from_str(text).map_err(json)?;
        if format != RUN_FORMAT {
            return Err(ResultsError::Format { path: path.to_owned(), found: format, expected: RUN_FORMAT });
        }
        serde_json::from_str(text).map_err(json)
    }

    /// Writes a `run.json` in one step, with the present format.
    pub fn write(&self, path: &Path) -> Result<(), ResultsError> {
        let numbers =
            self.seconds.iter().map(|(phase, &seconds)| (phase.as_str(), seconds)).chain(self.host.load.map(|load| ("load", load)));
        for (field, value) in numbers {
            if !value.is_finite() {
                return Err(ResultsError::NonFinite { path: path.to_owned(), field: field.to_owned(), value });
            }
        }
        let current = Self { format: RUN_FORMAT, ..self.clone() };
        let mut text = serde_json::to_string_pretty(&current).map_err(|source| ResultsError::Json { path: path.to_owned(), source })?;
        text.push('\n');
        atomic_write(path, text.as_bytes())
    }
}
