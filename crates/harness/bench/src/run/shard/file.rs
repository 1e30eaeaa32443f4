//! `shard.json`: what a finished shard is, and of what.

use super::journal::{self, JOURNAL_NAME};
use super::{Shard, ShardError};
use crate::run::FINGERPRINT_NAME;
use crate::{Entries, HarnessError, OUTCOMES_NAME, provenance};
use featherbench_results::{Host, RunInfo, atomic_write, checksum_of, seal, unsealed};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of the file in a shard's folder. It is written last: a folder without it is not finished.
pub const SHARD_NAME: &str = "shard.json";

/// The other files of a finished shard, which no longer change.
const FINISHED: [&str; 2] = [FINGERPRINT_NAME, OUTCOMES_NAME];

/// The format of the file that this version writes and reads.
pub const SHARD_FORMAT: u64 = 2;

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
    /// The checksums of its other files that are finished, by name.
    pub files: BTreeMap<String, String>,
    /// The checksum of the last line of its journal, which may grow: the folder's process may be started again. Empty if there is no journal.
    pub journal: String,
}

impl ShardFile {
    /// The file of a shard with these cells; [`finish`](Self::finish) adds their time and the checksums of the shard's files.
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
            files: BTreeMap::new(),
            journal: String::new(),
        }
    }

    /// Adds the time of the cells and the checksums of the files of a shard's folder, and writes the file into it, last.
    ///
    /// # Errors
    /// When a file cannot be read or written, or the journal is damaged.
    pub fn finish(mut self, folder: &Path) -> Result<Self, HarnessError> {
        let entries = Entries::open(folder)?;
        self.seconds = self.cells.iter().filter_map(|id| entries.seconds(id)).sum();
        for name in FINISHED {
            self.files.insert(name.to_owned(), checksum_of(&folder.join(name))?);
        }
        let path = folder.join(JOURNAL_NAME);
        if path.is_file() {
            let bytes = std::fs::read(&path).map_err(|source| HarnessError::io(&path, source))?;
            let sums = journal::checked(&bytes).map_err(|line| HarnessError::Config {
                path,
                message: format!("line {line} is damaged; remove the file, and evaluate the shard again with --resume"),
            })?;
            self.journal = sums.last().cloned().unwrap_or_default();
        }
        self.write(folder)?;
        Ok(self)
    }

    /// Checks every byte of the shard's other files.
    pub(super) fn check(&self, folder: &Path) -> Result<(), ShardError> {
        let damaged = |path: PathBuf, what: String| ShardError::Damaged { path, what };
        for name in FINISHED {
            let path = folder.join(name);
            match (checksum_of(&path), self.files.get(name)) {
                (Err(error), _) => return Err(damaged(path, error.to_string())),
                (Ok(found), due) if due != Some(&found) => {
                    return Err(damaged(path, format!("its checksum is not the one in {SHARD_NAME}")));
                }
                _ => {}
            }
        }
        if self.journal.is_empty() {
            return Ok(());
        }
        let path = folder.join(JOURNAL_NAME);
        match std::fs::read(&path).map(|bytes| journal::checked(&bytes)) {
            Err(error) => Err(damaged(path, error.to_string())),
            Ok(Err(line)) => Err(damaged(path, format!("the checksum of line {line} is another one"))),
            Ok(Ok(sums)) if !sums.contains(&self.journal) => Err(damaged(path, format!("it lacks the last line that {SHARD_NAME} knows"))),
            Ok(Ok(_)) => Ok(()),
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
