//! What can go wrong in the harness itself (an engine that fails is a row, not an error).

use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// An error of the harness. Each names the file and the way out.
#[derive(Debug, Error)]
pub enum HarnessError {
    /// A file or folder could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A configuration file is not understood.
    #[error("{path}: {message}")]
    Config {
        /// The file.
        path: PathBuf,
        /// Line, field and what is expected there.
        message: String,
    },
    /// The folder holds something already.
    #[error("{path} exists and is not empty; name another folder with --out, or continue that run with --resume")]
    Occupied {
        /// The folder.
        path: PathBuf,
    },
    /// The run was started by another program or another plan.
    #[error("{path} was made with another {what} ({then} then, {now} now); start a new run, or mix knowingly with --allow-mixed")]
    Mixed {
        /// The folder.
        path: PathBuf,
        /// What differs.
        what: String,
        /// What it was.
        then: String,
        /// What it is.
        now: String,
    },
    /// There is no run to continue.
    #[error("{path} holds no run to resume; leave out --resume to start one")]
    NothingToResume {
        /// The folder.
        path: PathBuf,
    },
    /// The records refuse.
    #[error(transparent)]
    Row(#[from] featherbench_results::ResultsError),
}

impl HarnessError {
    /// An I/O error at a path.
    pub fn io(path: &Path, source: io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }
}
