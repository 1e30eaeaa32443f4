//! `shard.json`: what a finished shard is, and of what.

use super::{Shard, ShardError};
use crate::provenance;
use featherbench_results::{Host, RunInfo, atomic_write, seal, unsealed};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the file in a shard's folder. It is written last: a folder without it is not finished.
pub const SHARD_NAME: &str = "shard.json";

/// The format of the file that this version writes and reads.
pub const SHARD_FORMAT: u64 = 1;

/// What a finished shard is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShardFile {
    /// [`SHARD_FORMAT`].
    pub format: u64,
    /// Which of how many: `2/7`.
    pub shard: String,
    /// The arguments of `featherbench` that define the whole run.
    pub arguments: Vec<String>,
    /// The facts that all shards must share.
    pub fingerprint: BTreeMap<String, String>,
    /// When it started.
    pub started: String,
    /// How long its cells took together, in seconds.
    pub seconds: f64,
    /// The machine.
    pub host: Host,
    /// Its cells in the order of the plan.
    pub cells: Vec<String>,
    /// The checksum of its file of outcomes.
    pub outcomes: String,
}

impl ShardFile {
    /// The file of a shard with these cells; the caller adds their time and the checksum of their outcomes.
    pub fn new(shard: Shard, info: &RunInfo, arguments: Vec<String>, cells: Vec<String>) -> Self {
        Self {
            format: SHARD_FORMAT,
            shard: shard.to_string(),
            arguments,
            fingerprint: provenance::fingerprint(info),
            started: info.started.clone(),
            seconds: 0.0,
            host: info.host.clone(),
            cells,
            outcomes: String::new(),
        }
    }

    /// Writes the file into a shard's folder, in one step.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), featherbench_results::ResultsError> {
        let path = folder.join(SHARD_NAME);
        let text = serde_json::to_string_pretty(self);
        let mut bytes = text.map_err(|source| featherbench_results::ResultsError::Json { path: path.clone(), source })?.into_bytes();
        bytes.push(b'\n');
        seal(&mut bytes);
        atomic_write(&path, &bytes)
    }

    /// The contents of a file; `path` is its name in errors.
    ///
    /// # Errors
    /// [`ShardError`] when it is damaged, or another version wrote it.
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self, ShardError> {
        /// Read first: so another format is reported as that, and not as an unknown field.
        #[derive(Deserialize)]
        struct Format {
            format: u64,
        }
        let damaged = |what: String| ShardError::Damaged { path: path.to_owned(), what };
        let body = unsealed(bytes).ok_or_else(|| damaged("its last line is not the checksum of the others".into()))?;
        let Format { format } = serde_json::from_slice(body).map_err(|error| damaged(error.to_string()))?;
        if format != SHARD_FORMAT {
            return Err(ShardError::Format { path: path.to_owned(), found: format, expected: SHARD_FORMAT });
        }
        serde_json::from_slice(body).map_err(|error| damaged(error.to_string()))
    }
}
