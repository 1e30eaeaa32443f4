//! `featherbench sweep`: a run as tasks of HyperQueue, each a shard in a folder of its own.
//!
//! What is on disk decides what is to be done: a round submits the shards that are not finished, and a round follows another as long as there
//! are such shards. So a task that failed, a worker, a server and this process may end at any time.

use crate::args::{MergeArgs, RunArgs, SweepArgs};
use crate::fail::Fail;
use crate::message::tell;
use crate::root::Root;
use crate::run;
use crate::run::hyperqueue::{self, Driver, Task, Wanted};
use crate::run::merge;
use crate::run::plan;
use crate::run::shard;
use ::featherbench_results::{atomic_write, seal, unsealed};
use featherbench_bench::HarnessError;
use featherbench_bench::shard::{Part, Plan, SHARD_NAME, journal};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// What a sweep is, in its folder: it goes on only as itself.
const SWEEP_NAME: &str = "sweep.json";
/// How many workers may end under a task before HyperQueue gives it up; the next round starts it again.
const CRASHES: usize = 5;
/// A task: a shard that was begun goes on, and one that is finished is not begun again. A folder without a fingerprint holds nothing but what a
/// process left that ended while it wrote that. The arguments: the shard's folder, the command.
const SCRIPT: &str = r#"shard=$1; shift
if [ -e "$shard/shard.json" ]; then exit 0; fi
if [ -e "$shard/fingerprint.json" ]; then resume=--resume; else rm -rf "$shard"; resume=; fi
RAYON_NUM_THREADS=1 exec "$@" --out "$shard" $resume"#;

/// The file of a sweep.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sweep {
    /// The arguments that define the run, and its cut.
    arguments: Vec<String>,
    /// The number of shards.
    shards: usize,
    /// The shards that run alone.
    alone: Vec<usize>,
}

impl Sweep {
    /// Cuts a plan into shards of at least this many seconds each, but one at least.
    fn new(arguments: Vec<String>, plan: &Plan, least: f64) -> Self {
        // The cast rounds down, and holds for any number: a plan has no more shards than cells.
        let shards = ((plan.seconds() / least) as usize).clamp(1, plan.cells.len().max(1));
        let numbers = plan.cut(shards);
        let mut alone: Vec<usize> =
            plan.cells.iter().zip(numbers).filter(|(planned, _)| planned.exclusive).map(|(_, number)| number).collect();
        alone.dedup();
        Self { arguments, shards, alone }
    }

    fn shard(&self, folder: &Path, number: usize) -> PathBuf {
        folder.join(format!("shard-{number}-of-{}", self.shards))
    }

    /// The shards that are not finished, those that run alone last.
    fn unfinished(&self, folder: &Path) -> Vec<usize> {
        let mut numbers: Vec<usize> = (1..=self.shards).filter(|&number| Part::open(&self.shard(folder, number)).is_err()).collect();
        numbers.sort_by_key(|number| self.alone.contains(number));
        numbers
    }
}

/// Sweeps a suite.
pub fn sweep(root: &Root, args: &SweepArgs) -> Result<(), Fail> {
    if !(args.task_seconds > 0.0 && args.task_seconds.is_finite()) {
        return Err(Fail::input(format!("--task-seconds {}: give a positive number of seconds", args.task_seconds)));
    }
    let whole = args.whole.run();
    let (folder, sweep) = open(root, args, &whole)?;
    let python = hyperqueue::install(root)?;
    for round in 0..=args.retries {
        let numbers = sweep.unfinished(&folder);
        if numbers.is_empty() {
            break;
        }
        if round > 0 {
            tell!("note: {} of {} tasks are not finished and are started again", numbers.len(), sweep.shards);
        }
        for &number in &numbers {
            // What is there is damaged: without the file the shard is an unfinished one, whose good outcomes are kept.
            let path = sweep.shard(&folder, number).join(SHARD_NAME);
            if path.exists() {
                std::fs::remove_file(&path).map_err(|source| HarnessError::io(&path, source))?;
            }
        }
        let tasks = numbers.iter().map(|&number| task(root, &folder, &sweep, number)).collect::<Result<_, _>>()?;
        let workers = args.workers.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
        let wanted = Wanted { server: args.server_dir.as_deref(), workers, crashes: CRASHES, tasks };
        let driver = Driver::start(root, &python)?;
        let line = [("round", json!(round)), ("tasks", json!(numbers)), ("driver", json!(driver.id())), ("time", json!(now()))];
        journal::append(&folder, line)?;
        match driver.drive(&wanted) {
            Ok(failed) => failed.iter().for_each(|(name, why)| tell!("note: {name}: {why}")),
            Err(why) => tell!("note: the process that gives HyperQueue its tasks: {why}"),
        }
    }
    let left = sweep.unfinished(&folder);
    if let Some(&first) = left.first() {
        return Err(Fail::input(format!(
            "{} of {} tasks are not finished after {} rounds; {} says why the first is not\n  --resume goes on",
            left.len(),
            sweep.shards,
            args.retries + 1,
            log(&sweep.shard(&folder, first)).display()
        )));
    }
    let name = folder.file_name().ok_or_else(|| Fail::input(format!("{}: give a folder that has a name", folder.display())))?;
    let out = folder.join(name);
    if out.exists() {
        // A merge that broke off: all that is in it comes from the shards.
        std::fs::remove_dir_all(&out).map_err(|source| HarnessError::io(&out, source))?;
    }
    let shards = (1..=sweep.shards).map(|number| sweep.shard(&folder, number)).collect();
    merge::merge(root, &MergeArgs { shards, out, keep_good: false, allow_mixed: false, open: args.open })
}

