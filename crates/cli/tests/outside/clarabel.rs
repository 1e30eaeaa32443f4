//! Clarabel, if it is installed: a solver of convex problems, which knows no robots.

use super::{Outcome, oracle_command};
use crate::support::{Ended, project};
use std::process::Command;

/// It conforms to the protocol: relaxed contacts and semidefinite least squares have the answers that they have by hand.
pub fn conforms() -> Outcome {
    let python = project().join("target/oracles/clarabel/venv/bin/python");
    if !project().join("target/oracles/clarabel/installed").exists() {
        return Outcome::Skipped("clarabel is not installed (`featherbench oracles install clarabel`)".into());
    }
    let mut check = Command::new(env!("CARGO_BIN_EXE_featherbench"));
    check.current_dir(project()).args(["oracles", "check"]).args(oracle_command(&python, "clarabel"));
    Ended::new(check.output().unwrap()).expect(0, &["conforms"]);
    Outcome::Passed
}
