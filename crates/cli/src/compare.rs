//! `featherbench compare`: do the engines read a robot's file alike, and if not, where and why?

use crate::args::{CompareArgs, RunArgs};
use crate::fail::Fail;
use crate::oracles::ENGINES;
use crate::problems::{self, Loaded};
use crate::root::Root;
use crate::{report, robot_file, run, subjects, table};
use ::record::{Expectation, ModelOrigin, Record, Verdict};
use harness::{AgreementEntry, Context, FileFormat, Gates, Problem, RobotFile, Subject, Suite, hash, measure::worst};
use std::time::{Instant, SystemTime};
use studies::{Agreement, Reading, reading::REPLAYED};

/// States per robot, besides the keyframes of its file: one of each case.
const STATES: usize = model::StateBatch::HEAD;
/// Seed of the states.
const SEED: u64 = 1;

/// Compares robots by both routes and reports.
pub fn compare(root: &Root, args: &CompareArgs) -> Result<(), Fail> {
    let start = Instant::now();
    let engines = engines(args)?;
    // Bad files are told before anything is installed or started.
    let files = args.files.iter().map(|file| robot_file::open(file, args.floating)).collect::<Result<Vec<_>, _>>()?;
    let gates = Gates::read(&root.gates())?;
    let mut loaded = Loaded { name: "compare".into(), suite: suite(engines), hash: hashes(&files), problems: Vec::new() };
    eprintln!("starting {} …", loaded.suite.agreement.iter().flat_map(|entry| entry.engines.clone()).collect::<Vec<_>>().join(", "));
    let live = RunArgs { live: true, ..RunArgs::default_suite() };
    let subjects = subjects::open(root, &live, &loaded)?;
    if let Some(missing) = subjects.missing(&loaded).first() {
        let message = format!("{} does not answer: {}", missing.name, missing.reason);
        return Err(Fail::Missing { message, advice: "look at `featherbench oracles status`, or leave it out with --engines".into() });
    }
    for file in files {
        let problem = problem(file, &subjects.subjects)?;
        let twice =
            loaded.problems.iter().filter(|known| known.name == problem.name || known.name.starts_with(&format!("{} (", problem.name)));
        let count = twice.count();
        let name = if count == 0 { problem.name.clone() } else { format!("{} ({})", problem.name, count + 1) };
        loaded.problems.push(Problem { name, ..problem });
    }

    let started = SystemTime::now();
    let (folder, id) = run::folder(root, args.out.as_deref(), false, &loaded.name, started)?;
    let mut info = run::describe(root, true, &loaded, &subjects)?;
    info.run = id;
    run::tell_notes(&info);
    info.started = humantime::format_rfc3339_seconds(started).to_string();
    info.seconds.insert("setup".into(), start.elapsed().as_secs_f64());
    let context = Context { problems: &loaded.problems, subjects: &subjects.subjects, gates: &gates, seed: SEED };
    let records = run::conduct(&[Box::new(Reading), Box::new(Agreement)], &context, &folder, &|_| true, &mut info)?;
    info.expected = loaded.problems.iter().flat_map(|problem| conditions(problem, &subjects.subjects, &records)).collect();
    info.seconds.insert("total".into(), start.elapsed().as_secs_f64());
    ::record::write_run(&folder, &info, &records)?;
    let page = report::render(&folder, &info, &records)?;
    for problem in &loaded.problems {
        print!("{}", table::of(problem, &subjects.subjects, &records));
    }
    println!("report: {}", page.display());
    let unmet = info.expected.iter().filter(|condition| condition.verdict != Verdict::Pass).count();
    if unmet == 0 {
        Ok(())
    } else {
        Err(Fail::Gate(format!("the engines differ: {unmet} of {} questions have the answer no", info.expected.len())))
    }
}

fn engines(args: &CompareArgs) -> Result<Vec<String>, Fail> {
    let all = || ENGINES.map(str::to_owned).to_vec();
    let engines = args.engines.clone().unwrap_or_else(all);
    match engines.iter().find(|name| !ENGINES.contains(&name.as_str())) {
        Some(unknown) => Err(Fail::input(format!("--engines: there is no '{unknown}'; choose from {}", ENGINES.join(", ")))),
        None => Ok(engines),
    }
}

