//! Suites: the contents of a run.

use crate::{FileBase, HarnessError};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A suite file, `datasets/suites/NAME.toml`. Unknown keys are errors.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Suite {
    /// The purpose of the suite, one sentence.
    pub about: String,
    /// Seed of every state.
    pub seed: u64,
    /// The robots.
    #[serde(default)]
    pub robot: Vec<RobotEntry>,
    /// The agreement study.
    pub agreement: Option<AgreementEntry>,
    /// The operations study.
    #[serde(default)]
    pub operations: bool,
    /// Whether the accuracy study is made.
    #[serde(default)]
    pub accuracy: bool,
    /// Whether the import study is made. It needs live engines, and robots that come from a file.
    #[serde(default)]
    pub import: bool,
    /// Whether the conditioning study is made.
    #[serde(default)]
    pub conditioning: bool,
    /// Whether known deviations are reproduced.
    #[serde(default)]
    pub reproductions: bool,
    /// Whether the study of small steps is made. It needs engines that integrate.
    #[serde(default)]
    pub steps: bool,
    /// The timing study.
    pub timing: Option<TimingEntry>,
    /// Whether the suite can show every known deviation of its robots, and a sharp bound for each method, joint and base. A complete run
    /// must then show them.
    #[serde(default)]
    pub thorough: bool,
    /// Rows that a complete run must have, passing or with a known deviation: engine → quantity → count.
    #[serde(default)]
    pub expect: BTreeMap<String, BTreeMap<String, u64>>,
}

/// A robot of a suite: a committed model, a generator's text, or a file of the robots' package, which only live runs have.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotEntry {
    /// Name of a file in `datasets/models`, without its extension.
    pub model: Option<String>,
    /// Arguments of `featherbench gen`.
    pub generate: Option<String>,
    /// A URDF file below the package folder of example-robot-data.
    pub urdf: Option<String>,
    /// An MJCF file below the folder of packages; MuJoCo's compiler determines the robot.
    pub mjcf: Option<String>,
    /// Whether the URDF's base floats.
    #[serde(default)]
    pub floating: bool,
    /// The bases of a file's robot, `fixed` and `free`. Each is a separate robot; `-free` is appended to the name of the free one.
    pub bases: Option<Vec<String>>,
    /// The family in rows.
    pub family: String,
    /// The number of agreement states, if it is not the suite's.
    pub states: Option<usize>,
    /// If given, all states are random, with the angles of revolute joints in (−reach, reach).
    pub reach: Option<f64>,
    /// If given, all states are random, with velocities this many times larger.
    pub speed: Option<f64>,
    /// The name in rows, if the model's own name would occur twice.
    pub name: Option<String>,
    /// The studies that use it; all by default.
    pub studies: Option<Vec<String>>,
}

/// Settings of the agreement study.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AgreementEntry {
    /// States per robot.
    pub states: usize,
    /// The engines beside ours.
    pub engines: Vec<String>,
}

/// Settings of the timing study.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimingEntry {
    /// Distinct states in the stream.
    pub states: usize,
    /// Seconds for each candidate, on each quantity of each robot in each cache regime.
    pub seconds: f64,
    /// Native oracles, and oracles whose clock estimates, that are timed beside our own kernels if they are installed.
    #[serde(default)]
    pub peers: Vec<String>,
}

impl RobotEntry {
    /// The bases of a file's robot, and whether each needs a name of its own.
    pub fn bases(&self) -> Vec<(FileBase, bool)> {
        match &self.bases {
            None => vec![(if self.floating { FileBase::Free } else { FileBase::Fixed }, false)],
            Some(bases) => bases.iter().filter_map(|base| FileBase::parse(base)).map(|base| (base, base == FileBase::Free)).collect(),
        }
    }
}

impl Suite {
    /// Reads a suite file, with the hash of its text.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn read(path: &Path) -> Result<(Self, String), HarnessError> {
        let text = std::fs::read_to_string(path).map_err(|source| HarnessError::io(path, source))?;
        Ok((Self::parse(&text, path)?, crate::hash::of(text.as_bytes())))
    }

    /// The suite of a text; `path` is its name in errors.
    ///
    /// # Errors
    /// [`HarnessError`], naming file, line and key.
    pub fn parse(text: &str, path: &Path) -> Result<Self, HarnessError> {
        let suite: Self =
            toml::from_str(text).map_err(|error| HarnessError::Config { path: path.to_owned(), message: error.to_string() })?;
        for entry in &suite.robot {
            let sources = [&entry.model, &entry.generate, &entry.urdf, &entry.mjcf];
            if sources.into_iter().flatten().count() != 1 {
                let message = format!("a [[robot]] of family '{}' must have exactly one of model, generate, urdf and mjcf", entry.family);
                return Err(HarnessError::Config { path: path.to_owned(), message });
            }
            let of_file = entry.urdf.is_some() || entry.mjcf.is_some();
            let known = |bases: &Vec<String>| of_file && !entry.floating && bases.iter().all(|base| FileBase::parse(base).is_some());
            if !entry.bases.as_ref().is_none_or(known) {
                let message = format!(
                    "a [[robot]] of family '{}': bases is a list of fixed and free, for urdf and mjcf, without floating",
                    entry.family
                );
                return Err(HarnessError::Config { path: path.to_owned(), message });
            }
        }
        Ok(suite)
    }
}
