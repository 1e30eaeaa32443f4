//! Why a shard cannot be merged.

use std::path::PathBuf;
use thiserror::Error;

/// Why a shard is refused. Each names the folder and says what to do.
#[derive(Debug, Error)]
pub enum ShardError {
    /// The folder is no shard.
    #[error("{path}: is no shard: {what}", path = path.display())]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// What it is instead.
        what: String,
    },
    /// The shard was begun and did not end.
    #[error("{path}: shard {shard} is not finished: it has no shard.json; finish it by its own command with --resume", path = path.display())]
    Unfinished {
        /// The folder.
        path: PathBuf,
        /// Its number.
        shard: String,
    },
    /// A file of the shard was altered, or is cut off.
    #[error("{path}: {what}: it was damaged after it was written; evaluate the shard again", path = path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// Another version wrote the shard.
    #[error(
        "{path}: format {found}, this program reads format {expected}; evaluate the shard again with this program",
        path = path.display()
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// Its format.
        found: u64,
        /// The format that is read here.
        expected: u64,
    },
    /// The shard was made of something else.
    #[error("{path}: was made with another {what} ({then} there, {now} here); merge knowingly with --allow-mixed", path = path.display())]
    Mixed {
        /// The folder.
        path: PathBuf,
        /// What differs.
        what: String,
        /// Its value in the shard.
        then: String,
        /// Its value here.
        now: String,
    },
    /// The shard has cells that the plan has not.
    #[error("{path}: {count} of its cells are not in this plan, {first} first: it belongs to another plan", path = path.display())]
    Stranger {
        /// The folder.
        path: PathBuf,
        /// How many cells.
        count: usize,
        /// The first of them.
        first: String,
    },
    /// Another shard has the same cells.
    #[error(
        "{path}: {count} of its cells are in {other} too, {first} first; leave one of the two out",
        path = path.display(),
        other = other.display()
    )]
    Duplicate {
        /// The folder.
        path: PathBuf,
        /// The folder that has the cells too.
        other: PathBuf,
        /// How many cells.
        count: usize,
        /// The first of them.
        first: String,
    },
}
