//! The command line.

use crate::external::External;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;

/// Who is right, by how much, and how fast: dynamics engines on one and the same robots.
#[derive(Debug, Parser)]
#[command(name = "featherbench", version, about, after_help = EXAMPLES)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The project's folder; by default the one that FEATHERBENCH_ROOT names, the nearest one from here upwards, or the one that the program was built in.
    #[arg(long, global = true, value_name = "DIR")]
    pub root: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  featherbench                                 the default suite against the recorded answers; no Python needed
  featherbench run --live                      ask the engines themselves (installs them on first use)
  featherbench run --filter 'panda/.*/fd'        only some cells
  featherbench compare my_robot.urdf           do the engines read my robot alike, and if not, why?
  featherbench gen chain --n 1000 --out c.json a robot of one's own
  featherbench explain 3f2a reports/LATEST     what a cell asked and what was answered

Exit codes: 0 good, 1 a gate failed, engines disagree or two runs differ, 2 usage or bad input, 3 a required engine is missing.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a suite: evaluate, compare, judge, report.
    Run(RunArgs),
    /// Ask whether the engines read robots' files alike, and if not, where and why.
    Compare(CompareArgs),
    /// Write the report of a run again from its records.
    Report(FolderArgs),
    /// Judge a run by its records: exit 1 when a gate fails.
    Gate(GateArgs),
    /// List suites, robots, engines, studies and families of generated robots.
    List(ListArgs),
    /// Compare two runs: what changed beyond noise; exit 1 when something did.
    Diff(DiffArgs),
    /// Append the times of our kernels in a run to a history, one file per machine.
    History(HistoryArgs),
    /// Explain a cell of a run: what was asked, what was answered, how it was judged.
    Explain(ExplainArgs),
    /// Ask the engines and keep their answers in datasets/recorded.
    Record(RecordArgs),
    /// Write a robot, generated or read from URDF or MJCF, as a description, URDF or MJCF.
    Gen(GenArgs),
    /// Identify a robot's parameters from a log, or write a motion that tells them.
    Identify(IdentifyArgs),
    /// Tell what the residuals of a robot's description do to its torques and accelerations: friction, compliance, drives, payload.
    Residuals(ResidualsArgs),
    /// Tell what uncertain parameters do to a robot's accelerations or torques: moments, quantiles, sensitivities.
    Uncertainty(UncertaintyArgs),
    /// Set up and look at the reference engines.
    Oracles(OraclesArgs),
    /// Serve a native library by the oracle protocol: what a run starts as a child process.
    #[command(hide = true)]
    Serve(ServeArgs),
    /// Measure one of our own methods on a generated robot, in this process: what a run starts as a child process.
    #[command(hide = true)]
    Alone,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Examples:\n  featherbench run --suite smoke\n  featherbench run --live --out reports/today\n  featherbench run --engine mine=./my_oracle --engine 'chain=python3 oracles/chain.py'\n  featherbench run --resume --out reports/today"
)]
pub struct RunArgs {
    /// The suite: a name in datasets/suites, or a TOML file.
    #[arg(long, default_value = "default")]
    pub suite: String,
    /// Ask the engines themselves instead of their recorded answers.
    #[arg(long)]
    pub live: bool,
    /// The seed of the states, instead of the suite's; recorded answers are to the suite's own.
    #[arg(long, requires = "live")]
    pub seed: Option<u64>,
    /// An engine of one's own, as NAME=PROGRAM [ARGS…]: a program that speaks oracles/PROTOCOL.md; may be repeated.
    #[arg(long = "engine", value_name = "NAME=PROGRAM")]
    pub externals: Vec<External>,
    /// Only cells whose path study/robot/engine/quantity/method matches this regular expression.
    #[arg(long, value_name = "REGEX")]
    pub filter: Option<String>,
    /// The run's folder; by default a new one in reports/.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Continue the run in --out: finished cells are kept.
    #[arg(long, requires = "out")]
    pub resume: bool,
    /// Continue although program, target features, libm, suite or a program of --engine differ.
    #[arg(long, requires = "resume")]
    pub allow_mixed: bool,
    /// Leave the timing study out.
    #[arg(long)]
    pub no_timing: bool,
    /// Where recorded answers are read from; by default datasets/recorded.
    #[arg(long, value_name = "DIR")]
    pub recorded: Option<PathBuf>,
    /// Longest wait for one answer of an engine, in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 120)]
    pub timeout: u64,
    /// Address space of each engine's process, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = 8192)]
    pub memory: u64,
}

