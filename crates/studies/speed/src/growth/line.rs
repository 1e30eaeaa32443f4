//! What one method of one engine did along a line: the text of an outcome.

use featherbench_bench::alone::Measured;
use featherbench_bench::hash;
use serde::{Deserialize, Serialize};

/// A method along a line.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Grown {
    /// The sizes with an answer, ascending.
    pub(super) points: Vec<Point>,
    /// The first size without one.
    pub(super) stop: Option<Stop>,
}

/// One size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Point {
    pub(super) tree: String,
    pub(super) dofs: usize,
    pub(super) build: f64,
    /// Seconds per call, block after block.
    pub(super) calls: Vec<f64>,
    /// Bytes.
    pub(super) peak: Option<u64>,
    pub(super) resident: Option<u64>,
    pub(super) error: Option<f64>,
    /// Content hash of the answer's bits: two answers are the same if their hashes are.
    pub(super) answer: String,
}

/// The end of a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Stop {
    pub(super) size: u64,
    pub(super) tree: String,
    pub(super) reason: String,
    /// Whether the engine offers this and failed.
    pub(super) offered: bool,
}

impl Point {
    pub(super) fn of(tree: &str, measured: Measured, error: Option<f64>) -> Self {
        let Measured { dofs, build, calls, memory, answer } = measured;
        let answer = hash::of(&answer.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>());
        let (peak, resident) = memory.map(|memory| (memory.peak, memory.resident)).unzip();
        Self { tree: tree.into(), dofs, build, calls, peak, resident, error, answer }
    }
}

impl Grown {
    pub(super) fn to_text(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| error.to_string())
    }

    /// What a text says.
    ///
    /// # Errors
    /// A sentence, when it is none of these.
    pub(super) fn of_text(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|error| format!("the outcome is no line of sizes: {error}"))
    }
}
