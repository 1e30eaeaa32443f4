//! Programs in our own Python package, which read the robot from the file beside them: it is the neutral format.

use super::{Interface, Theirs};
use featherbench_bench::Robot;

pub const FEATHERBENCH: Interface = Interface {
    begin: "from pathlib import Path

import numpy as np
from featherbench import Robot

robot = Robot.from_json(Path(__file__).with_name(\"robot.json\"))
",
    body: |_, _| Some(String::new()),
    end: "",
    armature: "",
    answers: &[
        ("id", "rnea_packed", "robot.inverse_dynamics(q, v, a)"),
        ("bias", "rnea_packed", "robot.bias_force(q, v)"),
        ("mass_matrix", "crba", "robot.mass_matrix(q)"),
        ("fd", "aba", "robot.forward_dynamics(q, v, tau)"),
        ("fd", "ltdl", "robot.solve(q, tau - robot.bias_force(q, v))"),
    ],
    theirs,
};

fn theirs(robot: &Robot) -> Option<Theirs> {
    let nv = robot.states.nv;
    let unit = |i: usize| (0..nv).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
    Some(Theirs { q: robot.states.q(0).to_vec(), t: (0..nv).map(unit).collect(), b: vec![0.0; nv] })
}