/// The folder of a sweep and what it is: planned now, or before.
fn open(root: &Root, args: &SweepArgs, whole: &RunArgs) -> Result<(PathBuf, Sweep), Fail> {
    let mut arguments = whole.defining();
    for costs in &args.whole.costs {
        arguments.extend(["--costs".to_owned(), text(&absolute(costs)?)?]);
    }
    if args.resume {
        let folder = absolute(args.out.as_deref().unwrap_or(Path::new(".")))?;
        let path = folder.join(SWEEP_NAME);
        let read =
            std::fs::read(&path).map_err(|error| Fail::input(format!("{}: there is no sweep to go on with: {error}", path.display())))?;
        let damaged = |what: String| Fail::input(format!("{}: {what}", path.display()));
        let body = unsealed(&read).ok_or_else(|| damaged("its last line is not the checksum of the others: it was damaged".into()))?;
        let known: Sweep = serde_json::from_slice(body).map_err(|error| damaged(error.to_string()))?;
        if known.arguments != arguments {
            let (then, now) = (known.arguments.join(" "), arguments.join(" "));
            return Err(Fail::input(format!("{}: the sweep in it is another: `{then}`, and not `{now}`", folder.display())));
        }
        return Ok((folder, known));
    }
    let prepared = run::prepare(root, whole)?;
    prepared.check_filter(whole)?;
    let plan = shard::plan(&prepared, whole)?;
    let sweep = Sweep::new(arguments, &plan, args.task_seconds);
    let folder = run::folder(root, args.out.as_deref(), &prepared.loaded.name, SystemTime::now())?;
    let io = |source| HarnessError::io(&folder, source);
    if folder.exists() && std::fs::read_dir(&folder).map_err(io)?.next().is_some() {
        return Err(HarnessError::Occupied { path: folder }.into());
    }
    std::fs::create_dir_all(&folder).map_err(io)?;
    let folder = absolute(&folder)?;
    let mut bytes = serde_json::to_string_pretty(&sweep).map_err(|error| Fail::input(error.to_string()))?.into_bytes();
    bytes.push(b'\n');
    seal(&mut bytes);
    atomic_write(&folder.join(SWEEP_NAME), &bytes)?;
    let largest = plan::totals(&plan, &plan.cut(sweep.shards), sweep.shards).into_iter().map(|(_, seconds)| seconds).max_by(f64::total_cmp);
    tell!(
        "{} cells of about {:.1} s in {} tasks, the largest of about {:.1} s, {} of them alone",
        plan.cells.len(),
        plan.seconds(),
        sweep.shards,
        largest.unwrap_or_default(),
        sweep.alone.len()
    );
    Ok((folder, sweep))
}

/// The task of a shard.
fn task(root: &Root, folder: &Path, sweep: &Sweep, number: usize) -> Result<Task, Fail> {
    let program = std::env::current_exe().map_err(|error| Fail::input(format!("this program's path: {error}")))?;
    let here = std::env::current_dir().map_err(|error| Fail::input(format!("the current folder: {error}")))?;
    let shard = sweep.shard(folder, number);
    let of = format!("{number}/{}", sweep.shards);
    let mut args: Vec<String> = ["/bin/sh", "-c", SCRIPT, "sh"].map(str::to_owned).into();
    args.extend([text(&shard)?, text(&program)?, "--root".into(), text(&absolute(root.path())?)?, "run".into()]);
    args.extend(sweep.arguments.iter().cloned());
    args.extend(["--shard".to_owned(), of.clone()]);
    let alone = sweep.alone.contains(&number);
    Ok(Task { name: format!("shard {of}"), args, cwd: text(&here)?, stderr: text(&log(&shard))?, alone })
}

/// The file of what a task says, beside its folder.
fn log(shard: &Path) -> PathBuf {
    shard.with_extension("log")
}

fn absolute(path: &Path) -> Result<PathBuf, Fail> {
    std::path::absolute(path).map_err(|error| Fail::input(format!("{}: {error}", path.display())))
}

/// A path as a word of a command line.
fn text(path: &Path) -> Result<String, Fail> {
    let word = path.to_str().map(str::to_owned);
    word.ok_or_else(|| Fail::input(format!("{}: HyperQueue takes paths in UTF-8 alone", path.display())))
}

fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_bench::Cell;
    use featherbench_bench::shard::{Estimate, Planned};

    #[test]
    fn tasks_have_their_least_work_and_those_that_need_it_run_alone() {
        let planned = |at: usize| Planned {
            cell: Cell {
                study: "s".into(),
                robot: at.to_string(),
                robot_hash: String::new(),
                params: json!({}),
                engine: "e".into(),
                version: "1".into(),
                method: "m".into(),
                quantity: "q".into(),
                scalar: "f64".into(),
            },
            id: at.to_string(),
            exclusive: at >= 35,
            estimate: Estimate { seconds: 0.25, measured: true },
        };
        let plan = Plan { cells: (0..40).map(planned).collect() };
        let sweep = Sweep::new(Vec::new(), &plan, 1.0);
        assert_eq!((sweep.shards, sweep.alone), (10, vec![9, 10]), "four cells each; cell 35 is in the ninth");
        assert_eq!(Sweep::new(Vec::new(), &plan, 100.0).shards, 1);
        assert_eq!(Sweep::new(Vec::new(), &plan, 1e-300).shards, 40, "no more than cells");
        assert_eq!(Sweep::new(Vec::new(), &Plan::default(), 1.0).shards, 1);
    }
}
