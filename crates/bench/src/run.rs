//! A run: its folder, the cells of its studies, and their rows.
//!
//! Cells are evaluated on all cores, those of exclusive studies alone. Each outcome is stored when it is known.

use crate::study::{Context, Finished, Study, by_robot};
use crate::{Cell, HarnessError, Lost, NoAnswer, Outcome, OutcomeStore, provenance};
use featherbench_results::{Row, RunInfo};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Shows the progress of a run.
pub trait Progress: Sync {
    /// Some outcomes of the run that goes on cannot be used. Their cells are evaluated again.
    fn lost(&self, lost: &Lost);
    /// `count` cells are about to be evaluated.
    fn begin(&self, phase: &str, count: usize);
    /// A cell begins.
    fn cell(&self, cell: &Cell);
    /// A cell is done.
    fn done(&self, cell: &Cell, outcome: &Outcome);
    /// The phase ends.
    fn end(&self);
}

/// Shows nothing.
pub struct Silent;

impl Progress for Silent {
    fn lost(&self, _: &Lost) {}
    fn begin(&self, _: &str, _: usize) {}
    fn cell(&self, _: &Cell) {}
    fn done(&self, _: &Cell, _: &Outcome) {}
    fn end(&self) {}
}

/// The file that holds what a resumed run must share with the first one.
const FINGERPRINT_NAME: &str = "fingerprint.json";

/// How the folder of a run is opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opening {
    /// A new folder, or an empty one.
    New,
    /// The run in the folder goes on. It must be of the same program, suite and engines.
    Resume,
    /// The run in the folder goes on, whatever made it.
    ResumeMixed,
}

/// A run and everything that its rows share.
///
/// ```
/// use featherbench_bench::run::{Opening, Run, Silent};
/// use featherbench_bench::{Context, Gates};
/// use featherbench_results::RunInfo;
///
/// let folder = tempfile::tempdir().unwrap();
/// let mut run = Run::open(&folder.path().join("first"), Opening::New, RunInfo::default()).unwrap();
/// let gates = Gates::default();
/// let context = Context { robots: &[], engines: &[], gates: &gates, seed: 1 };
/// let rows = run.conduct(&[], &context, &|_| true, &Silent).unwrap();
/// run.write(&rows).unwrap();
/// assert_eq!(featherbench_results::read_run(&run.folder).unwrap().0.run, "first");
/// ```
#[derive(Debug)]
pub struct Run {
    /// Its folder.
    pub folder: PathBuf,
    /// What its rows share. The id is the folder's name.
    pub info: RunInfo,
    /// The names of the files that studies left beside the rows.
    files: Vec<&'static str>,
}

impl Run {
    /// Opens a run's folder, and makes it if it is new.
    ///
    /// # Errors
    /// [`HarnessError`] when a new run has an occupied folder, a resumed one has none, or the run in it was made of something else.
    pub fn open(folder: &Path, opening: Opening, info: RunInfo) -> Result<Self, HarnessError> {
        let io = |source| HarnessError::io(folder, source);
        let path = folder.join(FINGERPRINT_NAME);
        if opening == Opening::New {
            if folder.exists() && std::fs::read_dir(folder).map_err(io)?.next().is_some() {
                return Err(HarnessError::Occupied { path: folder.to_owned() });
            }
        } else if !path.is_file() {
            return Err(HarnessError::NothingToResume { path: folder.to_owned() });
        }
        std::fs::create_dir_all(folder).map_err(io)?;
        let now = provenance::fingerprint(&info);
        if opening == Opening::Resume {
            compare_fingerprints(folder, &path, &now)?;
        } else {
            let text = serde_json::to_string_pretty(&now).map_err(|error| HarnessError::io(&path, error.into()))?;
            featherbench_results::atomic_write(&path, text.as_bytes())?;
        }
        let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Self { folder: folder.to_owned(), info: RunInfo { run: id, ..info }, files: Vec::new() })
    }

    /// Plans, evaluates and compares study after study. The outcomes are kept in the folder as they come.
    ///
    /// # Errors
    /// Only when a file of the run cannot be read or written. An engine that fails, or panics, is an outcome.
    pub fn conduct(
        &mut self,
        studies: &[Box<dyn Study>],
        context: &Context,
        keep: &(dyn Fn(&Cell) -> bool + Sync),
        progress: &dyn Progress,
    ) -> Result<Vec<Row>, HarnessError> {
        let store = OutcomeStore::open(&self.folder)?;
        if let Some(lost) = store.lost() {
            progress.lost(lost);
        }
        let mut rows: Vec<Row> = Vec::new();
        for study in studies {
            let start = Instant::now();
            let cells = plan(study.as_ref(), context, keep);
            let finished = evaluate(study.as_ref(), context, cells, &store, progress)?;
            if let Some((name, text)) = study.side_file(&finished) {
                featherbench_results::atomic_write(&self.folder.join(name), text.as_bytes())?;
                self.files.push(name);
            }
            rows.extend(compare(study.as_ref(), context, finished));
            self.info.studies.push(study.name().into());
            self.info.seconds.insert(study.name().into(), start.elapsed().as_secs_f64());
        }
        for row in &mut rows {
            row.run.clone_from(&self.info.run);
        }
        self.info.rows = rows.len() as u64;
        Ok(rows)
    }

    /// Writes rows, provenance and checksums into the folder.
    ///
    /// # Errors
    /// When a file cannot be written, or a row holds a number that is not finite.
    pub fn write(&self, rows: &[Row]) -> Result<(), HarnessError> {
        Ok(featherbench_results::write_run_with(&self.folder, &self.info, rows, &self.files)?)
    }
}

