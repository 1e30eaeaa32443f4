//! A run: its folder, the cells of its studies, and their rows.
//!
//! Cells are evaluated on all cores, those of exclusive studies alone. Each outcome is stored when it is known.

pub(crate) mod cell;
pub(crate) mod entries;
mod fingerprint;
mod load;
mod offers;
pub mod params;
mod processes;
pub mod provenance;
pub mod shard;
pub(crate) mod store;
pub(crate) mod study;

pub use crate::run::fingerprint::{FINGERPRINT_NAME, shard_of};
pub use crate::run::processes::{NewProcess, answer};

use crate::run::fingerprint::SHARD;
use crate::run::load::Load;
use crate::run::study::{Asked, Context, Finished, Study, by_robot};
use crate::shard::{Shard, hash_of};
use crate::{Cell, HarnessError, Lost, NoAnswer, OUTCOMES_NAME, Outcome, OutcomeStore, Robot};
use featherbench_results::{CHECKSUMS_NAME, Dictionary, Row, RunInfo};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashSet};
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
/// run.write(&rows, &featherbench_results::Dictionary::default()).unwrap();
/// assert_eq!(featherbench_results::read_run(&run.folder).unwrap().0.run, "first");
/// ```
#[derive(Debug)]
pub struct Run {
    /// Its folder.
    pub folder: PathBuf,
    /// What its rows share. The id is the folder's name.
    pub info: RunInfo,
    /// How a new process is started for cells that ask for one. Without it they are evaluated in this one.
    pub new_process: Option<Box<dyn NewProcess>>,
    /// The names of the files that studies left beside the rows.
    files: Vec<&'static str>,
}

impl Run {
    /// Opens a run's folder, and makes it if it is new.
    ///
    /// # Errors
    /// [`HarnessError`] when a new run has an occupied folder, a resumed one has none, or the run in it was made of something else.
    pub fn open(folder: &Path, opening: Opening, info: RunInfo) -> Result<Self, HarnessError> {
        Self::open_with(folder, opening, info, BTreeMap::new())
    }

