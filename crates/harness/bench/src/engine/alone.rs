//! One method of one engine on one generated robot, measured in a process of its own: time, memory and the answer.
//!
//! A process of its own has its own limits of memory and time. So an engine that fails at a size says why, and the run goes on.

use crate::{Engine, NoAnswer, Quantity, Robot};
use featherbench_protocol::{Limits, Memory};
use featherbench_robots::Family;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// The engine's name.
    pub engine: String,
    /// The generator's text, as of `featherbench gen`.
    pub robot: String,
    /// The quantity.
    pub quantity: Quantity,
    /// The engine's method.
    pub method: String,
    /// Threads of the process, for methods of ours that use several; other methods and engines run on one.
    pub threads: usize,
    /// The seed of the state.
    pub seed: u64,
    /// Seconds for the blocks of calls.
    pub seconds: f64,
    /// The limits of the process.
    pub limits: Limits,
}

/// The result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Degrees of freedom.
    pub dofs: usize,
    /// Seconds from the description to a model with its workspace.
    pub build: f64,
    /// Seconds per call, block after block.
    pub calls: Vec<f64>,
    /// The memory of the process after the last call.
    pub memory: Option<Memory>,
    /// The answer at the state.
    pub answer: Vec<f64>,
}

/// Measures a question in a process of its own; an error is the reason why there is no answer.
pub type Ask = Arc<dyn Fn(&Question) -> Result<Measured, NoAnswer> + Send + Sync>;

/// Blocks of calls, if there is time for them.
const BLOCKS: usize = 15;
/// The least number of blocks, unless they take [`LONG`] times the seconds that the question gives them.
const FEWEST: usize = 3;
/// After so many times the seconds of the question no block begins: the slowest calls have one block, and a time without an interval.
const LONG: f64 = 5.0;
/// A block takes this long or a call: a reading of the clock takes some 20 ns.
const BLOCK: Duration = Duration::from_micros(50);
/// The most calls in a block.
const MOST_CALLS: usize = 1 << 16;

/// The robot of a generator's text at one random state.
///
/// # Errors
/// [`NoAnswer::Failed`] when the text is no robot.
pub fn robot(spec: &str, seed: u64) -> Result<Robot, NoAnswer> {
    let failed = |error: &dyn std::error::Error| NoAnswer::Failed(format!("{spec}: {error}"));
    let description = Family::parse(spec).and_then(|family| family.generate()).map_err(|error| failed(&error))?;
    Robot::at_one_state(spec, description, seed).map_err(|error| failed(&error))
}

/// Measures an engine on a robot. `memory` is asked once all has run and everything is still in place.
///
/// # Errors
/// [`NoAnswer`] of the engine.
pub fn measure(
    engine: &dyn Engine,
    robot: &Robot,
    question: &Question,
    memory: impl FnOnce() -> Option<Memory>,
) -> Result<Measured, NoAnswer> {
    let (quantity, start) = (question.quantity, Instant::now());
    let mut prepared = engine.prepare(robot, quantity, &question.method, &robot.states)?;
    let build = start.elapsed().as_secs_f64();
    prepared.run(0..1)?;
    let answer = prepared.read().to_vec();
    let due = quantity.size(robot);
    if answer.len() != due {
        return Err(NoAnswer::Failed(format!("{} numbers came, {due} are due", answer.len())));
    }
    let (together, begun) = (prepared.together(), Instant::now());
    let first = prepared.clock(0..together)?.as_secs_f64();
    // Without a clock beside its loop an engine may not take more states than it was sent.
    let calls = if engine.has_clock() { (BLOCK.as_secs_f64() / first.max(1e-9)).ceil() as usize } else { 1 };
    let calls = calls.clamp(1, MOST_CALLS).next_multiple_of(together);
    let mut blocks = Vec::with_capacity(BLOCKS);
    if calls == together {
        blocks.push(first / calls as f64);
    }
    let more = |blocks: usize, seconds: f64| match blocks {
        0 => true,
        few if few < FEWEST => seconds < LONG * question.seconds,
        _ => blocks < BLOCKS && seconds < question.seconds,
    };
    while more(blocks.len(), begun.elapsed().as_secs_f64()) {
        blocks.push(prepared.clock(0..calls)?.as_secs_f64() / calls as f64);
    }
    let memory = prepared.memory().or_else(memory);
    Ok(Measured { dofs: robot.states.nv, build, calls: blocks, memory, answer })
}
