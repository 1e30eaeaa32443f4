//! Instruction counts that could not be taken are reported with the reason. Otherwise they would look like counts without changes.

use super::{Outcome, Unpassed, exists};
use crate::support::{Ended, project};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

/// Runs `ci/instructions.py` with these programs alone: their names, and what they do.
fn counted(programs: &[(&str, &str)], python: &Path, arguments: &[&str], required: bool) -> Ended {
    let folder = tempfile::tempdir().unwrap();
    for (name, does) in programs {
        let path = folder.path().join(name);
        std::fs::write(&path, format!("#!/bin/sh\n{does}\n")).unwrap();
        std::fs::set_permissions(&path, PermissionsExt::from_mode(0o755)).unwrap();
    }
    let mut command = Command::new(python);
    command.arg(project().join("ci/instructions.py")).args(arguments).env("PATH", folder.path()).env_remove("FEATHERBENCH_REQUIRE_ALL");
    if required {
        command.env("FEATHERBENCH_REQUIRE_ALL", "1");
    }
    Ended::new(command.output().unwrap())
}

pub fn not_counted() -> Outcome {
    if !exists("python3") || !cfg!(target_arch = "x86_64") {
        return Err(Unpassed::Skipped("there is no python3, or the machine is no x86-64".into()));
    }
    // The interpreter's path, as the search path will have no Python.
    let output = Command::new("python3").args(["-c", "import sys; print(sys.executable)"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let python = Path::new(text.trim());
    let missing = "not counted: there is no valgrind";
    counted(&[], python, &[], false).expect(0, &[missing, "apt-get install"]);
    counted(&[], python, &[], true).expect(1, &[missing]);
    counted(&[], python, &["--accept"], false).expect(1, &[missing]);
    let (valgrind, rustc) = (("valgrind", "exit 0"), ("rustc", "echo 'rustc 0.0.0'"));
    counted(&[valgrind], python, &[], false).expect(1, &["not counted: rustc cannot be started"]);
    let refused = [valgrind, rustc, ("cargo", "exit 101")];
    counted(&refused, python, &[], false).expect(1, &["not counted: `cargo build", "failed (101)"]);
    let broken = [("valgrind", "echo broken >&2; exit 3"), rustc, ("cargo", "exit 0")];
    counted(&broken, python, &[], false).expect(1, &["not counted: `valgrind", "failed (3): broken"]);
    let silent = [valgrind, rustc, ("cargo", "exit 0")];
    counted(&silent, python, &[], false).expect(1, &["not counted: 0 kernels ran"]);
    Ok(())
}
