//! The cases of a catalogue: for each entry the smallest robot that still shows it, with its files.

use crate::{Entry, FEW, Failure, Fault, KEEP, Kind, Line, Reduced, Reduction, Status, Subject, files, reduce};
use featherbench_bench::{Engine, Gates, HarnessError, Robot};
use featherbench_results::Row;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// The rows of an entry that are tried, each of another robot or method, until one becomes small.
const TRIES: usize = 3;
/// Robots of more bodies than this are tried only while there is no case: a step takes seconds.
const MANY: usize = 64;

/// Starts the engine of a name.
pub type Open<'a, E> = dyn Fn(&str) -> Result<Box<dyn Engine>, E> + 'a;

/// What is at hand while cases are reduced.
pub struct Reducing<'a, E> {
    gates: &'a Gates,
    robots: &'a BTreeMap<&'a str, Vec<Robot>>,
    folder: &'a Path,
    open: &'a Open<'a, E>,
    engines: BTreeMap<String, Result<Box<dyn Engine>, E>>,
}

/// A reduced case with the row that it comes from.
struct Found<'a> {
    row: &'a Row,
    finding: &'a Failure,
    bodies: usize,
    kind: Kind,
    reduced: Reduced,
}

impl<'a, E: Display> Reducing<'a, E> {
    /// Cases of the robots of each run, judged by `gates` and written into a folder. `open` starts an engine that answers itself.
    pub fn new(gates: &'a Gates, robots: &'a BTreeMap<&'a str, Vec<Robot>>, folder: &'a Path, open: &'a Open<'a, E>) -> Self {
        Self { gates, robots, folder, open, engines: BTreeMap::new() }
    }

    /// Why one of the engines does not answer, if one does not.
    pub fn missing(self) -> Option<E> {
        self.engines.into_values().find_map(Result::err)
    }

    /// The line of an entry, with the files of its case.
    ///
    /// # Errors
    /// [`HarnessError`] when a file of the case cannot be written. An engine that does not answer is told in the line.
    pub fn line(&mut self, entry: Entry) -> Result<Line, HarnessError> {
        let Entry { mut line, found } = entry;
        if found.is_empty() {
            return Ok(line);
        }
        let (gates, robots, open) = (self.gates, self.robots, self.open);
        let engine = match self.engines.entry(line.engine.clone()).or_insert_with(|| open(&line.engine)) {
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
            if best.as_ref().is_some_and(|best| rank(best) <= (false, FEW)) {
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
    fn written(&self, line: &Line, case: &Found) -> Result<Reduction, HarnessError> {
        let (part, whole) = (self.folder.join(format!(".{}", line.name)), self.folder.join(&line.name));
        let files = files::write(&part, line, case.row, case.finding, &case.reduced, case.kind)?;
        replace(&part, &whole).map_err(|source| HarnessError::io(&whole, source))?;
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
fn of_robot(engine: &dyn Engine, gates: &Gates, robot: &Robot, finding: &Failure) -> Option<(Reduced, Kind)> {
    let shown = |robot: &Robot| finding.shown(engine, gates, robot);
    let of_its = |k: &usize| finding.states.is_none_or(|states| robot.states.cases.get(*k) == Some(&states));
    let states = (0..robot.states.count()).filter(of_its).filter_map(|k| Some((k, shown(&Subject::of(robot, k).robot()?)?)));
    let (k, given) = states.max_by(|(_, a), (_, b)| a.severity.total_cmp(&b.severity))?;
    // The size of a known deviation is known. Of other errors one that is larger by a decade is another: at the end all coordinates would be zero,
    // and what is left of an answer would be divided by what is left of a bound.
    let most = if matches!(finding.fault, Fault::Known(_)) { f64::INFINITY } else { given.severity / KEEP };
    let same = |robot: &Robot| {
        let found = shown(robot).filter(|found| found.kind == given.kind && found.severity <= most)?;
        Some(found.severity)
    };
    Some((reduce(Subject::of(robot, k), 0.0, &same)?, given.kind))
}

/// Puts a folder in the place of another.
fn replace(part: &Path, whole: &PathBuf) -> std::io::Result<()> {
    if whole.exists() {
        std::fs::remove_dir_all(whole)?;
    }
    std::fs::rename(part, whole)
}
