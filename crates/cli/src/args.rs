//! The command line.

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Who is right, by how much, and how fast: dynamics engines on one and the same robots.
#[derive(Debug, Parser)]
#[command(name = "featherbench", version, about, after_help = EXAMPLES)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
}

const EXAMPLES: &str = "\
Examples:
  featherbench                                 the default suite against the recorded answers; no Python needed
  featherbench run --live                      ask the engines themselves (installs them on first use)
  featherbench run --only 'panda/.*/fd'        only some cells
  featherbench gen chain --n 1000 --out c.json a robot of one's own
  featherbench explain 3f2a reports/LATEST     what a cell asked and what was answered

Exit codes: 0 good, 1 a gate failed (or two runs differ), 2 usage or bad input, 3 a required engine is missing.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a suite: evaluate, compare, judge, report.
    Run(RunArgs),
    /// Write the report of a run again from its records.
    Report(FolderArgs),
    /// Judge a run by its records: exit 1 when a gate fails.
    Gate(GateArgs),
    /// List suites, robots, engines, studies and families of generated robots.
    List(ListArgs),
    /// Compare two runs: what changed beyond noise; exit 1 when something did.
    Diff(DiffArgs),
    /// Append the times of our kernels in a run to datasets/history.
    History(HistoryArgs),
    /// Explain a cell of a run: what was asked, what was answered, how it was judged.
    Explain(ExplainArgs),
    /// Ask the engines and keep their answers in datasets/recorded.
    Record(RecordArgs),
    /// Write the description of a robot: a generated one, or one read from URDF.
    Gen(GenArgs),
    /// Set up and look at the reference engines.
    Oracles(OraclesArgs),
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Examples:\n  featherbench run --suite smoke\n  featherbench run --live --out reports/today\n  featherbench run --resume --out reports/today"
)]
pub struct RunArgs {
    /// The suite: a name in datasets/suites, or a TOML file.
    #[arg(long, default_value = "default")]
    pub suite: String,
    /// Ask the engines themselves instead of their recorded answers.
    #[arg(long)]
    pub live: bool,
    /// Only cells whose path study/robot/engine/quantity/method matches this regular expression.
    #[arg(long, value_name = "REGEX")]
    pub only: Option<String>,
    /// The run's folder; by default a new one in reports/.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Continue the run in --out: finished cells are kept.
    #[arg(long, requires = "out")]
    pub resume: bool,
    /// Continue although program, target features, libm or suite differ.
    #[arg(long, requires = "resume")]
    pub mixed: bool,
    /// Leave the timing study out.
    #[arg(long)]
    pub no_timing: bool,
    /// Where recorded answers are read from; by default datasets/recorded.
    #[arg(long, value_name = "DIR")]
    pub recorded: Option<PathBuf>,
    /// Longest wait for one answer of an engine, in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 120)]
    pub answer_within: u64,
    /// Address space of each engine's process, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = 8192)]
    pub memory: u64,
}

#[derive(Debug, Clone, Args)]
pub struct FolderArgs {
    /// A run's folder.
    pub folder: PathBuf,
}

#[derive(Debug, Clone, Args)]
pub struct GateArgs {
    /// A run's folder.
    pub folder: PathBuf,
    /// Print the counts of rows that pass or deviate as known, in the form of a suite's `expect` tables.
    #[arg(long)]
    pub counts: bool,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "What changes: a verdict; a count; an error by a factor of 4; a time when the intervals of both runs are apart and their ratio is beyond 2 % and the A/A controls of both; a row that only one run has. Void times are not compared.\n\nExit codes: 0 nothing changed beyond noise, 1 something did, 2 usage or bad input.\n\nExample:\n  featherbench diff reports/before reports/after --markdown"
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
    after_help = "Example:\n  python ci/instructions.py --out counts.csv\n  featherbench history reports/timing --instructions counts.csv"
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
}

#[derive(Debug, Clone, Args)]
pub struct ListArgs {
    /// The suite whose robots and cells are listed.
    #[arg(long, default_value = "default")]
    pub suite: String,
    /// List every cell of the suite by its path.
    #[arg(long)]
    pub cells: bool,
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
    after_help = "Examples:\n  featherbench gen chain --n 1000 --out chain.json\n  featherbench gen tree --seed 7 --set joints=all --set base=free --out tree.json\n  featherbench gen urdf --file robot.urdf --floating --out robot.json\n\n`featherbench list` names the families and their parameters."
)]
pub struct GenArgs {
    /// A family of generated robots (also with its parameters, as in `chain:n=20,layout=spatial`), or `urdf`.
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
    /// The URDF file, for `urdf`.
    #[arg(long, value_name = "URDF", required_if_eq("family", "urdf"))]
    pub file: Option<PathBuf>,
    /// Give the URDF's base six degrees of freedom.
    #[arg(long)]
    pub floating: bool,
    /// Read joints that mimic another as joints of their own.
    #[arg(long)]
    pub independent_mimics: bool,
    /// Let moving bodies have no mass.
    #[arg(long)]
    pub allow_massless: bool,
    /// Where to write the description; standard output by default.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Clone, Args)]
pub struct OraclesArgs {
    #[command(subcommand)]
    pub action: OraclesAction,
}

#[derive(Debug, Clone, Subcommand)]
pub enum OraclesAction {
    /// Install the reference engines below target/ (about 1.4 GB); does nothing when they are there.
    Install,
    /// Say which engines answer, and with which version.
    Status,
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
