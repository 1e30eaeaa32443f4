//! Why there is no answer.

/// Why a question has no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Dynibo does not have it.
    Unsupported(String),
    /// The engine failed, or the request is wrong.
    Failed(String),
}

impl From<dynibo::Error> for Refusal {
    fn from(error: dynibo::Error) -> Self {
        Self::Failed(error.to_string())
    }
}
