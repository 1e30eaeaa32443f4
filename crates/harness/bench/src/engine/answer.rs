//! What an engine gives: an evaluation that runs, is timed and is read, or the reason why there is none.

use featherbench_protocol::Memory;
use std::ops::Range;
use std::time::{Duration, Instant};
use thiserror::Error;

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoAnswer {
    /// The engine does not offer this, which is known before: a skip.
    #[error("{0}")]
    NotOffered(String),
    /// It failed to answer: an error.
    #[error("{0}")]
    Failed(String),
}

/// An evaluation that is ready: what is timed is what is checked.
pub trait Evaluation: Send {
    /// Evaluates the states of the range.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine fails.
    fn run(&mut self, range: Range<usize>) -> Result<(), NoAnswer>;

    /// Evaluates the states of the range and returns the time. The clock is read once before the loop over the states and once after it.
    /// The process that runs the loop reads it.
    ///
    /// Beyond the end of the batch its states begin again. (An engine that is timed does so; this default does not.) Only the last answer
    /// must be kept.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine fails.
    fn clock(&mut self, range: Range<usize>) -> Result<Duration, NoAnswer> {
        let start = Instant::now();
        self.run(range)?;
        Ok(start.elapsed())
    }

    /// The number of states that [`Evaluation::clock`] evaluates at once. It rounds a range up to a multiple, so a timed range should be one.
    fn together(&self) -> usize {
        1
    }

    /// Relocates all its data to other places in memory, drawn with this seed, if they are not in this process. `false` means that the
    /// engine must be prepared again to relocate its data.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine fails.
    fn relocate(&mut self, _seed: u32) -> Result<bool, NoAnswer> {
        Ok(false)
    }

    /// The overhead that was subtracted from the last time of [`Evaluation::clock`], if times are estimates.
    fn overhead(&self) -> Option<Duration> {
        None
    }

    /// The memory of the process that evaluates, if it is another one than this.
    fn memory(&self) -> Option<Memory> {
        None
    }

    /// The values of the last run, state after state.
    fn read(&self) -> &[f64];
}
