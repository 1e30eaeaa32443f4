//! What can go wrong in a batch.

use crate::{DimensionError, NotPositiveDefinite};
use thiserror::Error;

/// A batch was not computed, or some of its states failed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BatchError {
    /// An array has the wrong length. Nothing was computed.
    #[error("{0}; give each array one vector per state")]
    Dimension(#[from] DimensionError),
    /// Some states failed. NaN stands in place of their results; the other states' results are valid.
    #[error("{} of {states} states failed, the first is {}; the results of the others are valid", failures.len(), first(failures))]
    Failed {
        /// The states that failed, the first first. There is at least one.
        failures: Vec<Failure>,
        /// The number of states in the batch.
        states: usize,
    },
}

/// A state that failed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("state {state}: {cause}")]
pub struct Failure {
    /// The state's place in the batch, counted from 0.
    pub state: usize,
    /// Why it failed.
    pub cause: Cause,
}

/// Why a state failed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Cause {
    /// A number that was given is NaN or infinite.
    #[error("entry {entry} of its part of {array} is {value}; give a finite number")]
    Input {
        /// The array.
        array: &'static str,
        /// The place in the state's part of the array, counted from 0.
        entry: usize,
        /// The number.
        value: f64,
    },
    /// The joint-space inertia matrix is not positive definite at this state.
    #[error(transparent)]
    NotPositiveDefinite(#[from] NotPositiveDefinite),
    /// A result is NaN or infinite, although each given number is finite.
    #[error(
        "entry {entry} of its part of {array} is {value}; give smaller numbers or a higher precision, quaternions that are not zero, and \
         finite parameters"
    )]
    Result {
        /// The array.
        array: &'static str,
        /// The place in the state's part of the array, counted from 0.
        entry: usize,
        /// The number.
        value: f64,
    },
}

fn first(failures: &[Failure]) -> String {
    failures.first().map(ToString::to_string).unwrap_or_default()
}
