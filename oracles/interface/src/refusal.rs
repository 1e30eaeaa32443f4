//! Why there is no answer.

use std::error::Error;

/// Why a question has no answer. An error of an engine is a failure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The engine does not have it.
    Unsupported(String),
    /// The engine failed, or the request is wrong.
    Failed(String),
}

impl<E: Error> From<E> for Refusal {
    fn from(error: E) -> Self {
        Self::Failed(error.to_string())
    }
}