    /// The same for a shard with these cells: it is continued only as itself.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_shard<'a>(
        folder: &Path,
        opening: Opening,
        info: RunInfo,
        shard: Shard,
        cells: impl Iterator<Item = &'a str>,
    ) -> Result<Self, HarnessError> {
        let more = [(SHARD.to_owned(), shard.to_string()), ("set of cells".to_owned(), hash_of(cells))];
        Self::open_with(folder, opening, info, more.into())
    }

    fn open_with(folder: &Path, opening: Opening, info: RunInfo, more: BTreeMap<String, String>) -> Result<Self, HarnessError> {
        let io = |source| HarnessError::io(folder, source);
        let path = folder.join(FINGERPRINT_NAME);
        if opening == Opening::New {
            if folder.exists() && std::fs::read_dir(folder).map_err(io)?.next().is_some() {
                return Err(HarnessError::Occupied { path: folder.to_owned() });
            }
        } else if !path.is_file() {
            return Err(HarnessError::NothingToResume { path: folder.to_owned() });
        }
        std::fs::create_dir_all(folder).map_err(|source| HarnessError::NoFolder { path: folder.to_owned(), source })?;
        let mut now = provenance::fingerprint(&info);
        now.extend(more);
        if opening == Opening::Resume {
            fingerprint::compare(folder, &now)?;
        } else {
            fingerprint::write(folder, &now)?;
        }
        // A run that goes on is unfinished until its files are written again.
        match std::fs::remove_file(folder.join(CHECKSUMS_NAME)) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => return Err(io(source)),
            _ => {}
        }
        let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Self { folder: folder.to_owned(), info: RunInfo { run: id, ..info }, new_process: None, files: Vec::new() })
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
        self.rows(studies, context, keep, Some(progress))
    }

    /// Compares the outcomes that are in the folder, study after study, and evaluates nothing. A cell without an outcome is a row that says so.
    ///
    /// # Errors
    /// Only when a file of the run cannot be read or written.
    pub fn assemble(
        &mut self,
        studies: &[Box<dyn Study>],
        context: &Context,
        keep: &(dyn Fn(&Cell) -> bool + Sync),
    ) -> Result<Vec<Row>, HarnessError> {
        self.rows(studies, context, keep, None)
    }

    /// Evaluates some cells, and compares nothing: the outcomes are kept in the folder.
    ///
    /// # Errors
    /// Only when a file of the run cannot be read or written. An engine that fails, or panics, is an outcome.
    pub fn evaluate(
        &self,
        studies: &[Box<dyn Study>],
        context: &Context,
        keep: &(dyn Fn(&Cell) -> bool + Sync),
        mine: &HashSet<String>,
        progress: &dyn Progress,
    ) -> Result<(), HarnessError> {
        let store = self.store(progress)?;
        for study in studies {
            let mut cells = plan(study.as_ref(), context, keep);
            cells.retain(|cell| mine.contains(&cell.id()));
            if !cells.is_empty() {
                complete(study.as_ref(), context, &cells, &store, progress, self.new_process.as_deref())?;
            }
        }
        Ok(())
    }

    fn store(&self, progress: &dyn Progress) -> Result<OutcomeStore, HarnessError> {
        let store = OutcomeStore::open(&self.folder)?;
        if let Some(lost) = store.lost() {
            progress.lost(lost);
        }
        Ok(store)
    }

    fn rows(
        &mut self,
        studies: &[Box<dyn Study>],
        context: &Context,
        keep: &(dyn Fn(&Cell) -> bool + Sync),
        progress: Option<&dyn Progress>,
    ) -> Result<Vec<Row>, HarnessError> {
        let store = self.store(progress.unwrap_or(&Silent))?;
        let mut rows: Vec<Row> = Vec::new();
        for study in studies {
            let start = Instant::now();
            let whole = study.plan(context);
            let engines: BTreeSet<String> = whole.iter().map(|cell| cell.engine.clone()).collect();
            let cells = kept(study.as_ref(), whole, keep);
            if let Some(progress) = progress {
                // A study with processes of its own keeps one core busy; one without may use all.
                let load = cells.iter().any(|cell| study.process(cell).is_some()).then(Load::now).flatten();
                complete(study.as_ref(), context, &cells, &store, progress, self.new_process.as_deref())?;
                let others = load.and_then(|load| load.others());
                self.info.others.extend(others.map(|others| (study.name().to_owned(), others)));
            }
            if study.compares_all() {
                let finished = outcomes(cells, &store)?;
                if let Some((name, text)) = study.side_file(&finished) {
                    featherbench_results::atomic_write(&self.folder.join(name), text.as_bytes())?;
                    self.files.push(name);
                }
                rows.extend(compare(study.as_ref(), context, finished));
            } else {
                compare_stored(study.as_ref(), context, cells, &store, &mut rows)?;
            }
            rows.extend(offers::rows(study.as_ref(), context, &engines, keep));
            self.info.studies.push(study.name().into());
            self.info.seconds.insert(study.name().into(), start.elapsed().as_secs_f64());
        }
        for row in &mut rows {
            row.run.clone_from(&self.info.run);
        }
        self.info.rows = rows.len() as u64;
        Ok(rows)
    }

    /// Writes rows, what their names mean, provenance and checksums into the folder.
    ///
    /// # Errors
    /// When a file cannot be written, or a row holds a number that is not finite.
    pub fn write(&self, rows: &[Row], dictionary: &Dictionary) -> Result<(), HarnessError> {
        let files = [&[FINGERPRINT_NAME, OUTCOMES_NAME], self.files.as_slice()].concat();
        Ok(featherbench_results::write_run_with(&self.folder, &self.info, rows, dictionary, &files)?)
    }
}

/// The cells of a study that a filter accepts. If there are any, the cells that belong to no robot come with them.
pub fn plan(study: &dyn Study, context: &Context, keep: &(dyn Fn(&Cell) -> bool + Sync)) -> Vec<Cell> {
    kept(study, study.plan(context), keep)
}

