//! The trait [`Subject`]: anyone who answers.

use crate::{Problem, Quantity};
use model::StateBatch;
use record::EngineSource;
use std::collections::BTreeMap;
use std::ops::Range;
use std::time::{Duration, Instant};
use thiserror::Error;

/// Who a subject is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The engine's name in records.
    pub name: String,
    /// The version it reports.
    pub version: String,
    /// Native, recorded or live.
    pub source: EngineSource,
    /// Language, flags, versions of libraries.
    pub build: BTreeMap<String, String>,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Refusal {
    /// The subject does not offer this: known beforehand, a skip.
    #[error("{0}")]
    Unsupported(String),
    /// It should have answered and did not: an error.
    #[error("{0}")]
    Failed(String),
}

/// An engine that can be asked about robots.
pub trait Subject: Send + Sync {
    /// Who it is.
    fn identity(&self) -> &Identity;

    /// Its methods for a quantity, its usual one first; none when it does not offer the quantity.
    fn methods(&self, quantity: Quantity) -> Vec<String>;

    /// Gets ready to evaluate a quantity by a method over a batch of states.
    ///
    /// # Errors
    /// [`Refusal`] when the robot, quantity or method is not supported, or the subject breaks.
    fn prepare<'a>(
        &'a self,
        problem: &'a Problem,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Prepared + 'a>, Refusal>;
}

/// An evaluation that is ready: what is timed is what is checked.
pub trait Prepared: Send {
    /// Evaluates the states of the range.
    ///
    /// # Errors
    /// [`Refusal`] when the subject fails.
    fn run(&mut self, range: Range<usize>) -> Result<(), Refusal>;

    /// Evaluates the states of the range and says how long that took: one reading of the clock before the loop over the states and one
    /// after it, both in the process that runs the loop.
    ///
    /// Beyond the end of the batch its states begin again (a subject that is timed answers so; this plain form does not), and no answer but
    /// the last need be kept.
    ///
    /// # Errors
    /// [`Refusal`] when the subject fails.
    fn clock(&mut self, range: Range<usize>) -> Result<Duration, Refusal> {
        let start = Instant::now();
        self.run(range)?;
        Ok(start.elapsed())
    }

    /// The values of the last run, state after state.
    fn read(&self) -> &[f64];
}