/// The suite that a comparison is.
fn suite(engines: Vec<String>) -> Suite {
    Suite {
        about: "robots' files through each engine's parser".into(),
        seed: SEED,
        agreement: Some(AgreementEntry { states: STATES, engines }),
        reading: true,
        ..Suite::default()
    }
}

fn hashes(files: &[RobotFile]) -> String {
    hash::of_parts(&files.iter().map(|file| file.hash.as_bytes()).collect::<Vec<_>>())
}

/// The reference reading of a file, at its states.
fn problem(file: RobotFile, subjects: &[Box<dyn Subject>]) -> Result<Problem, Fail> {
    let (description, warnings, keyframes) = match file.format {
        FileFormat::Urdf => {
            let (description, warnings) = problems::read_urdf(&file)?;
            (description, warnings, Vec::new())
        }
        FileFormat::Mjcf => {
            let compiler = subjects.iter().find(|subject| subject.identity().name == "mujoco");
            let message =
                || format!("{}: MuJoCo's compiler is the reference of MJCF files; do not leave it out of --engines", file.path.display());
            let reading = problems::read_mjcf(&file, compiler.ok_or_else(|| Fail::input(message()))?.as_ref())?;
            (reading.description, Vec::new(), reading.keyframes)
        }
    };
    let malformed = |error: &dyn std::error::Error| Fail::input(format!("{}: {error}", file.path.display()));
    let problem = Problem::new(&description, "file", ModelOrigin::Robot, STATES, SEED).map_err(|error| malformed(&error))?;
    let problem = problem.with_warnings(warnings).with_keyframes(&keyframes, SEED).map_err(|error| malformed(&error))?;
    Ok(problem.from_file(file))
}

/// What must hold for the engines to be called alike on a robot.
fn conditions(problem: &Problem, subjects: &[Box<dyn Subject>], records: &[Record]) -> Vec<Expectation> {
    let engines = subjects.iter().map(|subject| subject.identity().name.as_str()).filter(|name| *name != "native");
    engines.flat_map(|engine| of_engine(&problem.name, engine, records)).collect()
}

fn of_engine(robot: &str, engine: &str, records: &[Record]) -> [Expectation; 3] {
    let rows: Vec<&Record> = records.iter().filter(|row| row.model == robot && row.engine == engine).collect();
    let read = rows.iter().find(|row| row.study == "reading" && row.metric == "differences");
    let left = rows.iter().find(|row| row.study == "reading" && row.metric == "unexplained");
    let condition = |what: String, row: Option<&&Record>| {
        let reason = row.map_or("there is no answer".to_owned(), |row| row.reason.clone());
        let found = row.and_then(|row| row.value).map_or(1, |value| value as u64);
        let good = found == 0;
        let reason = if good {
            String::new()
        } else if reason.is_empty() {
            format!("found {found}")
        } else {
            reason
        };
        Expectation { what, expected: 0, found, verdict: if good { Verdict::Pass } else { Verdict::Fail }, reason }
    };
    let far = neutral(&rows).filter(|error| error.is_nan() || *error > REPLAYED);
    let verdict = if far.is_some() { Verdict::Fail } else { Verdict::Pass };
    [
        condition(format!("differences in what {engine} reads of {robot}"), read),
        condition(format!("sub-trees of {robot} that this does not explain in {engine}'s answers"), left),
        Expectation {
            what: format!("{engine} computes otherwise from the neutral model of {robot}"),
            expected: 0,
            found: u64::from(far.is_some()),
            verdict,
            reason: far.map_or_else(String::new, |error| format!("off by {error:e}")),
        },
    ]
}

/// The worst error of inverse dynamics, bias and mass matrix on the neutral route, by an engine's usual method.
pub fn neutral(rows: &[&Record]) -> Option<f64> {
    let usual = |row: &&&Record| {
        row.study == "agreement" && row.metric == "scaled" && ["id", "bias", "mass_matrix"].contains(&row.quantity.as_str())
    };
    rows.iter().filter(usual).filter_map(|row| row.value).reduce(worst)
}
