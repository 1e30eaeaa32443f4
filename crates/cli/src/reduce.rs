//! `featherbench reduce`: the failures of runs as a catalogue of small robots, each with a program in the engine's own interface.
//!
//! It has a line for each known deviation of each engine, and says why where there is no case. It is a command of its own and no part of a
//! run: it asks engines some hundred times for each case.

mod files;
mod programs;

use crate::args::{ReduceArgs, RunArgs};
use crate::fail::Fail;
use crate::oracles;
use crate::robots;
use crate::root::Root;
use crate::say::say;
use ::featherbench_results::{Row, RunInfo};
use featherbench_bench::{Engine, Gates, OWN, Robot};
use featherbench_engines::{Featherbench, Limits};
use featherbench_studies::reduce::{
    self, CATALOGUE, CATALOGUE_NAME, Case, Catalogue, Entry, Fault, Finding, Kind, Line, Reduced, Reduction, Status,
};
use files::save;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The rows of an entry that are tried, each of another robot or method, until one becomes small.
const TRIES: usize = 3;
/// Robots of more bodies than this are tried only while there is no case: a step takes seconds.
const MANY: usize = 64;

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
    let entries = reduce::entries(&gates, &rows, &args.cells);
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
    let mut reducing = Reducing { root, gates: &gates, robots: &robots, folder: &folder, engines: BTreeMap::new() };
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
    if let Some(missing) = reducing.engines.into_values().find_map(Result::err).filter(|_| cases == 0) {
        return Err(missing);
    }
    let path = folder.join(CATALOGUE_NAME);
    let known = if args.cells.is_empty() { None } else { Catalogue::read(&folder)? };
    let runs = runs.iter().map(|run| run.run.clone()).collect();
    let catalogue = known.unwrap_or(Catalogue { runs, lines: Vec::new() }).renewed(lines);
    save(&folder.join("README.md"), &readme(&catalogue))?;
    // Last: a catalogue names no file that is not there.
    save(&path, &format!("{}\n", serde_json::to_string_pretty(&catalogue).map_err(|error| Fail::input(error.to_string()))?))?;
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

/// What is at hand while cases are reduced.
struct Reducing<'a> {
    root: &'a Root,
    gates: &'a Gates,
    /// The robots of each run.
    robots: &'a BTreeMap<&'a str, Vec<Robot>>,
    folder: &'a Path,
    engines: BTreeMap<String, Result<Box<dyn Engine>, Fail>>,
}

/// A reduced case with the row that it comes from.
struct Found<'a> {
    row: &'a Row,
    finding: &'a Finding,
    bodies: usize,
    kind: Kind,
    reduced: Reduced,
}

impl Reducing<'_> {
    /// The line of an entry, with the files of its case.
    fn line(&mut self, entry: Entry) -> Result<Line, Fail> {
        let Entry { mut line, found } = entry;
        if found.is_empty() {
            return Ok(line);
        }
        let (root, gates, robots) = (self.root, self.gates, self.robots);
        let engine = match self.engines.entry(line.engine.clone()).or_insert_with(|| open(root, &line.engine)) {
            Ok(engine) => &**engine,
            Err(missing) => {
                line.status = Status::None { why: format!("the engine does not answer here: {missing}") };
                return Ok(line);
            }
        };
        let mut best: Option<Found> = None;
        let mut tried: Vec<[&str; 3]> = Vec::new();
        for (row, finding) in &found {
            let way = [&row.run, &row.robot, &row.method].map(String::as_str);
            if tried.contains(&way) {
                continue;
            }
            let of_run = robots.get(row.run.as_str()).into_iter().flatten();
            let Some(robot) = of_run.into_iter().find(|robot| robot.name == row.robot) else { continue };
            if tried.len() == TRIES || best.is_some() && robot.description.bodies.len() > MANY {
                break;
            }
            tried.push(way);
            let Some(case) = of_robot(engine, gates, robot, finding) else { continue };
            let case = Found { row, finding, bodies: robot.description.bodies.len(), kind: case.1, reduced: case.0 };
            // An answer that is no number, or none, says more than a measure that is none.
            let rank = |case: &Found| (case.kind == Kind::NoMeasure, case.reduced.case.description.bodies.len());
            if best.as_ref().is_none_or(|best| rank(&case) < rank(best)) {
                best = Some(case);
            }
            if best.as_ref().is_some_and(|best| rank(best) <= (false, reduce::FEW)) {
                break;
            }
        }
        line.status = match best {
            Some(case) => Status::Reduced(Box::new(self.written(&line, &case)?)),
            None if tried.is_empty() => Status::None { why: "the suites do not have the robots of its rows now".into() },
            None => {
                let robots: BTreeSet<&str> = tried.into_iter().map(|[_, robot, _]| robot).collect();
                let robots: Vec<&str> = robots.into_iter().collect();
                Status::None { why: format!("the engine does not show it now at one state of {}", robots.join(", ")) }
            }
        };
        Ok(line)
    }

    /// Writes the files of a case, and says what it is. The folder is replaced whole.
    fn written(&self, line: &Line, case: &Found) -> Result<Reduction, Fail> {
        let (part, whole) = (self.folder.join(format!(".{}", line.name)), self.folder.join(&line.name));
        let files = files::write(&part, line, case.row, case.finding, &case.reduced, case.kind)?;
        replace(&part, &whole).map_err(|error| Fail::input(format!("{}: {error}", whole.display())))?;
        let mut joints = BTreeMap::new();
        for body in &case.reduced.case.description.bodies {
            *joints.entry(body.joint.kind.name().to_owned()).or_insert(0) += 1;
        }
        let number = |severity: f64| (case.kind == Kind::Number).then_some(severity);
        Ok(Reduction {
            run: case.row.run.clone(),
            robot: case.row.robot.clone(),
            cell: case.row.cell.clone(),
            quantity: case.finding.quantity.name().into(),
            method: case.finding.method.clone(),
            metric: case.finding.metric.clone(),
            bodies: case.bodies,
            error: number(case.reduced.before),
            reduced_bodies: case.reduced.case.description.bodies.len(),
            joints,
            reduced_error: number(case.reduced.after),
            without: case.kind.told().map(str::to_owned),
            tried: case.reduced.tried,
            files,
        })
    }
}

