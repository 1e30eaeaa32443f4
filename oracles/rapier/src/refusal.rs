//! Why there is no answer.

/// Why a question has no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Rapier does not have it.
    Unsupported(String),
    /// The engine failed, or the request is wrong.
    Failed(String),
}

impl Refusal {
    /// The status and the reason of the answer.
    pub fn told(&self) -> (&'static str, &str) {
        match self {
            Self::Unsupported(reason) => ("unsupported", reason),
            Self::Failed(reason) => ("error", reason),
        }
    }
}

/// A failure with this reason.
pub fn failed(reason: impl ToString) -> Refusal {
    Refusal::Failed(reason.to_string())
}