fn kept(study: &dyn Study, whole: Vec<Cell>, keep: &(dyn Fn(&Cell) -> bool + Sync)) -> Vec<Cell> {
    let kept: Vec<Cell> = whole.into_iter().filter(|cell| keep(cell) || study.is_common(cell)).collect();
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
    complete(study, context, &cells, store, progress, None)?;
    outcomes(cells, store)
}

/// Evaluates the unfinished cells of a study: first those of this process, then those of new ones, process by process.
fn complete(
    study: &dyn Study,
    context: &Context,
    cells: &[Cell],
    store: &OutcomeStore,
    progress: &dyn Progress,
    new_process: Option<&dyn NewProcess>,
) -> Result<(), HarnessError> {
    let missing: Vec<&Cell> = cells.iter().filter(|cell| !store.contains(&cell.id())).collect();
    progress.begin(study.name(), missing.len());
    let apart = |cell: &&Cell| new_process.is_some() && study.process(cell).is_some();
    let (mut apart, missing): (Vec<&Cell>, Vec<&Cell>) = missing.into_iter().partition(apart);
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
            let start = Instant::now();
            let outcome = guarded(study, context, cell);
            let took = start.elapsed();
            progress.done(cell, &outcome);
            store.insert_after(cell, &outcome, took)?;
        }
        Ok(())
    };
    if study.exclusive() {
        groups.iter().try_for_each(work)?
    } else {
        groups.par_iter().with_max_len(1).try_for_each(work)?
    }
    apart.sort_by_cached_key(|cell| study.process(cell));
    if let Some(new_process) = new_process {
        for cells in apart.chunk_by(|a, b| study.process(a) == study.process(b)) {
            progress.cell(cells[0]);
            processes::evaluate(new_process.command(study.name()), cells, &mut |cell, outcome, took| {
                progress.done(cell, outcome);
                store.insert_after(cell, outcome, took)
            })?;
        }
    }
    progress.end();
    Ok(())
}

/// Cells with their outcomes.
fn outcomes(cells: Vec<Cell>, store: &OutcomeStore) -> Result<Vec<Finished>, HarnessError> {
    let of = |cell: Cell| {
        let absent = || {
            Outcome::NoAnswer(NoAnswer::Failed("there is no outcome of this cell: it was not evaluated, or its shard is missing".into()))
        };
        let outcome = store.get(&cell.id())?.unwrap_or_else(absent);
        Ok((cell, outcome))
    };
    cells.into_iter().map(of).collect()
}

/// A panic in an engine or study is a failure of that cell alone.
fn guarded(study: &dyn Study, context: &Context, cell: &Cell) -> Outcome {
    catch_unwind(AssertUnwindSafe(|| study.evaluate(&Asked::of(context, cell)))).unwrap_or_else(|panic| {
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

/// Robots that are compared before their rows are moved to those of the run. More would have them in memory twice, fewer would leave cores idle.
const TOGETHER: usize = 256;

/// Appends the same rows of a study whose rows all belong to robots: one robot's outcomes are read at a time, on each core.
fn compare_stored(
    study: &dyn Study,
    context: &Context,
    cells: Vec<Cell>,
    store: &OutcomeStore,
    rows: &mut Vec<Row>,
) -> Result<(), HarnessError> {
    let mut groups: BTreeMap<String, Vec<Cell>> = BTreeMap::new();
    for cell in cells {
        groups.entry(cell.robot.clone()).or_default().push(cell);
    }
    let robots: Vec<(&Robot, Vec<Cell>)> =
        context.robots.iter().filter_map(|robot| groups.remove(&robot.name).map(|group| (robot, group))).collect();
    let of = |(robot, group): &(&Robot, Vec<Cell>)| -> Result<Vec<Row>, HarnessError> {
        Ok(study.compare(context, robot, &outcomes(group.clone(), store)?))
    };
    for some in robots.chunks(TOGETHER) {
        let compared: Vec<Vec<Row>> = some.par_iter().map(of).collect::<Result<_, _>>()?;
        rows.extend(compared.into_iter().flatten());
    }
    Ok(())
}