#[derive(Debug, Clone, Args)]
#[command(after_help = "\
Examples:
  featherbench compare my_robot.urdf                     a fixed base, all engines
  featherbench compare my_robot.urdf --floating          the same robot on a free joint
  featherbench compare a.urdf b.urdf --engines pinocchio,mujoco
  featherbench compare scene.xml --out reports/scene     an MJCF file; MuJoCo's compiler is the reference

Two routes, kept apart. Neutral: one model through each engine's programming interface; a difference there is an algorithm's. As read: the
file through each engine's own parser; a difference there is told by body, field and cause, and the engine's answers are replayed with our
kernels on what it says to have read. What that does not explain is called unexplained.

A difference is of one of three classes. Physics: the mass matrix or the inverse dynamics change by more than rounding (1e-12, and 1e-14 for each
joint of a chain beyond a hundred), a body or joint is another, the answers are not explained, or the engine refuses the file. Rounding: a
field that enters them differs, and they do not. Not read: what enters neither, such as damping, friction, limits or the order of joints. Only
physics makes the exit code 1; with --strict the two others do as well.

Limits: XML nested 500 elements deep, 10 MB; an engine that gives no answer in time, or whose workspace does not fit into its memory, is left out
with a row that says so, and counts as a difference with --strict only.

Exit codes: 0 the engines read the files alike, 1 the physics differ, 2 a file cannot be compared (the others are), 3 an engine is missing.")]
pub struct CompareArgs {
    /// Robots: URDF or MJCF files.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Give each URDF's base six degrees of freedom (an MJCF says itself what floats).
    #[arg(long)]
    pub floating: bool,
    /// The engines that are asked.
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub engines: Option<Vec<String>>,
    /// Exit 1 also for differences that change no physics: fields that an engine does not read, rounding, files beyond its limits.
    #[arg(long)]
    pub strict: bool,
    /// Longest wait for one answer of an engine, in seconds; it is asked no more about that robot then.
    #[arg(long, value_name = "SECONDS", default_value_t = 60)]
    pub timeout: u64,
    /// The run's folder; by default a new one in reports/.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// A word that can stand in the name of a file.
fn file_name(text: &str) -> Result<String, String> {
    let plain = !text.is_empty() && text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit());
    if plain { Ok(text.to_owned()) } else { Err("use small letters and digits".into()) }
}

#[derive(Debug, Clone, Args)]
pub struct FolderArgs {
    /// A run's folder.
    pub folder: PathBuf,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Example, the sizes of known deviations over twenty seeds:\n  for seed in $(seq 1 20); do featherbench run --live --no-timing --seed $seed --out reports/seed-$seed; done\n  featherbench gate reports/seed-* --ranges --write"
)]
pub struct GateArgs {
    /// A run's folder.
    pub folder: PathBuf,
    /// More runs, for --ranges.
    #[arg(requires = "ranges", value_name = "FOLDER")]
    pub others: Vec<PathBuf>,
    /// Measure how large each known deviation is on each robot, over runs of one suite with different seeds.
    #[arg(long, group = "measured")]
    pub ranges: bool,
    /// Count the cells and the rows that pass or deviate as known, by study, engine and quantity.
    #[arg(long, group = "measured")]
    pub counts: bool,
    /// With --ranges or --counts: write what was measured into ci/deviations/SUITE.csv or ci/counts.csv, in the place of what
    /// stands there about the suite. Each range keeps the deviation that the file names; a new one takes the only deviation of
    /// ci/deviations/ENGINE.toml that matches.
    #[arg(long, requires = "measured")]
    pub write: bool,
    /// With --ranges --write: the runs are of another processor, which rounds otherwise. Write ci/deviations/SUITE-NAME.csv beside SUITE.csv: a
    /// range spans both.
    #[arg(long, requires_all = ["write", "ranges"], value_name = "NAME", value_parser = file_name)]
    pub processor: Option<String>,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "What changes: a verdict; a count; an error by a factor of 4; a time when the intervals of both runs are apart and their ratio is beyond 2 % and the A/A controls of both; a row that only one run has. Times that do not count are not compared.\n\nExit codes: 0 nothing changed beyond noise, 1 something did, 2 usage or bad input.\n\nExample:\n  featherbench diff reports/before reports/after --markdown"
)]
pub struct DiffArgs {
    /// The folder of the first run.
    #[arg(value_name = "RUN_A")]
    pub before: PathBuf,
    /// The folder of the second run.
    #[arg(value_name = "RUN_B")]
    pub after: PathBuf,
    /// Print a Markdown table.
    #[arg(long)]
    pub markdown: bool,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Example:\n  python ci/instructions.py --out counts.csv\n  featherbench history reports/timing --instructions counts.csv --to datasets/history"
)]
pub struct HistoryArgs {
    /// The folder of a run with times.
    pub folder: PathBuf,
    /// The robot whose times are kept.
    #[arg(long, default_value = "humanoid")]
    pub model: String,
    /// Instruction counts, as `ci/instructions.py --out` writes them.
    #[arg(long, value_name = "CSV")]
    pub instructions: Option<PathBuf>,
    /// The folder of histories; by default reports/history, which git ignores. The project's own are in datasets/history.
    #[arg(long, value_name = "DIR")]
    pub to: Option<PathBuf>,
}

