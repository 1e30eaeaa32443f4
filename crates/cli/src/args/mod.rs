//! The command line: running suites, and what surrounds it. Judging a run and analysing a robot have files of their own.

mod analysis;
mod judge;
mod sweep;

pub use analysis::{Estimator, IdentifyArgs, Propagation, Term, UncertaintyArgs};
pub use judge::{DiffArgs, GateArgs, HistoryArgs, ReportArgs};
pub use sweep::{ExportArgs, MergeArgs, PlanArgs, ReduceArgs, SweepArgs};

use crate::oracles::external::External;
use ::featherbench_results::words;
use clap::{Args, Parser, Subcommand, ValueEnum};
use featherbench_bench::shard::Shard;
use std::ffi::OsString;
use std::num::NonZeroUsize;
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
    /// Print the cells of a suite with what they cost, and how they are cut into shards.
    Plan(PlanArgs),
    /// Run a suite as tasks of HyperQueue, on this machine or a cluster, and merge them.
    Sweep(SweepArgs),
    /// Reduce the largest errors of a run to the smallest robots that show them.
    Reduce(ReduceArgs),
    /// Merge the shards of a run into what one process would have written: compare, judge, report.
    Merge(MergeArgs),
    /// Ask whether the engines read robots' files alike, and if not, where and why.
    Compare(CompareArgs),
    /// Write the report of a run again from its records.
    Report(ReportArgs),
    /// Judge a run by its records: exit 1 when a gate fails.
    Gate(GateArgs),
    /// List suites, robots, engines, studies and families of generated robots.
    List(ListArgs),
    /// Compare two runs: what changed beyond noise; exit 1 when something did.
    Diff(DiffArgs),
    /// Write a page over a folder of runs; of one run, append the times of our kernels to a history, one file per machine.
    History(HistoryArgs),
    /// Explain a cell of a run: what was asked, what was answered, how it was judged.
    Explain(ExplainArgs),
    /// Write the rows of a run as Parquet, for polars, pandas and DuckDB.
    Export(ExportArgs),
    /// Ask the engines and keep their answers in datasets/recorded.
    Record(RecordArgs),
    /// Write a robot, generated or read from a file, as a description, URDF, MJCF or USD.
    Gen(GenArgs),
    /// Identify a robot's parameters from a log, or write a motion that tells them.
    Identify(IdentifyArgs),
    /// Tell what the residuals of a robot's description do to its torques and accelerations: friction, compliance, drives, payload.
    Residuals(ResidualsArgs),
    /// Tell what uncertain parameters do to a robot's accelerations or torques: moments, quantiles, sensitivities.
    Uncertainty(UncertaintyArgs),
    /// Set up and look at the reference engines.
    Oracles(OraclesArgs),
    /// Print the completions of a shell: bash, elvish, fish, powershell or zsh.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page, in roff.
    Man,
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
    #[command(flatten)]
    pub asked: AskedArgs,
    /// The run's folder; by default a new one in reports/.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Continue the run in --out: finished cells are kept.
    #[arg(long, requires = "out")]
    pub resume: bool,
    /// Continue although program, target features, libm, suite or a program of --engine differ.
    #[arg(long, requires = "resume")]
    pub allow_mixed: bool,
    /// Evaluate only this part of the cells, as i/n, and write no rows: `merge` does, from all n parts.
    #[arg(long, value_name = "I/N", requires = "out", conflicts_with = "open")]
    pub shard: Option<Shard>,
    /// An earlier run or shard whose times balance the shards; may be repeated. All shards must be given the same.
    #[arg(long, value_name = "DIR", requires = "shard")]
    pub costs: Vec<PathBuf>,
    /// Evaluate cells of this study: their ids come over standard input, and the outcomes go to standard output. A run starts such processes.
    #[arg(long, value_name = "STUDY", hide = true)]
    pub answer: Option<String>,
    /// Open the report when the run ends.
    #[arg(long)]
    pub open: bool,
    /// Longest wait for one answer of an engine, in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 120)]
    pub timeout: u64,
    /// Address space of each engine's process, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = 8192)]
    pub memory: u64,
}

/// A seed.
fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

