//! Requests of the oracle protocol that more than one place sends.

use featherbench_bench::Robot;
use featherbench_protocol::Block;
use featherbench_robots::StateBatch;
use serde_json::{Value, json};

/// The description of a robot in the form of the protocol.
///
/// # Errors
/// A sentence, when the description is not a robot.
pub(crate) fn description(robot: &Robot) -> Result<Value, String> {
    let line = featherbench_formats::neutral::to_line(&robot.description).map_err(|error| error.to_string())?;
    serde_json::from_str(&line).map_err(|error| error.to_string())
}

/// The header and blocks of the request `states`.
pub(crate) fn states(robot: &Robot, states: &StateBatch) -> (Value, Vec<Block>) {
    let (count, nv) = (states.count(), states.nv);
    let blocks = vec![
        Block::new("q", &[count, states.nq], &states.q),
        Block::new("v", &[count, nv], &states.v),
        Block::new("a", &[count, nv], &states.a),
        Block::new("tau", &[count, nv], &states.tau),
        Block::new("wrench", &[count, states.bodies, 6], &states.wrench),
        Block::new("probe", &[4, nv], &robot.probe()),
    ];
    (json!({"op": "states", "count": count}), blocks)
}
