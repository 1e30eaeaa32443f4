//! How the command ends when it does not end well.

use featherbench_bench::HarnessError;
use std::process::ExitCode;
use thiserror::Error;

/// A failure with its exit code.
#[derive(Debug, Error)]
pub enum Fail {
    /// A gate failed, or engines disagree.
    #[error("{0}")]
    Gate(String),
    /// Usage or bad input.
    #[error("{0}")]
    Input(String),
    /// A required engine is missing.
    #[error("{message}\n  {advice}")]
    Missing { message: String, advice: String },
}

impl Fail {
    pub fn input(message: String) -> Self {
        Self::Input(message)
    }

    pub fn code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Gate(_) => 1,
            Self::Input(_) => 2,
            Self::Missing { .. } => 3,
        })
    }
}

impl From<HarnessError> for Fail {
    fn from(error: HarnessError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<featherbench_results::ResultsError> for Fail {
    fn from(error: featherbench_results::ResultsError) -> Self {
        Self::Input(error.to_string())
    }
}