/// The reduced case of a finding on a robot, from the state that shows it most; `None` if no state alone shows it.
fn of_robot(engine: &dyn Engine, gates: &Gates, robot: &Robot, finding: &Finding) -> Option<(Reduced, Kind)> {
    let shown = |robot: &Robot| finding.shown(engine, gates, robot);
    let of_its = |k: &usize| finding.states.is_none_or(|states| robot.states.cases.get(*k) == Some(&states));
    let states = (0..robot.states.count()).filter(of_its).filter_map(|k| Some((k, shown(&Case::of(robot, k).robot()?)?)));
    let (k, given) = states.max_by(|(_, a), (_, b)| a.severity.total_cmp(&b.severity))?;
    // The size of a known deviation is known. Of other errors one that is larger by a decade is another: at the end all coordinates would be zero,
    // and what is left of an answer would be divided by what is left of a bound.
    let most = if matches!(finding.fault, Fault::Known(_)) { f64::INFINITY } else { given.severity / reduce::KEEP };
    let same = |robot: &Robot| {
        let found = shown(robot).filter(|found| found.kind == given.kind && found.severity <= most)?;
        Some(found.severity)
    };
    Some((reduce::reduce(Case::of(robot, k), 0.0, &same)?, given.kind))
}

/// Puts a folder in the place of another.
fn replace(part: &Path, whole: &PathBuf) -> std::io::Result<()> {
    if whole.exists() {
        std::fs::remove_dir_all(whole)?;
    }
    std::fs::rename(part, whole)
}

/// An error in two digits.
fn told(error: Option<f64>) -> String {
    error.map_or_else(|| "no number".to_owned(), |error| format!("{error:.1e}"))
}

/// The catalogue as a table.
fn readme(catalogue: &Catalogue) -> String {
    let mut text = format!(
        "# Catalogue of failures: {}\n\nA line for each known deviation of each engine, and for each method that fails or has an error above rounding. A case is \
         the smallest robot and state that still show it, with at least {} of its error, by the measure of its study.\n\n\
         | engine | what | run | robot | bodies | error | bodies, reduced | error, reduced | reproduction |\n|---|---|---|---|---|---|---|---|---|\n",
        catalogue.runs.join(", "),
        reduce::KEEP
    );
    for Line { name, engine, class, reproduction, status, .. } in &catalogue.lines {
        let reproduction = reproduction.as_deref().unwrap_or("–");
        text += &match status {
            Status::Reduced(case) => format!(
                "| {engine} | [{class}]({name}/README.md) | {} | {} | {} | {} | {} | {} | {reproduction} |\n",
                case.run,
                case.robot,
                case.bodies,
                told(case.error),
                case.reduced_bodies,
                told(case.reduced_error)
            ),
            Status::None { why } => format!("| {engine} | {class} | no case: {why} | | | | | | {reproduction} |\n"),
        };
    }
    text
}

/// The robots of a run, made again from its command.
fn robots_of(root: &Root, info: &RunInfo, folder: &Path) -> Result<Vec<Robot>, Fail> {
    let run = RunArgs::of_command(&info.command);
    let run = run.ok_or_else(|| Fail::input(format!("{}: its command is none of `run`: {}", folder.display(), info.command)))?;
    let loaded = robots::load(root, &run.suite, info.live, Some(info.seed), run.size)?;
    if loaded.hash != info.suite_hash {
        eprintln!("note: {}: the suite {} is another one now", folder.display(), run.suite);
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
