//! The command line: runs in shards, and rows for programs that load many.

use super::{AskedArgs, RunArgs};
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Examples:\n  featherbench run --live --suite sweep --out reports/errors\n  featherbench reduce reports/errors\n  featherbench reduce reports/errors --cell 3f2a\n  featherbench reduce reports/night reports/errors --out reports/catalogue\n\nEach case is a folder of RUN/catalogue, or of --out DIR: the smallest robot and state that keep a tenth of the error, in the neutral format and in URDF and MJCF where\nthese hold it, the state with the true answer, and a program in the engine's own interface where the engine has all joints. Known deviations without\na case have a line that says why. Engines are asked themselves, and must be installed. `report RUN` shows the catalogue of RUN afterwards; programs\nread catalogue.json. Of several runs, a case is from the one whose rows show it most."
)]
pub struct ReduceArgs {
    /// The folders of runs, each of a suite with the study agreement, accuracy, sweep or derivatives.
    #[arg(required = true, value_name = "RUN")]
    pub folders: Vec<PathBuf>,
    /// Only this cell, by the beginning of its id; may be repeated. By default the worst of each known deviation, and of each engine, quantity and
    /// method.
    #[arg(long = "cell", value_name = "ID")]
    pub cells: Vec<String>,
    /// The catalogue's folder; by default RUN/catalogue. Several runs have one catalogue, which needs it.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// What is planned, in shards or as tasks.
#[derive(Debug, Clone, Args)]
pub struct WholeArgs {
    /// The suite: a name in datasets/suites, or a TOML file.
    #[arg(default_value = "default")]
    pub suite: String,
    #[command(flatten)]
    pub asked: AskedArgs,
    /// An earlier run or shard whose times the costs are taken from; may be repeated.
    #[arg(long, value_name = "DIR")]
    pub costs: Vec<PathBuf>,
}

impl WholeArgs {
    /// The run that is planned.
    pub fn run(&self) -> RunArgs {
        RunArgs { suite: self.suite.clone(), asked: self.asked.clone(), costs: self.costs.clone(), ..RunArgs::default_suite() }
    }
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Examples:\n  featherbench sweep sweep --live --size 10000 --workers 8 --out reports/large\n  featherbench sweep sweep --live --size 10000 --out reports/large --resume\n  featherbench sweep nightly --live --server-dir ~/.hq-server --out reports/night\n\nThe cells are cut into tasks, each a shard in a folder of its own below DIR, which keeps outcomes as they come. HyperQueue starts the tasks: without\n--server-dir on this machine. Tasks with cells that must run alone (timing) come last, one at a time, each with all cores of a worker. A task\nthat failed, and all tasks of a server that ended, are started again and go on where they were. When all are done they are merged into one run.\n\nOn a cluster: start `hq server start` on a login node, give it workers (`hq alloc add slurm …`, or `hq worker start` in a job), and sweep with its\nfolder as --server-dir. All nodes need this checkout, the same program and a file system that they share. DIR/journal.jsonl has the rounds, and\nDIR/shard-I-of-N/journal.jsonl the starts of a task.\n\nExit codes: as of `run`; 2 also when tasks fail in every round: --resume goes on."
)]
pub struct SweepArgs {
    #[command(flatten)]
    pub whole: WholeArgs,
    /// The folder of the tasks and of the merged run; by default a new one in reports/.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on with the sweep in --out: what is finished is kept.
    #[arg(long, requires = "out")]
    pub resume: bool,
    /// Workers of one core each on this machine; by default one for each core.
    #[arg(long, value_name = "N", conflicts_with = "server_dir")]
    pub workers: Option<NonZeroUsize>,
    /// The folder of a running HyperQueue server, whose workers are used.
    #[arg(long, value_name = "DIR")]
    pub server_dir: Option<PathBuf>,
    /// The least estimated work of a task, in seconds; a task starts this program and its engines, which takes about one.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0)]
    pub task_seconds: f64,
    /// How often unfinished tasks are started again.
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub retries: usize,
    /// Open the report when the sweep ends.
    #[arg(long)]
    pub open: bool,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Examples:\n  featherbench plan default\n  featherbench plan default --costs reports/today --shards 7\n  featherbench plan default --shards 100 --slurm > sweep.sh && sbatch sweep.sh\n\nA cost is the wall time of a cell on one core: that of the runs in --costs, else an estimate from its robot's states and dofs, marked ~."
)]
pub struct PlanArgs {
    #[command(flatten)]
    pub whole: WholeArgs,
    /// Number of shards.
    #[arg(long, value_name = "N", default_value = "1")]
    pub shards: NonZeroUsize,
    /// Print JSON.
    #[arg(long, conflicts_with = "slurm")]
    pub json: bool,
    /// Print a job-array script of SLURM with one task per shard, and the command that merges them.
    #[arg(long)]
    pub slurm: bool,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Example:\n  featherbench run --suite smoke --shard 1/2 --out a\n  featherbench run --suite smoke --shard 2/2 --out b\n  featherbench merge a b --out whole\n\nA shard is refused by name when it is unfinished, damaged, of another version, suite, program or machine library, when its cells are not in the\nplan, or when another shard has them. With --keep-good the others are merged; the cells that no shard has are rows of errors then, and\n`run --resume --out DIR` evaluates them.\n\nExit codes: as of `run`; 2 also when a shard is refused or missing and --keep-good is not given."
)]
pub struct MergeArgs {
    /// The folders of finished shards.
    #[arg(required = true, value_name = "DIR")]
    pub shards: Vec<PathBuf>,
    /// The run's folder.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Merge the shards that are good, and name the others and the cells that are missing.
    #[arg(long)]
    pub keep_good: bool,
    /// Merge although program, target features, libm, suite or arguments differ.
    #[arg(long)]
    pub allow_mixed: bool,
    /// Open the report when the run is written.
    #[arg(long)]
    pub open: bool,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Example:\n  featherbench export reports/default-20260101-120000 --parquet rows\n  python reports/examples/figures.py rows figures\n\nA folder for each study: DIR/study=agreement/part-0.parquet. Columns and types are those of schema.json; empty texts are null."
)]
pub struct ExportArgs {
    /// The run's folder.
    pub folder: PathBuf,
    /// The folder of the Parquet files: a new one, or an empty one.
    #[arg(long, value_name = "DIR")]
    pub parquet: PathBuf,
}
