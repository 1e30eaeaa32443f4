//! Why a report could not be written.

use featherbench_results::ResultsError;

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file could not be written; the text names it.
    #[error(transparent)]
    Write(#[from] ResultsError),
    /// The data of the page could not be turned into JSON.
    #[error("the report's data: {0}")]
    Json(#[from] serde_json::Error),
}
