//! `featherbench run`: plan, evaluate, compare, judge, report.

use crate::args::RunArgs;
use crate::engines::{self, Asked, Opened};
use crate::external::External;
use crate::fail::Fail;
use crate::filter;
use crate::offers;
use crate::oracles;
use crate::progress::Bar;
use crate::report;
use crate::robots::{self, Loaded};
use crate::root::Root;
use ::featherbench_results::{Culprit, Expectation, GateKind, RunInfo, quoted};
use featherbench_bench::run::{Opening, Run};
use featherbench_bench::{Cell, Context, Counts, Robot, Study, provenance};
use featherbench_studies::Setup;
use regex_lite::Regex;
use std::path::PathBuf;
use std::time::{Instant, SystemTime};

/// Runs a suite and reports on it.
pub fn run(root: &Root, args: &RunArgs) -> Result<(), Fail> {
    let start = Instant::now();
    let filter = args.filter.as_deref().map(Regex::new).transpose();
    let filter = filter.map_err(|error| Fail::input(format!("--filter: {error}")))?;
    let loaded = robots::load(root, &args.suite, args.live, args.seed)?;
    let suite = &loaded.suite;
    let program = provenance::collect(root.path());
    let studies = studies(root, &loaded, args, &program.binary_hash)?;
    let externals: Vec<&str> = args.externals.iter().map(|external: &External| external.name.as_str()).collect();
    let gates = root.read_gates()?.with_external(&externals);
    let gates = gates.with_robots(loaded.robots.iter().map(|robot| (robot.name.clone(), robot.properties())))?;
    let counts = Counts::read(&root.counts())?;
    let opened = engines::open(root, &Asked::by_suite(root, args, &loaded, &studies))?;
    let context = Context { robots: &loaded.robots, engines: &opened.engines, gates: &gates, seed: suite.seed };
    let cells: Vec<Cell> = studies.iter().flat_map(|study| study.plan(&context)).collect();
    let filtered = || match args.filter.as_ref().zip(filter.as_ref()) {
        Some((text, filter)) => filter::check(text, filter, &loaded.name, &cells.iter().map(Cell::path).collect::<Vec<_>>()),
        None => Ok(()),
    };
    // Before a folder is made; of a run that goes on, that it is the same comes first.
    if !args.resume {
        filtered()?;
    }

    let started = SystemTime::now();
    let folder = args.out.clone().unwrap_or_else(|| folder(root, &loaded.name, started));
    let about = About { suite: &loaded.name, hash: &loaded.hash, seed: suite.seed, live: args.live, robots: &loaded.robots };
    let info = describe(root, program, &about, &opened, started)?;
    let opening = match (args.resume, args.allow_mixed) {
        (false, _) => Opening::New,
        (true, false) => Opening::Resume,
        (true, true) => Opening::ResumeMixed,
    };
    tell_notes(&info);
    let mut run = Run::open(&folder, opening, info)?;
    filtered()?;
    run.info.seconds.insert("setup".into(), start.elapsed().as_secs_f64());

    let keep = |cell: &Cell| filter.as_ref().is_none_or(|filter| filter.is_match(&cell.path()));
    let rows = run.conduct(&studies, &context, &keep, &Bar::new())?;
    let complete = filter.is_none();
    run.info.expected = gates.conditions(suite, &rows, complete);
    if complete {
        run.info.expected.extend(counts.conditions(&run.info, suite.engines(), &rows));
    }
    let asked: Vec<&str> = suite.engines().iter().map(String::as_str).chain(externals.iter().copied()).collect();
    run.info.expected.extend(offers::conditions(&opened, &asked, &cells, &rows, complete));
    run.info.expected.extend(opened.missing(suite.engines()).into_iter().map(|engine| missing_engine(&engine.name, &engine.reason)));
    run.info.seconds.insert("total".into(), start.elapsed().as_secs_f64());
    run.write(&rows)?;
    let page = report::render(&run.folder, &run.info, &rows)?;
    report::conclude(&run.info, &rows, &page, args.open)
}

/// The studies that a suite asks for. `program` is the hash of this program.
fn studies(root: &Root, loaded: &Loaded, args: &RunArgs, program: &str) -> Result<Vec<Box<dyn Study>>, Fail> {
    let reproduce = oracles::reproducer(root, engines::limits(args));
    let measure = oracles::measurer(root)?;
    let setup = Setup { suite: &loaded.suite, live: args.live, program, kernels: featherbench_engines::timed, reproduce, measure };
    let mut studies = featherbench_studies::of_suite(&setup)?;
    studies.retain(|study| !(args.no_timing && study.measures_time()));
    Ok(studies)
}

/// A new folder in `reports`, with suite and time in its name.
pub fn folder(root: &Root, suite: &str, started: SystemTime) -> PathBuf {
    let stamp: String = humantime::format_rfc3339_seconds(started).to_string().chars().filter(|c| !":-Z".contains(*c)).collect();
    root.reports().join(format!("{suite}-{}", stamp.replace('T', "-")))
}

/// Notes that are told before a run; the report has all.
const TOLD: usize = 5;

/// Tells what is unusual about the robots.
pub fn tell_notes(info: &RunInfo) {
    let notes = || info.robots.iter().flat_map(|robot| robot.notes.iter().map(move |note| (&robot.name, note)));
    notes().take(TOLD).for_each(|(name, note)| eprintln!("note: {name}: {note}"));
    let more = notes().count().saturating_sub(TOLD);
    if more > 0 {
        eprintln!("note: {more} more notes on robots are in the report");
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
    let command = std::env::args().skip(1).map(|word| quoted(&word));
    let mut conventions = featherbench_bench::conventions::read(&root.conventions())?;
    conventions.retain(|row| opened.infos.iter().any(|engine| engine.name == row.engine));
    Ok(RunInfo {
        suite: about.suite.into(),
        suite_hash: about.hash.into(),
        command: ["cargo run --release --".to_owned()].into_iter().chain(command).collect::<Vec<_>>().join(" "),
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
