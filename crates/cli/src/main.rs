//! The `featherbench` command, and the map of the house. Each command is one file here.
//!
//! # The way of the data
//! ```text
//! suite file → cells → engine → values → rows → gates
//! robot file → description → model ↗       rows → sections → report
//! ```
//! Each stage has one type. A later stage never points back to an earlier one; a test over `cargo metadata` holds the directions of the crates.
//! `featherbench_bench` follows a state, a robot file and a timing sample through it.
//!
//! # The house
//! | crate | purpose | add here |
//! |---|---|---|
//! | `featherbench_spatial` | 6-D spatial algebra over any scalar, and the scalars | a scalar |
//! | `featherbench_model` | what a robot is: joints, topology, parameters, configuration space | a joint |
//! | `featherbench_robots` | generated robots, random states, the random generator | a family of robots |
//! | `featherbench_formats` | how a robot is written: neutral JSON, URDF, MJCF | a format |
//! | `featherbench_dynamics` | what a robot does: one file per algorithm | an algorithm |
//! | `featherbench_contact` | contact problems as data, their solvers, impact laws | a solver, a problem, an impact law |
//! | `featherbench_constrained` | robots with loops: graph, constraints, constrained dynamics | a constraint, a method, a robot with loops |
//! | `featherbench_identification` | base parameters, logs, estimators, bodies that can exist | an estimator |
//! | `featherbench_reference` | slow truth that shares no text with `dynamics` | a witness |
//! | `featherbench_hybrid` | hybrid systems: events, Zeno, saltation, derivatives of whole runs | a hybrid system |
//! | `featherbench_residuals` | what a nominal model lacks: τ = ID + r | a residual |
//! | `featherbench_learning` | models learned from motions, and their scores | a learned model |
//! | `featherbench_uncertainty` | what uncertain parameters do to the dynamics | a distribution, a method |
//! | `featherbench_results` | the row: its columns, files, differences of runs | a column |
//! | `featherbench_parquet` | rows as Parquet, logs in Parquet as CSV; a program that the command builds when it is asked for Parquet | – |
//! | `featherbench_protocol` | messages to an oracle, and its process | – |
//! | `featherbench_bench` | suite, cell, run, store, measures, gates; the traits `Engine` and `Study` | a measure of an error |
//! | `featherbench_kernels` | our engine: which kernel answers which quantity | a kernel's line |
//! | `featherbench_engines` | the other engines: an oracle process, recorded answers; the conformance test | a way to reach an engine |
//! | `featherbench_studies` | one folder per study, with its sections of the report | a study, a section, a plot |
//! | `featherbench_report` | the frame of the report, and what sections are built of; it knows no study | a building block of pages |
//! | `oracles/` | the programs of the reference engines, in Python, C++ and Rust | an engine |
//! | `datasets/` | robots, suites, recorded answers, golden data | a robot, a suite |
//! | `ci/` | gates, known deviations with their ranges, scripts | a gate, a deviation |
//!
#![doc = include_str!("../../../GLOSSARY.md")]

mod args;
mod check;
mod compare;
mod compared;
mod compiled;
mod diff;
mod engines;
mod environment;
mod explain;
mod export;
mod external;
mod fail;
mod figures;
mod filter;
mod gate;
mod generate;
mod history;
mod hyperqueue;
mod identify;
mod instructions;
mod list;
mod merge;
mod native;
mod offers;
mod oracles;
mod outcome;
mod package;
mod parquet;
mod patience;
mod plan;
mod progress;
mod ranges;
mod record;
mod reduce;
mod report;
mod residuals;
mod robot_file;
mod robots;
mod root;
mod run;
mod say;
mod shard;
mod sweep;
mod table;
mod uncertainty;

use args::{Cli, Command, OraclesAction, RunArgs};
use clap::{CommandFactory, Parser};
use fail::Fail;
use root::Root;
use std::process::ExitCode;

fn main() -> ExitCode {
    match dispatch(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(fail) => {
            eprintln!("error: {fail}");
            fail.code()
        }
    }
}

/// Finds the project's folder for the commands that need it: a run's folder can be looked at without.
fn dispatch(cli: Cli) -> Result<(), Fail> {
    let root = || Root::find(cli.root.as_deref());
    let default = || Command::Run(RunArgs::default_suite());
    match cli.command.unwrap_or_else(default) {
        Command::Run(args) => run::run(&root()?, &args),
        Command::Plan(args) => plan::plan(&root()?, &args),
        Command::Sweep(args) => sweep::sweep(&root()?, &args),
        Command::Reduce(args) => reduce::reduce(&root()?, &args),
        Command::Merge(args) => merge::merge(&root()?, &args),
        Command::Compare(args) => compare::compare(&root()?, &args),
        Command::Report(args) => report::write(&args),
        Command::Gate(args) => gate::gate(&root()?, &args),
        Command::Diff(args) => diff::compare(&args),
        Command::History(args) => history::history(&root, &args),
        Command::List(args) => list::list(&root()?, &args),
        Command::Explain(args) => explain::explain(&args),
        Command::Export(args) => export::export(&args),
        Command::Record(args) => record::record(&root()?, &args),
        Command::Residuals(args) => residuals::correct(root, &args),
        Command::Uncertainty(args) => uncertainty::propagate(root, &args),
        Command::Gen(args) => generate::generate(&root()?, &args),
        Command::Identify(args) => identify::identify(&root, &args),
        Command::Oracles(args) => match args.action {
            OraclesAction::Install(args) => oracles::install_named(&root()?, &args),
            OraclesAction::Status => oracles::status(&root()?),
            OraclesAction::Check(args) => check::check(root().ok().as_ref(), &args),
        },
        Command::Completions { shell } => {
            clap_complete::generate(shell, &mut Cli::command(), "featherbench", &mut say::Output);
            Ok(())
        }
        Command::Man => {
            clap_mangen::Man::new(Cli::command()).render(&mut say::Output).map_err(|error| Fail::input(format!("standard output: {error}")))
        }
        Command::Alone => featherbench_engines::alone::serve().map_err(Fail::input),
        Command::Serve(args) => featherbench_engines::native::serve(&args.library, args.core).map_err(Fail::input),
    }
}
