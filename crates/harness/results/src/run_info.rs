//! `run.json`: what all rows of a run have in common.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::disk::{atomic_write, read_text};
use crate::names::words;
use crate::{Properties, RecordedTimes, ResultsError, Row, Verdict};

/// Format of `run.json` and `schema.json` that this version writes and reads.
pub const RUN_FORMAT: u32 = 2;

/// Provenance of a run. Text that is not known is empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunInfo {
    /// [`RUN_FORMAT`] when it was written; [`write`](Self::write) sets it.
    pub format: u32,
    /// Id of the run, as in the rows.
    pub run: String,
    /// Name of the suite.
    pub suite: String,
    /// Content hash of the suite file.
    pub suite_hash: String,
    /// The exact command that reproduces the run.
    pub command: String,
    /// When it started, as the caller wrote it (usually RFC 3339).
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
    /// Seed of the run; each cell's seed is made from it.
    pub seed: u64,
    /// Whether the engines themselves answered, not recordings of them.
    pub live: bool,
    /// Number of rows in `rows.csv`.
    pub rows: u64,
    /// The engines.
    pub engines: Vec<EngineInfo>,
    /// The robots.
    pub robots: Vec<RobotInfo>,
    /// The studies that were conducted, in their order.
    pub studies: Vec<String>,
    /// Wall time of each phase, in seconds.
    pub seconds: BTreeMap<String, f64>,
    /// Cores that other programs kept busy, on average, while a study took times.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub others: BTreeMap<String, f64>,
    /// The conditions of the run, each with the number that is expected and the number that was found.
    pub expected: Vec<Expectation>,
    /// The conventions of the engines, compared with ours.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conventions: Vec<Convention>,
    /// The drawings of robots, by name. They are in a file of their own, [`DRAWINGS_NAME`](crate::DRAWINGS_NAME); an older version had them here.
    #[serde(default, skip_serializing)]
    pub drawings: BTreeMap<String, crate::Drawing>,
    /// The files of the run that have checksums. An older version did not say them, and had no checksum of outcomes and fingerprint.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
    /// The shards that the run was merged from; none if one process made it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shards: Vec<ShardInfo>,
    /// The times that were recorded on other machines (`datasets/speed`): a run times only what is built.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub recorded_times: Vec<RecordedTimes>,
}

/// A part of a run that was evaluated apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShardInfo {
    /// Which of how many: `2/7`.
    pub shard: String,
    /// When it started.
    pub started: String,
    /// How long its cells took together, in seconds.
    pub seconds: f64,
    /// The machine.
    pub host: Host,
    /// Number of its cells.
    pub cells: u64,
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
    /// The source of an engine's answers.
    EngineSource {
        /// Our own kernels, in this process.
        Own = "own",
        /// Answers recorded earlier, read from a file.
        Recorded = "recorded",
        /// The engine itself, during the run.
        Live = "live",
    }
}

/// One engine of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EngineInfo {
    /// Name, as in the rows.
    pub name: String,
    /// The version it reports.
    pub version: String,
    /// The day on which that version was released. Empty if it is not known; an older version of this file did not say it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub released: String,
    /// The source of its answers.
    pub source: EngineSource,
    /// Build flags and the like, by name.
    pub build: BTreeMap<String, String>,
    /// `ok`, or a word for the error.
    pub status: String,
    /// The reason, if the status is not `ok`.
    pub reason: String,
}

words! {
    /// The origin of a model.
    ModelOrigin {
        /// A generator.
        Generated = "generated",
        /// A description of a real robot.
        Robot = "robot",
    }
}

/// One model of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotInfo {
    /// Name, as in the rows.
    pub name: String,
    /// Content hash of its description.
    pub hash: String,
    /// Generated, or a real robot.
    pub origin: ModelOrigin,
    /// Licence of the description.
    pub licence: String,
    /// The source of the description, or the generator's text.
    pub source: String,
    /// Length of the configuration vector.
    pub nq: u64,
    /// Degrees of freedom.
    pub nv: u64,
    /// Moving bodies.
    pub bodies: u64,
    /// Joints on the longest path from base to leaf.
    pub depth: u64,
    /// Its warnings: numbers that were normalised, bodies without mass.
    #[serde(default)]
    pub notes: Vec<String>,
    /// The properties that known deviations are told by; a run of an older version has none.
    #[serde(default)]
    pub properties: Option<Properties>,
}

/// A convention of an engine, and ours.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Convention {
    /// The engine, as in the rows.
    pub engine: String,
    /// Its topic: free v, screw pitch, armature.
    pub topic: String,
    /// The engine's convention.
    pub theirs: String,
    /// Our convention.
    pub ours: String,
    /// The function that converts, or why none is needed.
    pub conversion: String,
    /// The test that asks the engine itself, and fails if the convention does not hold.
    pub test: String,
}

