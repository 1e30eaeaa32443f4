//! `featherbench run`: plan, evaluate, compare, judge, report.

use crate::args::RunArgs;
use crate::engines::{self, Opened};
use crate::external::External;
use crate::fail::Fail;
use crate::filter;
use crate::offers;
use crate::progress::Bar;
use crate::report;
use crate::robots::{self, Loaded};
use crate::root::Root;
use crate::shell::quoted;
use ::featherbench_results::{ModelInfo, Row, RunInfo, Verdict};
use featherbench_bench::{Cell, Context, Gates, HarnessError, OutcomeStore, Study, provenance};
use featherbench_studies::{Accuracy, Agreement, Conditioning, Import, OperationCounts, Repeatability, Reproductions, Steps, Timing};
use regex_lite::Regex;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

/// The file that holds what a resumed run must share with the first one.
const FINGERPRINT_NAME: &str = "fingerprint.json";

/// Runs a suite and reports on it.
pub fn run(root: &Root, args: &RunArgs) -> Result<(), Fail> {
    let start = Instant::now();
    let only = args.filter.as_deref().map(Regex::new).transpose();
    let only = only.map_err(|error| Fail::input(format!("--filter: {error}")))?;
    let loaded = robots::load(root, &args.suite, args.live, args.seed)?;
    let externals: Vec<&str> = args.externals.iter().map(|external: &External| external.name.as_str()).collect();
    let gates = Gates::read(&root.gates())?.with_external(&externals);
    let opened = engines::open(root, args, &loaded)?;
    let mut info = describe(root, args.live, &loaded, &opened)?;
    let studies = studies(root, &loaded, args, &info.binary_hash);
    let context = Context { robots: &loaded.robots, engines: &opened.engines, gates: &gates, seed: loaded.suite.seed };
    let cells: Vec<Cell> = studies.iter().flat_map(|study| study.plan(&context)).collect();
    let filtered = || match args.filter.as_ref().zip(only.as_ref()) {
        Some((text, only)) => filter::check(text, only, &loaded.name, &cells.iter().map(Cell::path).collect::<Vec<_>>()),
        None => Ok(()),
    };
    // Before a folder is made; of a run that goes on, that it is the same comes first.
    if !args.resume {
        filtered()?;
    }

    let started = SystemTime::now();
    let (folder, id) = folder(root, args.out.as_deref(), args.resume, &loaded.name, started)?;
    info.run = id;
    tell_notes(&info);
    info.started = humantime::format_rfc3339_seconds(started).to_string();
    check_fingerprint(&folder, args, &info)?;
    filtered()?;
    info.seconds.insert("setup".into(), start.elapsed().as_secs_f64());

    let keep = |cell: &Cell| only.as_ref().is_none_or(|only| only.is_match(&cell.path()));
    let (records, files) = conduct_with_files(&studies, &context, &folder, &keep, &mut info)?;
    let complete = only.is_none();
    info.expected = gates.conditions(&loaded.suite, &records, complete);
    let engines = loaded.suite.agreement.iter().flat_map(|agreement| &agreement.engines).map(String::as_str);
    let asked: Vec<&str> = engines.chain(externals.iter().copied()).collect();
    info.expected.extend(offers::conditions(&opened, &asked, &cells, &records, complete));
    for engine in opened.missing(&loaded) {
        info.expected.push(missing_engine(&engine.name, &engine.reason));
    }
    info.seconds.insert("total".into(), start.elapsed().as_secs_f64());
    ::featherbench_results::write_run_with(&folder, &info, &records, &files)?;
    let page = report::render(&folder, &info, &records)?;
    report::conclude(&info, &records, &page)
}

/// Plans, evaluates and compares study after study; the outcomes are kept in the folder as they come.
pub fn conduct(
    studies: &[Box<dyn Study>],
    context: &Context,
    folder: &Path,
    keep: &(dyn Fn(&Cell) -> bool + Sync),
    info: &mut RunInfo,
) -> Result<Vec<Row>, Fail> {
    Ok(conduct_with_files(studies, context, folder, keep, info)?.0)
}

/// The same, with the names of the files that studies left beside the records.
fn conduct_with_files(
    studies: &[Box<dyn Study>],
    context: &Context,
    folder: &Path,
    keep: &(dyn Fn(&Cell) -> bool + Sync),
    info: &mut RunInfo,
) -> Result<(Vec<Row>, Vec<&'static str>), Fail> {
    let store = OutcomeStore::open(folder)?;
    if let Some(lost) = store.lost() {
        eprintln!("{lost}: its cells are evaluated again");
    }
    let progress = Bar::new();
    let (mut records, mut files): (Vec<Row>, Vec<&str>) = (Vec::new(), Vec::new());
    for study in studies {
        let phase = Instant::now();
        let cells = featherbench_bench::run::plan(study.as_ref(), context, keep);
        let finished = featherbench_bench::run::evaluate(study.as_ref(), context, cells, &store, &progress)?;
        if let Some((name, text)) = study.side_file(&finished) {
            ::featherbench_results::atomic_write(&folder.join(name), text.as_bytes())?;
            files.push(name);
        }
        records.extend(featherbench_bench::run::compare(study.as_ref(), context, finished));
        info.seconds.insert(study.name().into(), phase.elapsed().as_secs_f64());
    }
    for record in &mut records {
        record.run.clone_from(&info.run);
    }
    info.rows = records.len() as u64;
    Ok((records, files))
}

