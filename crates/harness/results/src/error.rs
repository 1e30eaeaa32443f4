//! The errors between a row and its file.

use std::path::PathBuf;

/// Why rows or run information could not be read or written; the text names file, line and column as far as they are known.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// An error of the file system.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// The file that was being read or written.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The first line of a CSV file is not the list of columns in [`COLUMNS`](crate::COLUMNS).
    #[error("{path}:1: the header is not this version's: column {position} is `{found}`, expected `{expected}`", path = path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// Counted from one.
        position: usize,
        /// The column there (empty if the header ends before).
        found: String,
        /// The column of this version (empty if the header should have ended).
        expected: String,
    },
    /// A field does not read as its column's type.
    #[error("{path}:{line}: column `{column}`: {what}", path = path.display())]
    Field {
        /// The file.
        path: PathBuf,
        /// The line on which the row begins, from one.
        line: u64,
        /// The column's name.
        column: String,
        /// What is wrong with it.
        what: String,
    },
    /// The file ends in the middle of a row, or a row has too few or too many fields.
    #[error("{path}:{line}: {what}", path = path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The line on which the row begins, from one.
        line: u64,
        /// What is wrong with it.
        what: String,
    },
    /// Whole rows are missing or were added: the file does not have as many as its run wrote.
    #[error("{path}: holds {found} rows, but its run wrote {expected}", path = path.display())]
    RowCount {
        /// The file.
        path: PathBuf,
        /// Rows in the file.
        found: u64,
        /// Rows that `run.json` announces.
        expected: u64,
    },
    /// A file's checksum is not the one from when it was written.
    #[error(
        "{path}: its checksum is not the one in {sums}: one of the two files was altered or damaged after it was written; \
         finish the run again with `run --resume`, or make the data again",
        path = path.display(),
        sums = sums.display()
    )]
    Checksum {
        /// The file.
        path: PathBuf,
        /// The file of checksums.
        sums: PathBuf,
    },
    /// A file that should have a checksum has none.
    #[error("{sums}: has no checksum of {name}: the list was altered, or a part of it is missing", sums = sums.display())]
    Unlisted {
        /// The file of checksums.
        sums: PathBuf,
        /// The file's name.
        name: String,
    },
    /// A file that has a checksum is missing.
    #[error("{path}: is not there, but {sums} has its checksum", path = path.display(), sums = sums.display())]
    Absent {
        /// The file of checksums.
        sums: PathBuf,
        /// The file.
        path: PathBuf,
    },
    /// There are no checksums: the run in the folder is not finished, or an older version wrote it.
    #[error("{path}: is not there: the run did not finish, or an earlier version wrote it; run it again, or continue it with --resume", path = path.display())]
    Unfinished {
        /// The file of checksums.
        path: PathBuf,
    },
    /// There is no such folder, or it holds no run.
    #[error("{folder}: {what}; name the folder of a run, as in reports/default-20260101-120000", folder = folder.display())]
    NoRun {
        /// The folder.
        folder: PathBuf,
        /// What it is instead.
        what: &'static str,
    },
    /// A `run.json` that does not parse; line and column are inside the message.
    #[error("{path}: {source}", path = path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// The parser's error, with line and column.
        source: serde_json::Error,
    },
    /// A `run.json` of another format than [`RUN_FORMAT`](crate::RUN_FORMAT).
    #[error("{path}: format {found}, this program reads format {expected}", path = path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The format it announces.
        found: u32,
        /// The format that is read here.
        expected: u32,
    },
    /// A number that must be finite is not; nothing was written.
    #[error("{path}: `{field}` is {value}: only finite numbers are written", path = path.display())]
    NonFinite {
        /// The file that would have been written.
        path: PathBuf,
        /// The number, with its row if it has one.
        field: String,
        /// Its value.
        value: f64,
    },
}
