//! Reproductions of known deviations: modules of `oracles/featherbench_oracles/ENGINE/reproductions`, each run in a process of its own.

use crate::oracle::{checked, shaped};
use featherbench_bench::NoAnswer;
use featherbench_protocol::{Limits, Message, Process};
use serde_json::json;
use std::ffi::OsString;

/// Asks `command` (`python -m featherbench_oracles.abilities.reproduce`) for a reproduction's values at the seeds 0..`seeds`.
///
/// # Errors
/// [`NoAnswer::Failed`] when the process or the reproduction fails, or the number of values is wrong.
pub fn reproduce(command: &[OsString], limits: Limits, name: &str, seeds: u64) -> Result<Vec<f64>, NoAnswer> {
    let mut process = Process::start(command, limits).map_err(NoAnswer::Failed)?;
    let request = Message::new(json!({"op": "reproduce", "name": name, "seeds": seeds}), Vec::new());
    let answer = checked(process.ask(&request).map_err(NoAnswer::Failed)?)?;
    shaped(&answer, "value", &[seeds as usize])
}
