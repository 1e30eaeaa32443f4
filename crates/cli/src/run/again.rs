//! This program again, in a new process that evaluates some cells of a run.

use crate::args::RunArgs;
use crate::fail::Fail;
use crate::run::Prepared;
use featherbench_bench::run::{self, NewProcess};
use std::process::Command;

/// How it is started: with the arguments that say what the cells of the run are.
#[derive(Debug)]
pub struct Again(Vec<String>);

impl Again {
    pub fn of(args: &RunArgs) -> Self {
        Self(args.defining())
    }
}

impl NewProcess for Again {
    fn command(&self, study: &str) -> Command {
        // The file of a running program may have been replaced: Linux keeps the old one under this name.
        let program = std::path::Path::new("/proc/self/exe");
        let program = if program.exists() { Ok(program.to_owned()) } else { std::env::current_exe() };
        let mut command = Command::new(program.unwrap_or_else(|_| "featherbench".into()));
        command.arg("run").args(&self.0).args(["--answer", study]);
        command
    }
}

/// What such a process does.
pub fn answer(prepared: &Prepared) -> Result<(), Fail> {
    let context = prepared.context();
    for study in &prepared.studies {
        run::answer(study.as_ref(), &context, std::io::stdin().lock(), std::io::stdout().lock())?;
    }
    Ok(())
}