words! {
    /// What a condition of a run is about.
    GateKind {
        /// Every judged row is inside its bound.
        Bound = "bound",
        /// Every question that an engine offers to answer has a value.
        Answer = "answer",
        /// Nothing is skipped that `oracles/engines.toml` does not name.
        Unlisted = "unlisted skip",
        /// There are rows.
        Rows = "rows",
        /// A known deviation still occurs.
        Seen = "known deviation seen",
        /// A known deviation has its known size.
        Size = "known deviation size",
        /// What an engine does not offer is still not offered.
        Lack = "lack",
        /// Computed bounds are sharp enough to find errors.
        Sharp = "sharp bound",
        /// The mean and the largest value over robots.
        Mean = "mean",
        /// Cells and rows of a complete run.
        Counts = "counts",
        /// An engine that was asked for takes part.
        Engine = "engine",
        /// Engines import a file alike.
        Import = "import",
        /// A condition of a run that an older version wrote.
        Other = "other",
    }
}

/// Who a condition that is not met is about; what is not known is empty.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Culprit {
    /// The study.
    pub study: String,
    /// The robot.
    pub robot: String,
    /// The engine.
    pub engine: String,
    /// The quantity.
    pub quantity: String,
    /// The method.
    pub method: String,
}

/// A condition on the number of rows: the suite's own gate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// What it is about.
    #[serde(default = "GateKind::unknown")]
    pub kind: GateKind,
    /// Who it is about, if it is not met.
    #[serde(default)]
    pub culprit: Culprit,
    /// The rows that are counted: "drake: passing rows of fd".
    pub what: String,
    /// The number that the suite expects.
    pub expected: u64,
    /// The number found.
    pub found: u64,
    /// The judgement.
    pub verdict: Verdict,
    /// Why it does not pass.
    pub reason: String,
}

impl GateKind {
    /// The kind of a condition that names none.
    const fn unknown() -> Self {
        Self::Other
    }
}

impl Culprit {
    /// A culprit of which only the engine is known.
    pub fn engine(name: &str) -> Self {
        Self { engine: name.to_owned(), ..Self::default() }
    }

    /// All that a row names.
    pub fn of(row: &Row) -> Self {
        Self {
            study: row.study.clone(),
            robot: row.robot.clone(),
            engine: row.engine.clone(),
            quantity: row.quantity.clone(),
            method: row.method.clone(),
        }
    }
}

impl Expectation {
    /// A condition that is met if both numbers are equal.
    pub fn new(kind: GateKind, what: String, expected: u64, found: u64) -> Self {
        let met = expected == found;
        let reason = if met { String::new() } else { format!("expected {expected}, found {found}") };
        Self { kind, culprit: Culprit::default(), what, expected, found, verdict: if met { Verdict::Pass } else { Verdict::Fail }, reason }
    }

    /// The condition with the one it is about.
    pub fn about(self, culprit: Culprit) -> Self {
        Self { culprit, ..self }
    }

    /// The condition with another reason, if it is not met.
    pub fn because(self, reason: String) -> Self {
        if self.is_met() { self } else { Self { reason, ..self } }
    }

    /// Whether it is met.
    pub fn is_met(&self) -> bool {
        self.verdict == Verdict::Pass
    }
}

impl RobotInfo {
    /// Its name and its properties, if the run has them.
    pub fn known_properties(&self) -> Option<(String, Properties)> {
        Some((self.name.clone(), self.properties.clone()?))
    }
}

/// Other programs that keep less than this of a core busy are not told.
const QUIET: f64 = 0.2;

impl RunInfo {
    /// A sentence, if other programs were busy while times were taken.
    pub fn busy(&self) -> Option<String> {
        let most = self.others.values().copied().max_by(f64::total_cmp).filter(|&cores| cores >= QUIET)?;
        Some(format!(
            "Other programs kept {most:.1} of {} cores busy while times were taken: what that did to them is in their intervals.",
            self.host.cores
        ))
    }

    /// Whether a file of the run must have a checksum.
    pub fn has_file(&self, name: &str) -> bool {
        self.files.iter().any(|file| file == name)
    }

    /// Reads a `run.json`; unknown fields, another format and a truncated file are errors.
    pub fn read(path: &Path) -> Result<Self, ResultsError> {
        Self::parse(&read_text(path)?, path)
    }

    /// The contents of a `run.json`; `path` is its name in errors.
    pub fn parse(text: &str, path: &Path) -> Result<Self, ResultsError> {
        /// Read first: so another format is reported as that, and not as an unknown field.
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

    /// Writes a `run.json` in one step, with the current format.
    pub fn write(&self, path: &Path) -> Result<(), ResultsError> {
        let numbers = self
            .seconds
            .iter()
            .chain(&self.others)
            .map(|(phase, &number)| (phase.as_str(), number))
            .chain(self.host.load.map(|load| ("load", load)));
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