#[derive(Debug, Clone, Args)]
pub struct ListArgs {
    /// The suite whose robots and cells are listed.
    #[arg(long, default_value = "default")]
    pub suite: String,
    /// List every cell of the suite by its path.
    #[arg(long)]
    pub cells: bool,
    /// List the conventions of the engines beside ours, as CONVENTIONS.md shows them.
    #[arg(long, conflicts_with = "cells")]
    pub conventions: bool,
}

#[derive(Debug, Clone, Args)]
#[command(after_help = "Example:\n  featherbench explain 3f2a reports/default-20260101-120000")]
pub struct ExplainArgs {
    /// The cell's id, or the beginning of it.
    pub cell: String,
    /// The run's folder.
    pub folder: PathBuf,
}

#[derive(Debug, Clone, Args)]
pub struct RecordArgs {
    /// The suite whose robots are recorded.
    #[arg(long, default_value = "default")]
    pub suite: String,
    /// Compare with what is recorded instead of writing: exit 1 when an answer moved by more than 8ε.
    #[arg(long)]
    pub check: bool,
    /// Where the recordings stand; by default datasets/recorded.
    #[arg(long, value_name = "DIR")]
    pub recorded: Option<PathBuf>,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Examples:\n  featherbench gen chain --n 1000 --out chain.json\n  featherbench gen tree --seed 7 --set joints=all --set base=free --out tree.json\n  featherbench gen urdf --file robot.urdf --floating --out robot.json\n  featherbench gen mjcf --file scene.xml --out robot.json   what MuJoCo's compiler makes of it\n  featherbench gen neutral --file robot.json --out robot.urdf\n  featherbench gen humanoid --lossy --out humanoid.xml\n\n`featherbench list` names the families and their parameters."
)]
pub struct GenArgs {
    /// A family of generated robots (also with its parameters, as in `chain:n=20,layout=spatial`), or a file's format: `urdf`, `mjcf`, `neutral`.
    pub family: String,
    /// Number of links.
    #[arg(long)]
    pub n: Option<usize>,
    /// Seed of a random family.
    #[arg(long)]
    pub seed: Option<u64>,
    /// Any other parameter, as key=value; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub parameters: Vec<String>,
    /// The file, for `urdf`, `mjcf` and `neutral`.
    #[arg(long, value_name = "FILE", required_if_eq_any([("family", "urdf"), ("family", "mjcf"), ("family", "neutral")]))]
    pub file: Option<PathBuf>,
    /// Give the URDF's base six degrees of freedom.
    #[arg(long)]
    pub floating: bool,
    /// Read joints that mimic another as joints of their own, instead of tying them by a loop.
    #[arg(long)]
    pub independent_mimics: bool,
    /// Let moving bodies have no mass.
    #[arg(long)]
    pub allow_massless: bool,
    /// Where to write the robot; standard output by default.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// The format; by default what the ending of --out says (.json, .urdf, .xml).
    #[arg(long)]
    pub format: Option<Format>,
    /// Leave out what the format cannot hold, naming it, instead of refusing.
    #[arg(long)]
    pub lossy: bool,
}

#[derive(Debug, Clone, Args)]
#[command(after_help = "\
Examples:
  featherbench identify arm.urdf --excite motion.csv              a motion within the limits that tells the parameters
  featherbench identify arm.urdf log.csv                          inertias, viscous and Coulomb friction; who fits how well
  featherbench identify arm.urdf log.parquet --method log_cholesky --out arm_identified.urdf
  featherbench identify arm.json log.csv --terms armature,viscous,coulomb,offset --json

