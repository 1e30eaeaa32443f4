//! What judges runs and compares them.

use clap::Args;
use std::path::PathBuf;

/// A word that can stand in the name of a file.
fn file_name(text: &str) -> Result<String, String> {
    let plain = !text.is_empty() && text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit());
    if plain { Ok(text.to_owned()) } else { Err("use small letters and digits".into()) }
}

#[derive(Debug, Clone, Args)]
#[command(after_help = "Example:\n  featherbench report reports/today --figures paper/figures")]
pub struct ReportArgs {
    /// A run's folder.
    pub folder: PathBuf,
    /// Write the run's figures for a paper into this folder: each as SVG, CSV and, with Chromium, PDF; captions.md and references.bib.
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,
    /// Draw these instruction counts too, over the run's robots and beside its times; `ci/instructions.py --out` writes them.
    #[arg(long, value_name = "FILE", requires = "figures")]
    pub instructions: Option<PathBuf>,
    /// Print the ranking of the engines as JSON: who is right, by how much, and how fast.
    #[arg(long)]
    pub json: bool,
    /// Open the page.
    #[arg(long)]
    pub open: bool,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "What fell short comes first, from the gravest: who, on what, by how much, and the command that repeats it.\n\nExamples:\n  featherbench gate reports/today --junit gate.xml --markdown gate.md\n  featherbench gate reports/today --json\n\nThe sizes of known deviations over twenty seeds:\n  for seed in $(seq 1 20); do featherbench run --live --no-timing --seed $seed --out reports/seed-$seed; done\n  featherbench gate reports/seed-* --ranges --write"
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
    /// Write what fell short as JUnit XML.
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write what fell short, and the gravest of what is known, as Markdown.
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
    /// Print annotations of GitHub, too.
    #[arg(long, conflicts_with = "json")]
    pub annotations: bool,
    /// Print everything as JSON.
    #[arg(long)]
    pub json: bool,
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
    after_help = "What changes: a verdict; a count; an error by a factor of 4; a time when its ratio, over the factor that all times have in common, is beyond 1 % and beyond chance (of those listed, at most 5 % are chance on average); a row that only one run has. Times that do not count are not compared.\n\nTwo suites that differ: rows that only one run has are counted, not listed; the exit code is 1.\n\nWith --json, standard output is one object: before and after {run, suite, revision, started}, status (same, changed), same_suite, compared (rows), invalid (times that do not count), common (the factor that all times have in common), only_before, only_after (rows), changes [{change, study, robot, engine, method, precision, quantity, states, body, cache, metric, reference, unit, before, after, factor}]. before and after of a change are {value, verdict}, or null.\n\nExit codes: 0 nothing changed beyond noise, 1 something did, 2 usage or bad input.\n\nExample:\n  featherbench diff reports/before reports/after --markdown\n  featherbench diff reports/before reports/after --html changes.html"
)]
pub struct DiffArgs {
    /// The folder of the first run.
    #[arg(value_name = "RUN_A")]
    pub before: PathBuf,
    /// The folder of the second run.
    #[arg(value_name = "RUN_B")]
    pub after: PathBuf,
    /// Print a Markdown table.
    #[arg(long, conflicts_with = "json")]
    pub markdown: bool,
    /// Print everything as JSON.
    #[arg(long)]
    pub json: bool,
    /// Write a page of one file, too, which opens without a network.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
}

#[derive(Debug, Clone, Args)]
#[command(
    after_help = "Of a folder of runs: writes its page index.html: trends of errors, times and failing rows of each engine and robot, change points, engine upgrades, and what appeared, vanished and changed from run to run.\nOf a run: appends its times of our kernels to the history of its machine.\n\nExamples:\n  featherbench history reports\n  python ci/instructions.py --out counts.csv\n  featherbench history reports/timing --instructions counts.csv --to datasets/history"
)]
pub struct HistoryArgs {
    /// A folder of runs, or the folder of a run with times.
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
