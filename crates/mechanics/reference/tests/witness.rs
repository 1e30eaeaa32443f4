//! The Python witness, asked as an oracle: its doubles are those of the Rust witness, to the bit.
//!
//! Skipped where there is no Python with mpmath, unless `FEATHERBENCH_REQUIRE_ALL` is set.

use crate::support;

use featherbench_model::Model;
use featherbench_reference::{Precision, Robot, nearest_doubles};
use featherbench_robots::StateBatch;
use std::io::Write;
use support::oracle::{Oracle, python};
use support::{State, describe};

/// Every kind of joint, with few degrees of freedom: Python is slow.
const ROBOTS: [&str; 4] = [
    "chain:n=12,layout=spatial,tip_scale=1e6",
    "joints:kind=common,base=free,shape=single",
    "joints:kind=helical,base=free,shape=single",
    "tree:n=6,joints=all,armature=true",
];

#[test]
fn both_witnesses_round_to_the_same_doubles() {
    let Some(python) = python("mpmath, numpy") else {
        // Written to standard error directly: a passing test hides the output of print macros.
        let skip = b"skipped: the Python witness: no mpmath below target/oracles; run `featherbench oracles install`\n";
        std::io::stderr().write_all(skip).unwrap();
        assert!(std::env::var_os("FEATHERBENCH_REQUIRE_ALL").is_none(), "the Python witness is missing");
        return;
    };
    let mut oracle = Oracle::start(&python, "truth");
    for family in ROBOTS {
        let description = describe(family);
        let batch = StateBatch::agreement(&Model::build(&description).unwrap(), 4, 9);
        let state = |k| State { q: batch.q(k).to_vec(), v: batch.v(k).to_vec(), a: batch.a(k).to_vec(), tau: batch.tau(k).to_vec() };
        let states: Vec<State> = (0..batch.count()).map(state).collect();
        assert!(oracle.prepare(&description, &states), "{family}");
        let robot = Robot::new(&description, Precision::for_dofs(description.nv())).unwrap();
        for (quantity, method) in [("id", "virtual_work"), ("bias", "virtual_work"), ("mass_matrix", "pseudo_inertia"), ("fd", "cholesky")]
        {
            let answers = oracle.evaluate(quantity, method, states.len());
            for (answer, State { q, v, a, tau }) in answers.chunks_exact(answers.len() / states.len()).zip(&states) {
                let ours = match quantity {
                    "id" => robot.inverse_dynamics(q, v, a).unwrap(),
                    "bias" => robot.bias(q, v).unwrap(),
                    "mass_matrix" => robot.mass_matrix(q).unwrap().entries().to_vec(),
                    _ => robot.forward_dynamics(q, v, tau).unwrap(),
                };
                assert_eq!(answer, nearest_doubles(&ours), "{family}: {quantity}");
            }
        }
    }
}