The log has the columns time, q.JOINT, tau.JOINT, and v.JOINT and a.JOINT if they were measured, as CSV or Parquet (plain or Snappy). What is not
measured is differentiated: a polynomial of --order over --window rows around each row. Positions, velocities and torques get the same filter. A
sample is taken every --stride rows.

Gaps in time, saturated torques and combinations of parameters that the motion does not tell are flagged with their line and consequence. A missing
column, NaN, or times that do not rise are refused.

Methods: ordinary, weighted and total least squares; log_cholesky and semidefinite give bodies that can exist. semidefinite asks Clarabel
(`featherbench oracles install clarabel`). Intervals are of 95 %.

Exit codes: 0 good, 1 what is held out is predicted worse than by the description, 2 usage or bad input, 3 a required engine is missing.")]
pub struct IdentifyArgs {
    /// The robot: a description, URDF or MJCF file.
    #[arg(value_name = "ROBOT")]
    pub robot: PathBuf,
    /// The log: CSV or Parquet.
    #[arg(value_name = "LOG", required_unless_present = "excite")]
    pub log: Option<PathBuf>,
    /// Write a motion that tells the parameters, as a log, instead of reading one.
    #[arg(long, value_name = "FILE", conflicts_with = "log")]
    pub excite: Option<PathBuf>,
    /// Give a URDF's base six degrees of freedom.
    #[arg(long)]
    pub floating: bool,
    /// The estimator.
    #[arg(long, value_enum, default_value = "weighted")]
    pub method: Estimator,
    /// What is identified beside inertias: armature, viscous, coulomb, offset, or none.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "TERMS", default_value = "viscous,coulomb")]
    pub terms: Vec<Term>,
    /// Rows of the window that derivatives are taken by: an odd number; 1 takes the log as it is.
    #[arg(long, value_name = "ROWS", default_value_t = 21)]
    pub window: usize,
    /// The order of the polynomial.
    #[arg(long, default_value_t = 4)]
    pub order: usize,
    /// Rows from one sample to the next; by default the window, so that samples share no noise.
    #[arg(long, value_name = "ROWS")]
    pub stride: Option<usize>,
    /// The share of samples, at the end, that is not fitted but predicted.
    #[arg(long, value_name = "SHARE", default_value_t = 0.25)]
    pub held_out: f64,
    /// Base frequency of --excite, Hz.
    #[arg(long, value_name = "HZ", default_value_t = 0.1)]
    pub frequency: f64,
    /// Write the robot with its new parameters: .json, .urdf or .xml.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Leave out what the format of --out cannot hold, naming it, instead of refusing.
    #[arg(long)]
    pub lossy: bool,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// An estimator of `identify`.
#[derive(Debug, Clone, Copy, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Estimator {
    Ordinary,
    Weighted,
    Total,
    LogCholesky,
    Semidefinite,
}

/// What `identify` identifies beside inertias.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Term {
    Armature,
    Viscous,
    Coulomb,
    Offset,
    None,
}

/// How a robot is written.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum Format {
    /// The neutral description, which holds everything.
    Neutral,
    /// URDF.
    Urdf,
    /// MuJoCo's format.
    Mjcf,
}

#[derive(Debug, Clone, Args)]
#[command(after_help = "\
Examples:
  featherbench residuals worn-arm                        a drawn state
  featherbench residuals my_robot.json --state now.json --json