/// What a run asks of its suite, and who is asked.
#[derive(Debug, Clone, Args)]
pub struct AskedArgs {
    /// Ask the engines themselves instead of their recorded answers.
    #[arg(long)]
    pub live: bool,
    /// The seed of all that is drawn, instead of the suite's. Answers are recorded to the suite's own: a suite that has some needs --live.
    #[arg(long, value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// The number of robots that the suite draws, instead of its own (for suites with a table `[draw]`).
    #[arg(long, value_name = "N")]
    pub size: Option<NonZeroUsize>,
    /// An engine of one's own, as NAME=PROGRAM [ARGS…]: a program that speaks oracles/PROTOCOL.md; may be repeated.
    #[arg(long = "engine", value_name = "NAME=PROGRAM")]
    pub externals: Vec<External>,
    /// Only cells whose path study/robot/engine/quantity/method matches this regular expression.
    #[arg(long, value_name = "REGEX")]
    pub filter: Option<String>,
    /// Leave the timing study out.
    #[arg(long)]
    pub no_timing: bool,
    /// Where recorded answers are read from; by default datasets/recorded.
    #[arg(long, value_name = "DIR")]
    pub recorded: Option<PathBuf>,
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

A difference is of one of five classes. Physics: the mass matrix or the inverse dynamics change by more than rounding (1e-12, and 1e-14 for each
joint of a chain beyond a hundred), a body or joint is another, the answers are not explained, or the engine refuses the file. Pose: a
body stands elsewhere in the world, and neither changes. Unfelt: a field that enters them differs, and this robot's M and inverse dynamics do not
show it. Rounding: such a field differs by 1024 ε of its scale at most. Not read: what enters neither, such as damping, friction, limits or the
order of joints. Physics and pose make the exit code 1; with --strict the others do as well.

--junit, --sarif and --annotations tell each difference that makes the exit code with file and line, for a robot's repository (ci/examples).

The answer is first: one line for each robot and engine. With --json, standard output is one object: run, suite, status (alike, differs), report (the
page), robots: [{robot, base, bodies, nv, reference, remarks, engines}], conditions: {met, all, unmet: [{what, reason, culprit}]}, refused (messages of
files that cannot be compared). Each of engines has engine, version, loads (yes, altered, no), same, error (the largest scaled error of M and inverse
dynamics) and its bound, neutral (that error on the neutral model), largest (the difference that changes them most), advice, reason (why there is
no answer), differences: [{body, field, class, cause, ours, theirs, size, id, mass_matrix, note}]. What is not known is null.

Limits: XML nested 500 elements deep, 10 MB; an engine that gives no answer in time, or whose workspace does not fit into its memory, is left out
with a row that says so, and counts as a difference with --strict only.

Exit codes: 0 the engines read the files alike, 1 the physics differ, 2 a file cannot be compared (the others are), 3 an engine is missing.")]
pub struct CompareArgs {
    /// Robots: URDF, MJCF, SDF or USD files. A second file of the first one's robot is compared with the first.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// All files hold one robot, whatever its parts are called: compare each with the first.
    #[arg(long)]
    pub one: bool,
    /// Write a copy of a URDF here in which inertials are mended that engines read otherwise or refuse, and compare the copy.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["round_trip", "json"])]
    pub fix: Option<PathBuf>,
    /// Write the file again by every writer, ours and those of engines and converters, and compare what is read from each.
    #[arg(long, conflicts_with = "one")]
    pub round_trip: bool,
    /// Give each URDF's base six degrees of freedom (other files say themselves what floats).
    #[arg(long)]
    pub floating: bool,
    /// The engines that are asked.
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub engines: Option<Vec<String>>,
    /// Exit 1 also for differences that change no physics: fields that an engine does not read, rounding, files beyond its limits.
    #[arg(long)]
    pub strict: bool,
    /// List for each engine the hypotheses about the file that its numbers refute.
    #[arg(long)]
    pub explain: bool,
    /// Print everything as JSON.
    #[arg(long)]
    pub json: bool,
    /// Write what differs as JUnit XML, with file and line.
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write what differs as SARIF, with file and line.
    #[arg(long, value_name = "FILE")]
    pub sarif: Option<PathBuf>,
    /// Print annotations of GitHub, too.
    #[arg(long, conflicts_with = "json")]
    pub annotations: bool,
    /// Longest wait for one answer of an engine, in seconds; it is asked no more about that robot then.
    #[arg(long, value_name = "SECONDS", default_value_t = 60)]
    pub timeout: u64,
    /// The run's folder; by default a new one in reports/.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Examples:\n  featherbench list                     the robots of the default suite, all suites, engines, studies\n  featherbench list --suite robots\n  featherbench list --gates             every gate, and whether a planted fault fires it\n  featherbench list --json\n\nWith --json, standard output is one object: suite {name, about}, robots [{robot, family, base, nv, bodies, depth}], suites [{name, about}], and the names engines, timed, studies, families. With --cells: suite, cells [{cell, path, study, robot, engine, quantity, method}]. With --gates: gates [{study, metric, quantities, bound, times, fires}], silent (the number of gates that do not fire)."
)]
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
    /// List every gate of ci/gates.toml, and plant a fault of ten times its bound in each: exit 1 when one does not fire.
    #[arg(long, conflicts_with_all = ["cells", "conventions"])]
    pub gates: bool,
    /// Print JSON.
    #[arg(long, conflicts_with = "conventions")]
    pub json: bool,
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
    /// A family of generated robots (also with its parameters, as in `chain:n=20,layout=spatial`), or a file's format: `urdf`, `mjcf`, `sdf`,
    /// `usd`, `neutral`.
    pub family: String,
    /// Number of links.
    #[arg(long)]
    pub n: Option<usize>,
    /// Seed of a random family.
    #[arg(long, value_parser = seed, allow_negative_numbers = true)]
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

