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
//! A floor uses those above it here, never one below.
//!
//! `crates/mechanics`: what robots are and do, usable without the harness.
//!
//! | crate | purpose | add here |
//! |---|---|---|
//! | `featherbench_spatial` | 6-D spatial algebra over any scalar, and the scalars | a scalar |
//! | `featherbench_model` | what a robot is: joints, topology, parameters, configuration space | a joint |
//! | `featherbench_robots` | generated robots, random states, the random generator | a family of robots |
//! | `featherbench_formats` | how a robot is written: neutral JSON, URDF, MJCF | a format |
//! | `featherbench_dynamics` | what a robot does: one file per algorithm | an algorithm |
//! | `featherbench_rbd` | the crate that programs add: a robot, its quantities, the engines' coordinates | a quantity |
//! | `featherbench_reference` | slow truth that shares no text with `dynamics` | a witness |
//! | `featherbench_contact` | contact problems as data, their solvers, impact laws | a solver, a problem, an impact law |
//! | `featherbench_scenes` | scenes of bodies in contact, their exact answers | a scene |
//! | `featherbench_constrained` | robots with loops: graph, constraints, constrained dynamics | a constraint, a method, a robot with loops |
//! | `featherbench_hybrid` | hybrid systems: events, Zeno, saltation, derivatives of whole runs | a hybrid system |
//! | `featherbench_continua` | rods, beams and strings in one tree with rigid bodies | an element |
//! | `featherbench_residuals` | what a nominal model lacks: τ = ID + r | a residual |
//! | `featherbench_learning` | models learned from motions, and their scores | a learned model |
//! | `featherbench_identification` | base parameters, logs, estimators, bodies that can exist | an estimator |
//! | `featherbench_uncertainty` | what uncertain parameters do to the dynamics | a distribution, a method |
//!
//! `crates/harness`: how a thing is measured.
//!
//! | crate | purpose | add here |
//! |---|---|---|
//! | `featherbench_results` | the row: its columns, files, differences of runs | a column |
//! | `featherbench_parquet` | rows as Parquet, logs in Parquet as CSV; a program that the command builds when it is asked for Parquet | – |
//! | `featherbench_protocol` | messages to an oracle, and its process | – |
//! | `featherbench_bench` | suite, cell, run, store, measures, gates; the traits `Engine` and `Study` | a measure of an error |
//! | `featherbench_kernels` | our engine: which kernel answers which quantity | a kernel's line |
//! | `featherbench_engines` | the other engines: an oracle process, recorded answers; the conformance test | a way to reach an engine |
//! | `featherbench_report` | the frame of the report, and what sections are built of; it knows no study | a building block of pages |
//!
//! `crates/studies`: what is asked.
//!
//! | crate | purpose | add here |
//! |---|---|---|
//! | `featherbench_study` | what every study is made of: entry, rows, cases with known answers, figures | – |
//! | `featherbench_comparison` | engines compared with each other, with the truth, by the file that they read | a study, a section, a plot |
//! | `featherbench_answers` | questions whose answer is known | the same |
//! | `featherbench_speed` | speed and scale | the same |
//! | `featherbench_lesson` | a course's lesson as claims that numbers decide | a claim |
//! | `featherbench_reduction` | failures as small robots, with programs in the engines' own interfaces | an engine's program |
//! | `featherbench_registry` | every study, in the order of a run | a study's line |
//! | `featherbench_doubles` | engines with planted errors, for tests | a kind of error |
//!
//! `crates/cli`: one file per command. Beside the crates stand:
//!
//! | folder | purpose | add here |
//! |---|---|---|
//! | `oracles/` | the programs of the reference engines, in Python, C++ and Rust | an engine |
//! | `datasets/` | robots, suites, recorded answers, golden data | a robot, a suite |
//! | `ci/` | gates, known deviations with their ranges, scripts | a gate, a deviation |
//!
#![doc = include_str!("../../../GLOSSARY.md")]

mod args;
mod compare;
mod fail;
mod list;
mod message;
mod oracles;
mod progress;
mod reduce;
mod report;
mod robots;
mod root;
mod run;

use args::{Cli, Command, OraclesAction, RunArgs};
use clap::{CommandFactory, Parser};
use fail::Fail;
use message::tell;
use root::Root;
use std::process::ExitCode;

fn main() -> ExitCode {
    let ended = dispatch(Cli::parse());
    let lost = message::lost().map(|error| Fail::input(format!("standard output cannot be written: {error}; what was said is lost")));
    let fails: Vec<Fail> = ended.err().into_iter().chain(lost).collect();
    for fail in &fails {
        tell!("error: {fail}");
    }
    fails.first().map_or(ExitCode::SUCCESS, Fail::code)
}

/// Finds the project's folder for the commands that need it: a run's folder can be looked at without.
fn dispatch(cli: Cli) -> Result<(), Fail> {
    let root = || Root::find(cli.root.as_deref());
    let default = || Command::Run(RunArgs::default_suite());
    match cli.command.unwrap_or_else(default) {
        Command::Run(args) => run::run(&root()?, &args),
        Command::Plan(args) => run::plan::plan(&root()?, &args),
        Command::Sweep(args) => run::sweep::sweep(&root()?, &args),
        Command::Reduce(args) => reduce::reduce(&root()?, &args),
        Command::Merge(args) => run::merge::merge(&root()?, &args),
        Command::Compare(args) => compare::compare(&root()?, &args),
        Command::Report(args) => report::write(&args),
        Command::Gate(args) => report::gate::gate(&root()?, &args),
        Command::Diff(args) => report::diff::compare(&args),
        Command::History(args) => report::history::history(&root, &args),
        Command::List(args) => list::list(&root()?, &args),
        Command::Explain(args) => report::explain::explain(&args),
        Command::Export(args) => report::export::export(&args),
        Command::Record(args) => oracles::record::record(&root()?, &args),
        Command::Residuals(args) => robots::residuals::correct(root, &args),
        Command::Uncertainty(args) => robots::uncertainty::propagate(root, &args),
        Command::Gen(args) => robots::generate::generate(&root()?, &args),
        Command::Identify(args) => robots::identify::identify(&root, &args),
        Command::Oracles(args) => match args.action {
            OraclesAction::Install(args) => oracles::install_named(&root()?, &args),
            OraclesAction::Status => oracles::status(&root()?),
            OraclesAction::Check(args) => oracles::check::check(root().ok().as_ref(), &args),
        },
        Command::Completions { shell } => {
            clap_complete::generate(shell, &mut Cli::command(), "featherbench", &mut message::Output);
            Ok(())
        }
        Command::Man => clap_mangen::Man::new(Cli::command())
            .render(&mut message::Output)
            .map_err(|error| Fail::input(format!("standard output: {error}"))),
        Command::Alone => featherbench_engines::alone::serve().map_err(Fail::input),
        Command::Serve(args) => featherbench_engines::native::serve(&args.library, args.core).map_err(Fail::input),
    }
}