The state's file: {\"q\": […], \"v\": […], \"a\": […], \"tau\": […], \"inner\": […]}; without inner, drives put out what is commanded.")]
pub struct ResidualsArgs {
    /// A description (.json), or a robot of datasets/models, with a section `residuals`.
    pub robot: String,
    /// The state: a JSON file.
    #[arg(long, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// The seed of the state, if none is given.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Clone, Args)]
#[command(after_help = "\
Examples:
  featherbench uncertainty panda                                    every mass ± 20 %, at a drawn state
  featherbench uncertainty robot.json --method chaos                the section 'uncertain' of the file, by polynomial chaos
  featherbench uncertainty robot.urdf --spread 0.05 --indices       which mass matters for which joint
  featherbench uncertainty chain:n=7,layout=spatial --method random --samples 100000000 --threads 2

Methods: first-order (y(μ) and J Σ Jᵀ), unscented, chaos (Gauss quadrature, exact for smooth answers of few parameters), random (Monte Carlo), sobol
(scrambled Sobol' points; the default). The last two have standard errors, quantiles and densities, and the same digits for any number of threads.

A state file is {\"q\":[…],\"v\":[…],\"drive\":[…]}; drive is joint forces, or with --torque accelerations.

Exit codes: 0 good, 2 usage or bad input.")]
pub struct UncertaintyArgs {
    /// A description (.json) or URDF file, a robot of datasets/models, or a family of generated robots.
    pub robot: String,
    /// How the uncertainty is propagated.
    #[arg(long, value_enum, default_value_t = Propagation::Sobol)]
    pub method: Propagation,
    /// Samples, of the methods that sample.
    #[arg(long, default_value_t = 65536, value_name = "N")]
    pub samples: u64,
    /// Threads; by default all cores.
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// The seed of the samples, and of the state if none is given.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// The state: a JSON file.
    #[arg(long, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// Make each mass uniform within this part of its value, in the place of what the description says. Without either, 0.2.
    #[arg(long, value_name = "PART")]
    pub spread: Option<f64>,
    /// The order of polynomial chaos; by default the largest up to 6 that takes at most 100 000 nodes.
    #[arg(long, value_name = "P")]
    pub order: Option<usize>,
    /// Torques of accelerations, instead of accelerations of torques.
    #[arg(long)]
    pub torque: bool,
    /// Also Sobol' indices: the part of the variance that each parameter explains.
    #[arg(long)]
    pub indices: bool,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// How uncertainty is propagated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Propagation {
    /// First order.
    FirstOrder,
    /// The unscented transform.
    Unscented,
    /// Polynomial chaos.
    Chaos,
    /// Random points: Monte Carlo.
    Random,
    /// Scrambled Sobol' points.
    Sobol,
}

impl Propagation {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::FirstOrder => "first_order",
            Self::Unscented => "unscented",
            Self::Chaos => "chaos",
            Self::Random => "random",
            Self::Sobol => "sobol",
        }
    }
}

#[derive(Debug, Clone, Args)]
pub struct OraclesArgs {
    #[command(subcommand)]
    pub action: OraclesAction,
}

#[derive(Debug, Clone, Subcommand)]
pub enum OraclesAction {
    /// Install the reference engines below target/ (about 1.6 GB); does nothing when they are there.
    Install(InstallArgs),
    /// Say which engines answer, and with which version.
    Status,
    /// Test a program that speaks oracles/PROTOCOL.md: exit 1 when something is wrong; what it lacks is no fault.
    Check(CheckArgs),
}

#[derive(Debug, Clone, Args)]
#[command(after_help = "Example:\n  featherbench oracles check python3 oracles/chain.py")]
pub struct CheckArgs {
    /// The program with its arguments.
    #[arg(required = true, trailing_var_arg = true, allow_hyphen_values = true, value_name = "PROGRAM")]
    pub command: Vec<OsString>,
    /// Longest wait for one answer, in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 30)]
    pub timeout: u64,
    /// Address space of the program, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = 8192)]
    pub memory: u64,
    /// Print everything that is right as well.
    #[arg(long)]
    pub all: bool,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Engines in Python share one environment: one of them installs all. An engine that cargo builds (rapier, dynibo, faer, nalgebra; some minutes, once) is built alone; a suite that asks for it builds it as well. An engine with an environment of its own (adam, clarabel) is installed alone too, when it is named.\n\nExamples:\n  featherbench oracles install\n  featherbench oracles install rapier\n  featherbench oracles install --native"
)]
pub struct InstallArgs {
    /// Engines of oracles/engines.toml; by default those in Python.
    #[arg(value_name = "ENGINE")]
    pub engines: Vec<String>,
    /// Also build all native oracles, which timing takes, with clang and g++ where they are found (some minutes, once).
    #[arg(long)]
    pub native: bool,
}

#[derive(Debug, Clone, Args)]
pub struct ServeArgs {
    /// The library: one that exports what oracles/native/oracle.h says.
    pub library: PathBuf,
    /// Stay on this core.
    #[arg(long)]
    pub core: Option<usize>,
}

impl RunArgs {
    /// What a bare `featherbench` does.
    pub fn default_suite() -> Self {
        /// The arguments of `run` as a command of their own.
        #[derive(Parser)]
        struct Bare {
            #[command(flatten)]
            run: RunArgs,
        }
        Bare::parse_from(["featherbench"]).run
    }
}
