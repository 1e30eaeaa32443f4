//! Why a log is refused.

/// A log that cannot be used, with file and line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}{}: {problem}", .line.map_or_else(String::new, |line| format!(":{line}")))]
pub struct LogError {
    /// The file.
    pub file: String,
    /// The line, counted from 1; the row where the file has no lines.
    pub line: Option<usize>,
    /// What is wrong.
    pub problem: LogProblem,
}

/// What is wrong with a log.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LogProblem {
    /// The file cannot be read.
    #[error("{0}")]
    Unreadable(String),
    /// A Parquet file.
    #[error(
        "is a Parquet file: `featherbench identify` reads it, the library reads CSV; `featherbench-parquet table FILE` prints it as CSV"
    )]
    Parquet,
    /// A column is missing.
    #[error("there is no column '{column}'{}; without it the joint's torque cannot be computed. Name columns time, q.JOINT, v.JOINT, a.JOINT, tau.JOINT", near(.present))]
    MissingColumn {
        /// The column.
        column: String,
        /// The columns that are there.
        present: Vec<String>,
    },
    /// Two columns have one name.
    #[error("two columns are named '{column}'; keep one")]
    TwoColumns {
        /// The column.
        column: String,
    },
    /// A joint with a quaternion without velocities.
    #[error(
        "joint '{joint}' has an orientation, whose numbers are no velocities when differentiated; log its velocity in body axes as v.{joint}"
    )]
    NeedsVelocity {
        /// The joint.
        joint: String,
    },
    /// A field is no number.
    #[error("column '{column}' has '{text}', which is no number; leave the row out, or write one")]
    NoNumber {
        /// The column.
        column: String,
        /// The text.
        text: String,
    },
    /// NaN or infinite.
    #[error("column '{column}' is {value}; one such number spoils every estimate. Leave the row out, or fill it by interpolation")]
    NotFinite {
        /// The column.
        column: String,
        /// The number.
        value: f64,
    },
    /// Time stands still or goes back.
    #[error("time goes from {before} s to {after} s; sort the rows by time and leave repeated ones out: derivatives need rising times")]
    TimeNotRising {
        /// Before.
        before: f64,
        /// After.
        after: f64,
    },
    /// A quaternion of another length.
    #[error("the quaternion from column '{column}' on has length {length}; divide it by that, and order it x, y, z, w")]
    NotAQuaternion {
        /// Its first column.
        column: String,
        /// Its length.
        length: f64,
    },
    /// Fewer than two rows.
    #[error("fewer than two rows; a log has a line of column names and a row per time")]
    Empty,
    /// No stretch is as long as the window.
    #[error("no stretch of {window} rows without a gap, so no derivative can be taken; give a log with more rows, or a shorter window")]
    TooShort {
        /// Rows of the window.
        window: usize,
    },
    /// Derivatives are missing, and no window was asked for.
    #[error("the log has no {missing}, and no window to differentiate by was given; log them, or give a window")]
    NoDerivatives {
        /// What is missing.
        missing: &'static str,
    },
}

/// Names that are there, a few of them.
fn near(present: &[String]) -> String {
    let shown: Vec<&str> = present.iter().take(8).map(String::as_str).collect();
    let more = if present.len() > shown.len() { ", …" } else { "" };
    if shown.is_empty() { String::new() } else { format!(" (there are {}{more})", shown.join(", ")) }
}
