//! What a run says of each engine: who is right, by how much, and how fast.

use crate::ResultsError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The engines of a run, from the smallest error of forward dynamics. Those without one come last.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Ranking {
    /// The suite.
    pub suite: String,
    /// When the run started.
    pub started: String,
    /// Model name of the processor.
    pub machine: String,
    /// The engines.
    pub engines: Vec<Ranked>,
}

/// What a run says of an engine.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Ranked {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Questions with a bound that it was asked.
    pub asked: usize,
    /// Those whose answer is within the bound.
    pub right: usize,
    /// Those whose answer is beyond it for a known cause.
    pub known: usize,
    /// The errors of its usual method against the truth, by quantity.
    pub errors: BTreeMap<String, Errors>,
    /// The times of its fastest method over ours, by quantity: those of the run, else those that other machines recorded.
    pub times: BTreeMap<String, Times>,
    /// Its gravest finding; empty if it has none.
    pub gravest: String,
}

/// Errors of one method over robots, free of units. The error of a robot is the median over its states: where an answer is the small difference
/// of large numbers, one state says nothing of the method.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// The method.
    pub method: String,
    /// The number of robots.
    pub robots: usize,
    /// The number of states, of all robots together.
    pub states: usize,
    /// The median over the robots.
    pub median: f64,
    /// The largest.
    pub worst: f64,
    /// The robot that has it.
    pub worst_robot: String,
    /// The largest error over a robot's conditioning bound, where that is known.
    pub of_bound: Option<f64>,
}

/// Times of an engine over ours, over robots.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Times {
    /// The number of robots.
    pub robots: usize,
    /// The median over the robots.
    pub median: f64,
    /// The least.
    pub least: f64,
    /// The most.
    pub most: f64,
    /// Whether one of them is an estimate.
    pub estimated: bool,
    /// Other machines that recorded them; none if this run measured them.
    pub machines: usize,
}

/// Times of an engine over ours that another machine measured: a line of `datasets/speed/MACHINE/times.json`, and of `run.json` of later runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedTimes {
    /// Model name of the processor, and its widest registers.
    pub machine: String,
    /// When the run started that measured them.
    pub started: String,
    /// The engine's name.
    pub engine: String,
    /// Its version.
    pub version: String,
    /// What is computed.
    pub quantity: String,
    /// The number of robots.
    pub robots: usize,
    /// The median over the robots.
    pub median: f64,
    /// The least.
    pub least: f64,
    /// The most.
    pub most: f64,
    /// Whether one of them is an estimate.
    pub estimated: bool,
}

impl RecordedTimes {
    /// The lines of a file.
    ///
    /// # Errors
    /// When the text is not such a file.
    pub fn parse(path: &Path, text: &str) -> Result<Vec<Self>, ResultsError> {
        serde_json::from_str(text).map_err(|source| ResultsError::Json { path: path.to_owned(), source })
    }
}
