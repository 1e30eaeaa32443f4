//! `featherbench reduce`: the failures of runs as a catalogue of small robots, each with a program in the engine's own interface.
//!
//! It has a line for each known deviation of each engine, and says why where there is no case. It is a command of its own and no part of a
//! run: it asks engines some hundred times for each case.

use crate::args::{ReduceArgs, RunArgs};
use crate::fail::Fail;
use crate::message::{say, tell};
use crate::oracles;
use crate::robots;
use crate::root::Root;
use ::featherbench_results::{Checksums, Row, RunInfo};
use featherbench_bench::{Engine, OWN, Robot};
use featherbench_engines::{Featherbench, Limits};
use featherbench_reduction::{self as reduction, CATALOGUE, CATALOGUE_NAME, Catalogue, Reducing, Status, save, told};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Writes the catalogue of one run or several.
pub fn reduce(root: &Root, args: &ReduceArgs) -> Result<(), Fail> {
    let folder = folder(args)?;
    let mut runs: Vec<RunInfo> = Vec::new();
    let mut rows: Vec<Row> = Vec::new();
    for place in &args.folders {
        let (info, its) = ::featherbench_results::read_run(place)?;
        if let Some(at) = runs.iter().position(|run| run.run == info.run) {
            let [a, b] = [&args.folders[at], place].map(|place| place.display());
            return Err(Fail::input(format!("{a} and {b} are both the run {}: a case names its run; leave one out", info.run)));
        }
        runs.push(info);
        rows.extend(its);
    }
    let gates = root.read_gates()?;
    let entries = reduction::entries(&gates, &rows, &args.cells);
    if entries.iter().all(|entry| entry.found.is_empty()) {
        let places: Vec<String> = args.folders.iter().map(|place| place.display().to_string()).collect();
        let message = format!(
            "{}: there is nothing to reduce: no {} of the studies agreement, accuracy, sweep and derivatives fails, is a known deviation or has an \
             error against the truth above rounding",
            places.join(", "),
            if args.cells.is_empty() { "row" } else { "row of these cells" }
        );
        return Err(Fail::input(message));
    }
    let robots = runs.iter().zip(&args.folders).map(|(info, place)| Ok((info.run.as_str(), robots_of(root, info, place)?)));
    let robots: BTreeMap<&str, Vec<Robot>> = robots.collect::<Result<_, Fail>>()?;
    let open = |engine: &str| open(root, engine);
    let mut reducing = Reducing::new(&gates, &robots, &folder, &open);
    let mut lines = Vec::new();
    for entry in entries {
        let line = reducing.line(entry)?;
        match &line.status {
            Status::Reduced(case) => {
                let (before, after) = (told(case.error), told(case.reduced_error));
                say!("{}: {before} on {} bodies of {}, {after} on {}", line.name, case.bodies, case.robot, case.reduced_bodies);
            }
            Status::None { why } => say!("{}: no case: {why}", line.name),
        }
        lines.push(line);
    }
    let cases = lines.iter().filter(|line| line.reduction().is_some()).count();
    // If no engine answers, that is the error; if one is missing, its lines say so.
    if let Some(missing) = reducing.missing().filter(|_| cases == 0) {
        return Err(missing);
    }
    let path = folder.join(CATALOGUE_NAME);
    let known = if args.cells.is_empty() { None } else { Catalogue::read(&folder)? };
    let runs = runs.iter().map(|run| run.run.clone()).collect();
    let catalogue = known.unwrap_or(Catalogue { runs, lines: Vec::new() }).renewed(lines);
    save(&folder.join("README.md"), &catalogue.readme())?;
    // Last: a catalogue names no file that is not there.
    save(&path, &format!("{}\n", serde_json::to_string_pretty(&catalogue).map_err(|error| Fail::input(error.to_string()))?))?;
    Checksums::of(&folder, &[CATALOGUE_NAME])?.write()?;
    say!("{cases} cases: {}", folder.join("README.md").display());
    Ok(())
}

/// The catalogue's folder.
fn folder(args: &ReduceArgs) -> Result<PathBuf, Fail> {
    match (&args.out, args.folders.as_slice()) {
        (Some(out), _) => Ok(out.clone()),
        (None, [run]) => Ok(run.join(CATALOGUE)),
        (None, runs) => Err(Fail::input(format!("{} runs have one catalogue: say its folder by --out DIR", runs.len()))),
    }
}

/// The robots of a run, made again from its command.
fn robots_of(root: &Root, info: &RunInfo, folder: &Path) -> Result<Vec<Robot>, Fail> {
    let run = RunArgs::of_command(&info.command);
    let run = run.ok_or_else(|| Fail::input(format!("{}: its command is none of `run`: {}", folder.display(), info.command)))?;
    let loaded = robots::load(root, &run.suite, info.live, Some(info.seed), run.asked.size)?;
    if loaded.hash != info.suite_hash {
        tell!("note: {}: the suite {} is another one now", folder.display(), run.suite);
    }
    Ok(loaded.robots)
}

/// An engine that answers itself: recorded answers know no other robot.
fn open(root: &Root, name: &str) -> Result<Box<dyn Engine>, Fail> {
    if name == OWN {
        return Ok(Box::new(Featherbench::new()));
    }
    let engines = oracles::described(root)?;
    Ok(Box::new(oracles::start(root, engines.get(name).map_err(Fail::input)?, Limits::default())?))
}
