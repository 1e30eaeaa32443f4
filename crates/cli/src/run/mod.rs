//! `featherbench run`: plan, evaluate, compare, judge, report.

mod again;
mod command;
pub mod filter;
pub mod hyperqueue;
pub mod merge;
pub mod plan;
pub mod shard;
pub mod sweep;
mod times;

use crate::args::RunArgs;
use crate::fail::Fail;
use crate::message::tell;
use crate::oracles;
use crate::oracles::engines::{self, Asked, Opened};
use crate::oracles::external::External;
use crate::oracles::offers;
use crate::progress::Bar;
use crate::report;
use crate::robots::{self, Loaded};
use crate::root::Root;
use crate::run::again::Again;
use ::featherbench_results::{Culprit, Drawing, Expectation, GateKind, Row, RunInfo};
use featherbench_bench::run::{Opening, Run};
use featherbench_bench::{Cell, Context, Counts, Gates, HarnessError, Robot, Study, drawing, provenance};
use featherbench_registry::Setup;
use featherbench_report::Findings;
use regex_lite::Regex;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

/// Everything that a run needs before its folder.
pub struct Prepared {
    pub loaded: Loaded,
    pub studies: Vec<Box<dyn Study>>,
    pub filter: Option<Regex>,
    gates: Gates,
    counts: Counts,
    opened: Opened,
    program: RunInfo,
    start: Instant,
}

/// Reads a suite with its robots and gates, and opens its engines.
pub fn prepare(root: &Root, args: &RunArgs) -> Result<Prepared, Fail> {
    let start = Instant::now();
    let filter = args.asked.filter.as_deref().map(Regex::new).transpose();
    let filter = filter.map_err(|error| Fail::input(format!("--filter: {error}")))?;
    let loaded = robots::load(root, &args.suite, args.asked.live, args.asked.seed, args.asked.size)?;
    let program = provenance::collect(root.path());
    let studies = studies(root, &loaded, args, &program.binary_hash)?;
    let gates = root.read_gates()?.with_external(&externals(args));
    let gates = gates.with_robots(loaded.robots.iter().map(|robot| (robot.name.clone(), robot.properties())))?;
    let counts = Counts::read(&root.counts())?;
    let opened = engines::open(root, &Asked::by_suite(root, args, &loaded, &studies))?;
    Ok(Prepared { loaded, studies, filter, gates, counts, opened, program, start })
}

impl Prepared {
    /// The data of the studies.
    pub fn context(&self) -> Context<'_> {
        Context { robots: &self.loaded.robots, engines: &self.opened.engines, gates: &self.gates, seed: self.loaded.suite.seed }
    }

    /// Whether a cell is asked.
    pub fn keeps(&self, cell: &Cell) -> bool {
        self.filter.as_ref().is_none_or(|filter| filter.is_match(&cell.path()))
    }

    /// The cells of all studies, whatever the filter leaves.
    fn cells(&self) -> Vec<Cell> {
        let context = self.context();
        self.studies.iter().flat_map(|study| study.plan(&context)).collect()
    }

    /// Refuses a filter that leaves nothing.
    pub fn check_filter(&self, args: &RunArgs) -> Result<(), Fail> {
        let Some((text, filter)) = args.asked.filter.as_ref().zip(self.filter.as_ref()) else { return Ok(()) };
        filter::check(text, filter, &self.loaded.name, &self.cells().iter().map(Cell::path).collect::<Vec<_>>())
    }

    /// What the rows of a run that starts now share.
    pub fn describe(&self, root: &Root, args: &RunArgs, started: SystemTime) -> Result<RunInfo, Fail> {
        let Loaded { name, hash, suite, robots, .. } = &self.loaded;
        let about = About { suite: name, hash, seed: suite.seed, live: args.asked.live, robots };
        let info = describe(root, self.program.clone(), &about, &self.opened, started)?;
        Ok(RunInfo { recorded_times: times::recorded(root)?, ..info })
    }

    /// Judges the rows of a run, writes it with its report, and tells the end.
    pub fn conclude(&self, args: &RunArgs, mut run: Run, rows: &[Row], more: Vec<Expectation>) -> Result<(), Fail> {
        let suite = &self.loaded.suite;
        let complete = self.filter.is_none();
        run.info.expected = self.gates.conditions(suite, rows, complete);
        if complete && self.loaded.own_size {
            run.info.expected.extend(self.counts.conditions(&run.info, suite.engines(), rows));
        }
        let asked: Vec<&str> = suite.engines().iter().map(String::as_str).chain(externals(args)).collect();
        run.info.expected.extend(offers::conditions(&self.opened, &asked, &self.cells(), rows, complete));
        let missing = self.opened.missing(suite.engines());
        run.info.expected.extend(missing.into_iter().map(|engine| missing_engine(&engine.name, &engine.reason)));
        run.info.expected.extend(more);
        run.info.drawings = drawings(&run.info, rows, &self.loaded.robots);
        run.info.seconds.insert("total".into(), self.start.elapsed().as_secs_f64());
        run.write(rows, &featherbench_registry::dictionary(rows))?;
        let page = report::render(&run.folder, &run.info, rows)?;
        report::conclude(&run.info, rows, &page, args.open)
    }
}

/// The drawings that a judged run keeps, those of robots in its findings first. If some are left out, that is told.
pub fn drawings(info: &RunInfo, rows: &[Row], robots: &[Robot]) -> BTreeMap<String, Drawing> {
    let findings = Findings::of(info, rows);
    let first = findings.found.iter().map(|found| found.culprit.robot.as_str()).collect();
    let (drawings, left_out) = drawing::of_run(robots, &first);
    if left_out > 0 {
        let (drawn, most) = (drawings.len(), Drawing::MOST_BYTES);
        tell!("note: the report draws {drawn} robots; with {left_out} more, the drawings would have over {most} bytes");
    }
    drawings
}

