//! The cell: the unit of work.

use crate::hash;
use crate::{Reading, Refusal};
use serde_json::{Value, json};

/// One evaluation: what is asked of whom, about which problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// The study that asks.
    pub study: String,
    /// The problem's name.
    pub problem: String,
    /// The problem's content hash.
    pub problem_hash: String,
    /// What else defines the work.
    pub params: Value,
    /// The subject's name.
    pub subject: String,
    /// The subject's version.
    pub version: String,
    /// The subject's method.
    pub method: String,
    /// What is asked.
    pub quantity: String,
    /// The arithmetic.
    pub scalar: String,
}

impl Cell {
    /// The cell's id: a hash of everything in it.
    pub fn id(&self) -> String {
        let Self { study, problem, problem_hash, params, subject, version, method, quantity, scalar } = self;
        let content = json!([study, problem, problem_hash, params, subject, version, method, quantity, scalar]);
        hash::of(featherbench_results::canonical_json(&content).as_bytes())[..16].to_owned()
    }

    /// The cell as a path of words: what `--only` matches and progress shows.
    pub fn path(&self) -> String {
        format!("{}/{}/{}/{}/{}", self.study, self.problem, self.subject, self.quantity, self.method)
    }
}

/// What became of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The values, state after state.
    Values(Vec<f64>),
    /// What the subject read from a file: the answer to cells of the reading study alone.
    Reading(Box<Reading>),
    /// No values, and why.
    Refused(Refusal),
}

impl Outcome {
    /// The values, when there are any.
    pub fn values(&self) -> Option<&[f64]> {
        match self {
            Self::Values(values) => Some(values),
            Self::Reading(_) | Self::Refused(_) => None,
        }
    }
}

impl Outcome {
    /// The values, or why there are none; a reading stands for none.
    pub fn answer(&self) -> Result<&[f64], Refusal> {
        match self {
            Self::Values(values) => Ok(values),
            Self::Refused(refusal) => Err(refusal.clone()),
            Self::Reading(_) => Err(Refusal::Failed("the outcome is a robot that was read, and numbers are due".into())),
        }
    }
}

impl From<Result<Vec<f64>, Refusal>> for Outcome {
    fn from(result: Result<Vec<f64>, Refusal>) -> Self {
        result.map_or_else(Self::Refused, Self::Values)
    }
}
