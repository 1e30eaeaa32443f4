//! Runs every kernel of ours on some robots for `ci/instructions.py`, which counts their instructions under callgrind.
//!
//! Prints a line `kernel,model,states` before each. Everything that is counted runs in [`featherbench_measured`], called once per line.

use featherbench_bench::{Engine, Evaluation, Robot};
use featherbench_engines::{Featherbench, counted};
use featherbench_results::ModelOrigin;
use featherbench_robots::{Family, StateBatch};
use std::hint::black_box;

/// One robot of each shape: an arm, a long chain, a tree of short branches, a floating base.
const ROBOTS: [&str; 4] = ["chain:n=10,layout=spatial", "chain:n=100,layout=spatial", "binary_tree:depth=6", "humanoid"];
/// States that each kernel computes, one after the other. A kernel that computes more at once, as a batch does, makes one such call.
const STATES: usize = 4;
const SEED: u64 = 1;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let featherbench = Featherbench::new();
    for robot in ROBOTS {
        let description = Family::parse(robot)?.generate()?;
        let robot = Robot::new(&description, "instructions", ModelOrigin::Generated, 1, SEED)?;
        let states = StateBatch::random(&robot.model, STATES, SEED);
        for (quantity, method) in counted(&robot) {
            let mut prepared = featherbench.prepare(&robot, quantity, method, &states)?;
            // A call of a batch takes as long for one state as for all that it has room for.
            let states = STATES.next_multiple_of(prepared.together());
            // The first call may allocate.
            prepared.clock(0..states)?;
            println!("{}/{method},{},{states}", quantity.name(), robot.name);
            featherbench_measured(prepared.as_mut(), states)?;
        }
    }
    Ok(())
}

/// The function whose instructions callgrind counts.
#[inline(never)]
fn featherbench_measured(prepared: &mut dyn Evaluation, states: usize) -> Result<(), featherbench_bench::NoAnswer> {
    prepared.clock(0..states)?;
    black_box(prepared.read());
    Ok(())
}
