//! Errors of a run itself. (An engine that fails is a row, not an error.)

use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// An error of a run. Each names the file and says what to do.
#[derive(Debug, Error)]
pub enum HarnessError {
    /// A file or folder could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The folder of a run cannot be made.
    #[error("{path}: the folder cannot be made: {source}; name another one with --out")]
    NoFolder {
        /// The folder.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A configuration file has an error.
    #[error("{path}: {message}")]
    Config {
        /// The file.
        path: PathBuf,
        /// Line, field and what is expected there.
        message: String,
    },
    /// The folder is not empty.
    #[error("{path} exists and is not empty; name another folder with --out, or continue that run with --resume")]
    Occupied {
        /// The folder.
        path: PathBuf,
    },
    /// The run was started by another program or with another plan.
    #[error("{path} was made with another {what} ({then} then, {now} now); start a new run, or mix knowingly with --allow-mixed")]
    Mixed {
        /// The folder.
        path: PathBuf,
        /// What differs.
        what: String,
        /// Its value in the run that exists.
        then: String,
        /// Its value now.
        now: String,
    },
    /// There is no run to continue.
    #[error("{path} holds no run to resume: it has no fingerprint.json; leave out --resume to start one")]
    NothingToResume {
        /// The folder.
        path: PathBuf,
    },
    /// A URDF file has an error.
    #[error(transparent)]
    Urdf(#[from] featherbench_formats::urdf::UrdfError),
    /// An error of the rows.
    #[error(transparent)]
    Row(#[from] featherbench_results::ResultsError),
}

impl HarnessError {
    /// An I/O error at a path.
    pub fn io(path: &Path, source: io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }
}