/// Compares with the fingerprint of the run that goes on.
fn compare_fingerprints(folder: &Path, path: &Path, now: &BTreeMap<String, String>) -> Result<(), HarnessError> {
    let text = std::fs::read_to_string(path).map_err(|source| HarnessError::io(path, source))?;
    let damaged = |error: serde_json::Error| HarnessError::Config { path: path.to_owned(), message: error.to_string() };
    let then: BTreeMap<String, String> = serde_json::from_str(&text).map_err(damaged)?;
    let Some(what) = then.keys().chain(now.keys()).find(|what| then.get(*what) != now.get(*what)) else { return Ok(()) };
    let [then, now] = [&then, now].map(|side| side.get(what).map_or("none", String::as_str).to_owned());
    Err(HarnessError::Mixed { path: folder.to_owned(), what: what.clone(), then, now })
}

/// The cells of a study that a filter accepts. If there are any, the cells that belong to no robot come with them.
pub fn plan(study: &dyn Study, context: &Context, keep: &(dyn Fn(&Cell) -> bool + Sync)) -> Vec<Cell> {
    let kept: Vec<Cell> = study.plan(context).into_iter().filter(|cell| keep(cell) || study.is_common(cell)).collect();
    if kept.iter().all(|cell| study.is_common(cell) && !keep(cell)) { Vec::new() } else { kept }
}

/// Evaluates the unfinished cells of a study, and returns all of them with their outcomes, in plan order.
///
/// # Errors
/// Only when an outcome cannot be stored. An engine that fails, or panics, is an outcome.
pub fn evaluate(
    study: &dyn Study,
    context: &Context,
    cells: Vec<Cell>,
    store: &OutcomeStore,
    progress: &dyn Progress,
) -> Result<Vec<Finished>, HarnessError> {
    let missing: Vec<&Cell> = cells.iter().filter(|cell| !store.contains(&cell.id())).collect();
    progress.begin(study.name(), missing.len());
    // One group per robot and engine, so that a process behind an engine builds each robot once.
    let mut groups: Vec<Vec<&Cell>> = Vec::new();
    for cell in missing {
        match groups.last_mut() {
            Some(group) if group[0].robot == cell.robot && group[0].engine == cell.engine => group.push(cell),
            _ => groups.push(vec![cell]),
        }
    }
    let work = |group: &Vec<&Cell>| -> Result<(), HarnessError> {
        for cell in group {
            progress.cell(cell);
            let outcome = guarded(study, context, cell);
            progress.done(cell, &outcome);
            store.insert(cell, outcome)?;
        }
        Ok(())
    };
    if study.exclusive() {
        groups.iter().try_for_each(work)?
    } else {
        groups.par_iter().with_max_len(1).try_for_each(work)?
    }
    progress.end();
    Ok(cells
        .into_iter()
        .map(|cell| {
            let lost = || Outcome::NoAnswer(NoAnswer::Failed("the outcome was not kept".into()));
            let outcome = store.get(&cell.id()).unwrap_or_else(lost);
            (cell, outcome)
        })
        .collect())
}

/// A panic in an engine or study is a failure of that cell alone.
fn guarded(study: &dyn Study, context: &Context, cell: &Cell) -> Outcome {
    catch_unwind(AssertUnwindSafe(|| study.evaluate(context, cell))).unwrap_or_else(|panic| {
        let message = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        Outcome::NoAnswer(NoAnswer::Failed(format!("internal error: {}", message.unwrap_or("panic without a message"))))
    })
}

/// Turns outcomes into rows: first those of no robot, then robot by robot on all cores, in the order of the robots.
pub fn compare(study: &dyn Study, context: &Context, finished: Vec<Finished>) -> Vec<Row> {
    let together = study.compare_all(context, &finished);
    let groups = by_robot(finished);
    let compared: Vec<Vec<Row>> = context
        .robots
        .par_iter()
        .map(|robot| groups.get(&robot.name).map_or_else(Vec::new, |group| study.compare(context, robot, group)))
        .collect();
    together.into_iter().chain(compared.into_iter().flatten()).collect()
}