/// The names of the engines that a user brings along.
fn externals(args: &RunArgs) -> Vec<&str> {
    args.asked.externals.iter().map(|external: &External| external.name.as_str()).collect()
}

/// How the folder of a run is opened.
pub fn opening(args: &RunArgs) -> Opening {
    match (args.resume, args.allow_mixed) {
        (false, _) => Opening::New,
        (true, false) => Opening::Resume,
        (true, true) => Opening::ResumeMixed,
    }
}

/// Runs a suite and reports on it, or evaluates a shard of it.
pub fn run(root: &Root, args: &RunArgs) -> Result<(), Fail> {
    let prepared = prepare(root, args)?;
    if args.answer.is_some() {
        return again::answer(&prepared);
    }
    // Before a folder is made; of a run that goes on, that it is the same comes first.
    if !args.resume {
        prepared.check_filter(args)?;
    }
    let started = SystemTime::now();
    let info = prepared.describe(root, args, started)?;
    let folder = folder(root, args.out.as_deref(), &prepared.loaded.name, started)?;
    tell_notes(&info);
    if let Some(shard) = args.shard {
        return shard::evaluate(&prepared, args, shard, &folder, info);
    }
    let mut run = Run::open(&folder, opening(args), info)?;
    run.new_process = Some(Box::new(Again::of(args)));
    prepared.check_filter(args)?;
    run.info.seconds.insert("setup".into(), prepared.start.elapsed().as_secs_f64());
    let rows = run.conduct(&prepared.studies, &prepared.context(), &|cell| prepared.keeps(cell), &Bar::of_run(&folder))?;
    prepared.conclude(args, run, &rows, Vec::new())
}

/// The studies that a suite asks for. `program` is the hash of this program.
fn studies(root: &Root, loaded: &Loaded, args: &RunArgs, program: &str) -> Result<Vec<Box<dyn Study>>, Fail> {
    let reproduce = oracles::reproducer(root, engines::limits(args));
    let measure = oracles::measurer(root)?;
    let setup = Setup { suite: &loaded.suite, live: args.asked.live, program, reproduce, measure };
    let mut studies = featherbench_registry::of_suite(&setup)?;
    studies.retain(|study| !(args.asked.no_timing && study.measures_time()));
    studies.retain(|study| args.answer.as_ref().is_none_or(|answer| answer == study.name()));
    Ok(studies)
}

/// The folder that is asked for; else a new one in `reports`, with suite and time in its name. That is made here: of programs that start
/// within one second each has its own.
///
/// # Errors
/// When no folder can be made there.
pub fn folder(root: &Root, out: Option<&Path>, suite: &str, started: SystemTime) -> Result<PathBuf, Fail> {
    if let Some(out) = out {
        return Ok(out.to_owned());
    }
    let reports = root.reports();
    let io = |source| HarnessError::NoFolder { path: reports.clone(), source };
    let stamp: String = humantime::format_rfc3339_seconds(started).to_string().chars().filter(|c| !":-Z".contains(*c)).collect();
    let name = format!("{suite}-{}", stamp.replace('T', "-"));
    std::fs::create_dir_all(&reports).map_err(io)?;
    let mut folder = reports.join(&name);
    let mut copy = 1;
    while let Err(source) = std::fs::create_dir(&folder) {
        if source.kind() != std::io::ErrorKind::AlreadyExists {
            return Err(io(source).into());
        }
        copy += 1;
        folder = reports.join(format!("{name}-{copy}"));
    }
    Ok(folder)
}

/// Notes that are told before a run; the report has all.
const TOLD: usize = 5;

/// Tells what is unusual about the robots.
pub fn tell_notes(info: &RunInfo) {
    let notes = || info.robots.iter().flat_map(|robot| robot.notes.iter().map(move |note| (&robot.name, note)));
    notes().take(TOLD).for_each(|(name, note)| tell!("note: {name}: {note}"));
    let more = notes().count().saturating_sub(TOLD);
    if more > 0 {
        tell!("note: {more} more notes on robots are in the report");
    }
}

/// What a run is about.
pub struct About<'a> {
    /// The suite's name.
    pub suite: &'a str,
    /// The hash of the suite's file.
    pub hash: &'a str,
    pub seed: u64,
    /// Whether the engines themselves are asked.
    pub live: bool,
    pub robots: &'a [Robot],
}

/// Everything about the run that its rows share; `program` has the facts about program and machine.
pub fn describe(root: &Root, program: RunInfo, about: &About, opened: &Opened, started: SystemTime) -> Result<RunInfo, Fail> {
    let mut conventions = featherbench_bench::conventions::read(&root.conventions())?;
    conventions.retain(|row| opened.infos.iter().any(|engine| engine.name == row.engine));
    Ok(RunInfo {
        suite: about.suite.into(),
        suite_hash: about.hash.into(),
        command: command::typed(root),
        started: humantime::format_rfc3339_seconds(started).to_string(),
        seed: about.seed,
        live: about.live,
        engines: opened.infos.clone(),
        robots: provenance::robots(about.robots),
        conventions,
        ..program
    })
}

/// The condition that an engine of the suite answers, which is not met.
fn missing_engine(name: &str, reason: &str) -> Expectation {
    Expectation::new(GateKind::Engine, format!("engine {name} answers"), 1, 0).because(reason.to_owned()).about(Culprit::engine(name))
}