/// The studies that a suite names, in the order of the report; what runs alone comes behind all others, timing last, because it wants a quiet
/// machine. `program` is the hash of this program.
fn studies(root: &Root, loaded: &Loaded, args: &RunArgs, program: &str) -> Vec<Box<dyn Study>> {
    let mut studies: Vec<Box<dyn Study>> = Vec::new();
    if loaded.suite.agreement.is_some() {
        studies.push(Box::new(Agreement));
    }
    // What engines read from files is not recorded.
    if loaded.suite.import && args.live {
        studies.push(Box::new(Import));
    }
    if loaded.suite.accuracy {
        studies.push(Box::new(Accuracy));
    }
    if loaded.suite.conditioning {
        studies.push(Box::new(Conditioning));
    }
    if loaded.suite.steps {
        studies.push(Box::new(Steps));
    }
    if loaded.suite.operations {
        studies.push(Box::new(OperationCounts));
    }
    if loaded.suite.reproductions {
        studies.push(Box::new(Reproductions { reproduce: crate::oracles::reproducer(root, engines::limits(args)) }));
    }
    if loaded.suite.agreement.is_some() {
        studies.push(Box::new(Repeatability { key: program.to_owned() }));
    }
    if let Some(timing) = loaded.suite.timing.as_ref().filter(|_| !args.no_timing) {
        let (states, seconds, peers) = (timing.states, timing.seconds, timing.peers.clone());
        studies.push(Box::new(Timing { states, seconds, kernels: featherbench_engines::timed, peers }));
    }
    studies
}

/// The run's folder and id: a new folder, an empty one, or with `--resume` the one that is there.
pub fn folder(root: &Root, out: Option<&Path>, resume: bool, suite: &str, started: SystemTime) -> Result<(PathBuf, String), Fail> {
    let stamp: String = humantime::format_rfc3339_seconds(started).to_string().chars().filter(|c| !":-Z".contains(*c)).collect();
    let folder = out.map_or_else(|| root.reports().join(format!("{suite}-{}", stamp.replace('T', "-"))), Path::to_owned);
    let io = |source| Fail::from(HarnessError::io(&folder, source));
    let occupied = folder.exists() && std::fs::read_dir(&folder).map_err(io)?.next().is_some();
    if resume && !folder.join(FINGERPRINT_NAME).is_file() {
        return Err(HarnessError::NothingToResume { path: folder }.into());
    }
    if occupied && !resume {
        return Err(HarnessError::Occupied { path: folder }.into());
    }
    std::fs::create_dir_all(&folder).map_err(io)?;
    let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    Ok((folder, id))
}

/// Writes the fingerprint of a new run, or compares with that of the run which is continued.
fn check_fingerprint(folder: &Path, args: &RunArgs, info: &RunInfo) -> Result<(), Fail> {
    let path = folder.join(FINGERPRINT_NAME);
    let now = provenance::fingerprint(info);
    if args.resume && !args.allow_mixed {
        let text = std::fs::read_to_string(&path).map_err(|source| HarnessError::io(&path, source))?;
        let then: BTreeMap<String, String> =
            serde_json::from_str(&text).map_err(|error| Fail::input(format!("{}: {error}", path.display())))?;
        let different = then.keys().chain(now.keys()).find(|what| then.get(*what) != now.get(*what));
        return match different {
            None => Ok(()),
            Some(what) => {
                let [then, now] = [&then, &now].map(|side| side.get(what).map_or("none", String::as_str).to_owned());
                Err(HarnessError::Mixed { path: folder.to_owned(), what: what.clone(), then, now }.into())
            }
        };
    }
    let text = serde_json::to_string_pretty(&now).map_err(|error| Fail::input(error.to_string()))?;
    Ok(::featherbench_results::atomic_write(&path, text.as_bytes())?)
}

/// Tells what is unusual about the robots.
pub fn tell_notes(info: &RunInfo) {
    for model in &info.models {
        model.notes.iter().for_each(|note| eprintln!("note: {}: {note}", model.name));
    }
}

/// Everything about the run that its rows share.
pub fn describe(root: &Root, live: bool, loaded: &Loaded, opened: &Opened) -> Result<RunInfo, Fail> {
    let command = std::env::args().skip(1).map(|word| quoted(&word));
    let models = loaded.robots.iter().map(|robot| {
        let provenance = robot.description.provenance.clone().unwrap_or_default();
        ModelInfo {
            name: robot.name.clone(),
            hash: robot.hash.clone(),
            origin: robot.origin,
            licence: provenance.licence,
            source: provenance.source,
            nq: robot.states.nq as u64,
            nv: robot.states.nv as u64,
            bodies: robot.states.bodies as u64,
            depth: robot.depth as u64,
            notes: robot.model.warnings.iter().map(ToString::to_string).collect(),
        }
    });
    let mut conventions = featherbench_bench::conventions::read(&root.conventions())?;
    conventions.retain(|row| opened.infos.iter().any(|engine| engine.name == row.engine));
    Ok(RunInfo {
        suite: loaded.name.clone(),
        suite_hash: loaded.hash.clone(),
        command: ["cargo run --release --".to_owned()].into_iter().chain(command).collect::<Vec<_>>().join(" "),
        seed: loaded.suite.seed,
        live,
        engines: opened.infos.clone(),
        models: models.collect(),
        conventions,
        ..provenance::collect(root.path())
    })
}

pub fn missing_engine(name: &str, reason: &str) -> ::featherbench_results::Expectation {
    ::featherbench_results::Expectation {
        what: format!("engine {name} answers"),
        expected: 1,
        found: 0,
        verdict: Verdict::Fail,
        reason: reason.to_owned(),
    }
}
