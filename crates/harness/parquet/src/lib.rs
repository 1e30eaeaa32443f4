//! Parquet: the rows of a run for programs that analyse tables, and logs of robots as CSV.
//!
//! This crate alone depends on the crate `parquet`, and no crate depends on this one. The command starts its program, `featherbench-parquet`, when
//! Parquet is asked for. So who never asks for Parquet never compiles it.
//!
//! ```
//! use featherbench_parquet::{table, write_rows};
//! use featherbench_results::Row;
//!
//! let folder = std::env::temp_dir().join(format!("featherbench-parquet-{}", std::process::id()));
//! let row = Row { study: "agreement".into(), ..Row::default() }.informed(0.1);
//! let files = write_rows(&folder, &[row])?;
//! assert!(files[0].ends_with("study=agreement/part-0.parquet"));
//! assert!(table(&files[0])?.starts_with("run,cell,family,robot,"));
//! # std::fs::remove_dir_all(folder).unwrap();
//! # Ok::<(), featherbench_parquet::Error>(())
//! ```

mod rows;
mod table;

pub use rows::write_rows;
pub use table::table;

use featherbench_results::ResultsError;
use std::path::PathBuf;

/// Why a Parquet file could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A run could not be read, or a file not be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A study's name cannot name a folder; nothing was written.
    #[error("{path}: the study '{study}' cannot name a folder: letters, digits, '_' and '-' can; rename the study", path = path.display())]
    Partition {
        /// The folder of all studies.
        path: PathBuf,
        /// The study.
        study: String,
    },
    /// A file could not be read.
    #[error("{path}: {what}", path = path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
}
