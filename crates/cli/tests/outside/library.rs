//! Engines that cargo builds as libraries, if they are built.

use super::native::{self, PATIENT};
use super::{Outcome, Unpassed};
use crate::support::{Ended, Sandbox, project};
use featherbench_engines::Oracle;
use std::path::PathBuf;
use std::process::Command;

/// The engines.
pub const NAMES: [&str; 3] = ["dynibo", "faer", "nalgebra"];

/// The library of an engine, if it was compiled from the present sources.
pub fn library(name: &str) -> Result<PathBuf, Unpassed> {
    let sandbox = Sandbox::new();
    for name in ["Cargo.toml", ".cargo", "crates"] {
        std::os::unix::fs::symlink(project().join(name), sandbox.path(name)).unwrap();
    }
    let built = PathBuf::from("target/oracles").join(name);
    std::fs::create_dir_all(sandbox.path("target/oracles")).unwrap();
    std::os::unix::fs::symlink(project().join(&built), sandbox.path(built.to_str().unwrap())).unwrap();
    // The other engines are missing, so that they are not started.
    let status = sandbox.run(&["oracles", "status"]).output;
    let line = status.lines().find(|line| line.starts_with(&format!("{name} "))).unwrap_or_else(|| panic!("{name} is not in {status}"));
    let file = PathBuf::from(line.rsplit(' ').next().unwrap()).file_name().map(|file| project().join(built).join("release").join(file));
    let there = file.filter(|file| (line.contains(".so") || line.contains(".dylib")) && file.is_file());
    there.ok_or_else(|| Unpassed::Skipped(format!("{name} is not built (`featherbench oracles install {name}`)")))
}

/// A test that asks an engine.
pub fn with(name: &str, test: fn(&Oracle)) -> Outcome {
    let library = library(name)?;
    test(&native::start(&library, PATIENT, None).unwrap());
    Ok(())
}

/// It conforms to the protocol, and says these words.
pub fn conforms(name: &str, words: &[&str]) -> Outcome {
    let library = library(name)?;
    let program = env!("CARGO_BIN_EXE_featherbench");
    let command = &mut Command::new(program);
    let ended = Ended::new(command.current_dir(project()).args(["oracles", "check", program, "serve"]).arg(library).output().unwrap());
    ended.expect(0, &[&["conforms"], words].concat());
    Ok(())
}