/// How a robot is written.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum Format {
    /// The neutral description, which holds everything.
    Neutral,
    /// URDF.
    Urdf,
    /// MuJoCo's format.
    Mjcf,
    /// USD as text, with its physics schemas.
    Usd,
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
    #[arg(long, default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    pub seed: u64,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
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
        Bare::parse_from(["featherbench"]).run
    }

    /// The run that a command defines, as `run.json` keeps it: `cargo run --release -- run …`, without arguments that of the default suite. `None`
    /// if it is a command of another kind.
    pub fn of_command(command: &str) -> Option<Self> {
        let all = words(command).ok()?;
        let given = std::iter::once("featherbench").chain(all.iter().skip_while(|word| *word != "--").skip(1).map(String::as_str));
        match Cli::try_parse_from(given).ok()?.command {
            None => Some(Self::default_suite()),
            Some(Command::Run(run)) => Some(run),
            Some(_) => None,
        }
    }

    /// The run that some arguments of `run` define.
    pub fn of(arguments: &[String]) -> Result<Self, clap::Error> {
        Ok(Bare::try_parse_from(std::iter::once("run").chain(arguments.iter().map(String::as_str)))?.run)
    }

    /// The arguments of `run` that define the whole run, whatever part of it is evaluated and wherever it is written.
    pub fn defining(&self) -> Vec<String> {
        let mut words = vec!["--suite".to_owned(), self.suite.clone()];
        let mut option = |name: &str, value: Option<String>| words.extend(value.into_iter().flat_map(|value| [name.to_owned(), value]));
        option("--seed", self.asked.seed.map(|seed| seed.to_string()));
        option("--size", self.asked.size.map(|size| size.to_string()));
        for external in &self.asked.externals {
            option("--engine", Some(external.to_string()));
        }
        option("--filter", self.asked.filter.clone());
        option("--recorded", self.asked.recorded.as_ref().map(|path| path.to_string_lossy().into_owned()));
        let usual = Self::default_suite();
        option("--timeout", (self.timeout != usual.timeout).then(|| self.timeout.to_string()));
        option("--memory", (self.memory != usual.memory).then(|| self.memory.to_string()));
        let flags = [("--live", self.asked.live), ("--no-timing", self.asked.no_timing)];
        words.extend(flags.into_iter().filter(|(_, given)| *given).map(|(name, _)| name.to_owned()));
        words
    }
}

/// The arguments of `run` as a command of their own.
#[derive(Parser)]
struct Bare {
    #[command(flatten)]
    run: RunArgs,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a shard keeps of its command is enough to make the whole run.
    #[test]
    fn the_arguments_that_define_a_run_make_it_again() {
        let all = "--suite smoke --live --seed 3 --size 9 --engine a='my oracle' --engine b=x --filter 'a|b' --recorded r --timeout 7 --memory 9 --no-timing";
        let all = ::featherbench_results::words(&all.replace("a='my oracle'", "\"a='my oracle'\"")).unwrap();
        let part = [&all[..], &["--shard", "2/7", "--out", "x", "--resume", "--costs", "y"].map(str::to_owned)].concat();
        let whole = RunArgs::of(&RunArgs::of(&part).unwrap().defining()).unwrap();
        assert_eq!(format!("{whole:?}"), format!("{:?}", RunArgs::of(&all).unwrap()));
        assert_eq!(RunArgs::default_suite().defining(), ["--suite", "default"]);
        let size = |command: &str| RunArgs::of_command(command).map(|run| (run.suite, run.asked.size.map(NonZeroUsize::get)));
        assert_eq!(size("cargo run --release"), Some(("default".into(), None)));
        assert_eq!(size("cargo run --release -- run --suite sweep --size 7"), Some(("sweep".into(), Some(7))));
        assert_eq!([size("cargo run --release -- compare a.urdf"), size("cargo run --release -- run --suite 'a")], [None, None]);
    }
}
