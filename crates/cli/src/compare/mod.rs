//! `featherbench compare`: do the engines read a robot's file alike, and if not, where and why?

pub mod compared;
pub mod fix;
pub mod forms;
pub mod other_file;
pub mod outcome;
pub mod round_trip;
pub mod table;
pub mod timeout;

use crate::args::CompareArgs;
use crate::compare::other_file::OtherFile;
use crate::compare::timeout::Patient;
use crate::fail::Fail;
use crate::message::{say, tell};
use crate::oracles;
use crate::oracles::engines::{self, Asked};
use crate::progress::Bar;
use crate::root::Root;
use crate::run::About;
use crate::{message, report, run};
use ::featherbench_results::{Verdict, atomic_write};
use featherbench_bench::run::{Opening, Run};
use featherbench_bench::{
    Cell, Context, DescribedEngine, Engine, Engines, FileBase, FileContent, FileFormat, OWN, Robot, RobotFile, RobotSource, hash,
    provenance,
};
use featherbench_comparison::import::{answers, overflow, singular};
use featherbench_comparison::{Agreement, Import};
use featherbench_engines::Limits;
use featherbench_report::numbers::count;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

/// States per robot, besides the keyframes of its file: one of each case.
const STATES: usize = featherbench_robots::StateBatch::HEAD;
/// The name in the place of a suite's.
const NAME: &str = "compare";
/// Seed of the states.
const SEED: u64 = 1;
/// A robot with more degrees of freedom is asked on the neutral route for what the comparison shows, and for nothing else.
const LARGE: usize = 500;

/// Compares robots by both routes and reports.
pub fn compare(root: &Root, args: &CompareArgs) -> Result<(), Fail> {
    let start = Instant::now();
    if args.round_trip && args.files.len() > 1 {
        return Err(Fail::input("--round-trip: give one file".into()));
    }
    let described = oracles::described(root)?;
    // Bad files are told before anything is installed or started, and the others are compared.
    let mut bad: Vec<Fail> = Vec::new();
    let files: Vec<Source> = args.files.iter().filter_map(|path| kept(Source::open(path, args.floating), &mut bad)).collect();
    if files.is_empty() {
        return Err(ended(&bad));
    }
    let engines = engines(root, args, &described, &files)?;
    let gates = root.read_gates()?;
    let hash = hashes(&files);
    let mut robots: Vec<Robot> = Vec::new();
    for engine in described.iter().filter(|engine| engines.contains(&engine.name)) {
        oracles::install_alone(root, engine, &described)?;
    }
    tell!("starting {} …", engines.join(", "));
    let limits = Limits { answer: Duration::from_secs(args.timeout), ..Limits::default() };
    let mut opened = engines::open(root, &Asked::live(root, &engines, limits))?;
    if let Some(missing) = opened.missing(&engines).first() {
        let message = format!("{} does not answer: {}", missing.name, missing.reason);
        return Err(Fail::Missing { message, advice: "look at `featherbench oracles status`, or leave it out with --engines".into() });
    }
    let patient = |engine: Box<dyn Engine>| -> Box<dyn Engine> {
        if engine.identity().name == OWN { engine } else { Box::new(Patient::new(engine)) }
    };
    opened.engines = opened.engines.into_iter().map(patient).collect();
    let mut remarks: Vec<(String, Vec<String>)> = Vec::new();
    for file in files {
        let read = match file {
            Source::Unread(file) => {
                let reference = file.format.reference();
                compiled(file, opened.engines.iter().find(|engine| engine.identity().name == reference).map(AsRef::as_ref))
            }
            Source::Read(read) => Ok(*read),
        };
        let Some((robot, about)) = kept(read, &mut bad) else { continue };
        let twice = robots.iter().filter(|known| known.name == robot.name || known.name.starts_with(&format!("{} (", robot.name)));
        let before = twice.count();
        let name = if before == 0 { robot.name.clone() } else { format!("{} ({})", robot.name, before + 1) };
        if let (true, Some(file)) = (before > 0, &robot.file) {
            tell!("note: '{name}' is {}", file.path.display());
        }
        remarks.push((name.clone(), about));
        robots.push(Robot { name, ..robot });
    }
    if robots.is_empty() {
        return Err(ended(&bad));
    }
    let started = SystemTime::now();
    let folder = run::folder(root, args.out.as_deref(), NAME, started)?;
    let mut others = other_files(&robots, args.one);
    if args.round_trip {
        others = round_trip::written(&robots, &opened.engines, &round_trip::beside(&folder))?;
    }
    let pairs: Vec<(String, String)> = others.iter().map(|other| (other.identity().name.clone(), other.of.clone())).collect();
    opened.engines.extend(others.into_iter().map(|other| Box::new(other) as Box<dyn Engine>));
    // Another file is asked about the robot of the first alone, and the robot of another file is compared once.
    let asked = |engine: &str, robot: &str| pairs.iter().all(|(other, of)| other != engine || of == robot);

    let about = About { suite: NAME, hash: &hash, seed: SEED, live: true, robots: &robots };
    let info = run::describe(root, provenance::collect(root.path()), &about, &opened, started)?;
    run::tell_notes(&info);
    let mut run = Run::open(&folder, Opening::New, info)?;
    if args.round_trip {
        round_trip::keep(&folder)?;
    }
    run.info.seconds.insert("setup".into(), start.elapsed().as_secs_f64());
    let context = Context { robots: &robots, engines: &opened.engines, gates: &gates, seed: SEED };
    let shown = ["readback", "id", "bias", "mass_matrix_probe"];
    let keep = |cell: &Cell| {
        let large = robots.iter().any(|robot| robot.name == cell.robot && robot.states.nv > LARGE);
        let another = pairs.iter().any(|(other, _)| *other == cell.engine);
        let shown = !large || shown.contains(&cell.quantity.as_str());
        asked(&cell.engine, &cell.robot) && (cell.study != "agreement" || shown && !another)
    };
    let records = run.conduct(&[Box::new(Import), Box::new(Agreement)], &context, &keep, &Bar::new())?;
    let of_robot = |robot: &Robot| -> Vec<&dyn Engine> {
        opened.engines.iter().map(AsRef::as_ref).filter(|engine| asked(&engine.identity().name, &robot.name)).collect()
    };
    let conditions = |robot| outcome::conditions(robot, &of_robot(robot), &records, args.strict);
    run.info.expected = robots.iter().flat_map(conditions).collect();
    run.info.drawings = run::drawings(&run.info, &records, &robots);
    run.info.seconds.insert("total".into(), start.elapsed().as_secs_f64());
    run.write(&records, &featherbench_registry::dictionary(&records))?;
    let page = report::render(&folder, &run.info, &records)?;
    let info = &run.info;
    let unmet: Vec<_> = info.expected.iter().filter(|condition| condition.verdict != Verdict::Pass).collect();
    let found = forms::found(&robots, &records, args.strict);
    if let Some(path) = &args.junit {
        atomic_write(path, forms::junit(info, &found).as_bytes())?;
    }
    if let Some(path) = &args.sarif {
        atomic_write(path, format!("{:#}\n", forms::sarif(&found)).as_bytes())?;
    }
    if args.json {
        let told: Vec<(&Robot, &[String])> = robots.iter().zip(remarks.iter().map(|(_, remarks)| remarks.as_slice())).collect();
        say!("{:#}", compared::json(info, &page, &told, &records, &bad));
    } else {
        message::text(&table::answers(&answers(&records)));
        for (robot, (_, remarks)) in robots.iter().zip(&remarks) {
            message::text(&table::of(robot, remarks, &of_robot(robot), &records, args.explain));
        }
        if args.annotations {
            message::text(&forms::annotations(&found));
        }
        say!("report: {}", page.display());
        for condition in &unmet {
            say!("differs: {}: {}", condition.what, condition.reason);
        }
    }
    if !bad.is_empty() {
        return Err(ended(&bad));
    }
    if let Some(copy) = &args.fix
        && fix::write(&robots, &records, copy)?
    {
        say!("\nthe copy:");
        drop(opened);
        let again = CompareArgs { files: vec![copy.clone()], fix: None, out: Some(folder.join("mended")), ..args.clone() };
        return compare(root, &again);
    }
    if unmet.is_empty() {
        Ok(())
    } else {
        Err(Fail::Gate(format!("the engines differ: {} of {} questions have the answer no", unmet.len(), info.expected.len())))
    }
}

/// The files that hold the first one's robot once more: all of them if `one`, else the second of two if its robot looks like the first one's.
fn other_files(robots: &[Robot], one: bool) -> Vec<OtherFile> {
    let Some((first, rest)) = robots.split_first() else { return Vec::new() };
    let alike = |other: &&Robot| one || rest.len() == 1 && other_file::are_one(&first.description, &other.description);
    rest.iter().filter(alike).filter_map(|other| OtherFile::new(first, other)).collect()
}

/// The good ones; what is wrong with a file is told at once and kept for the end.
fn kept<T>(result: Result<T, Fail>, bad: &mut Vec<Fail>) -> Option<T> {
    match result {
        Ok(good) => Some(good),
        Err(fail) => {
            tell!("not compared: {fail}");
            bad.push(fail);
            None
        }
    }
}

/// The end of a comparison of which some files, or all, are bad: what is wrong with each was told before.
fn ended(bad: &[Fail]) -> Fail {
    Fail::input(format!("{} cannot be compared", count(bad.len(), "file")))
}

/// A robot with the remarks on its file.
type Read = (Robot, Vec<String>);

/// A robot on its way to being compared.
enum Source {
    /// Its reference reading is an engine's.
    Unread(RobotFile),
    /// Our own reading of a URDF needs no engine.
    Read(Box<Read>),
}

impl Source {
    fn open(path: &Path, floating: bool) -> Result<Self, Fail> {
        let content = FileContent::recognised(path)?;
        Ok(match content.format {
            FileFormat::Urdf => {
                let base = if floating { FileBase::Free } else { FileBase::Fixed };
                Self::Read(Box::new(read(RobotSource::urdf(&content, base)?)?))
            }
            // The others say themselves what floats.
            FileFormat::Mjcf | FileFormat::Sdf | FileFormat::Usd => Self::Unread(content.file(FileBase::Fixed)?),
        })
    }

    fn format(&self) -> FileFormat {
        match self {
            Self::Unread(file) => file.format,
            Self::Read(_) => FileFormat::Urdf,
        }
    }

    fn hash(&self) -> &str {
        match self {
            Self::Unread(file) => &file.hash,
            Self::Read(read) => &read.0.hash,
        }
    }
}

/// The engines that are asked. By default they are those that read one of the formats. Of those that have an environment of their own, one is
/// left out that is not there, if another one reads the format as well as the reference.
fn engines(root: &Root, args: &CompareArgs, described: &Engines, files: &[Source]) -> Result<Vec<String>, Fail> {
    let readers = described.names(|engine| !engine.reads.is_empty() || engine.writes);
    let Some(named) = &args.engines else {
        let formats: BTreeSet<FileFormat> = files.iter().map(Source::format).collect();
        let asked = |engine: &&DescribedEngine| {
            if args.round_trip
                && (engine.writes || engine.name == FileFormat::Usd.reference() || engine.name == FileFormat::Mjcf.reference())
            {
                return true;
            }
            formats.iter().any(|format| {
                let others = || described.iter().filter(|other| other.reads.contains(format) && other.name != format.reference());
                let at_hand = |other: &DescribedEngine| oracles::is_at_hand(root, other, described);
                engine.name == format.reference() || engine.reads.contains(format) && (at_hand(engine) || !others().any(at_hand))
            })
        };
        return Ok(described.iter().filter(asked).map(|engine| engine.name.clone()).collect());
    };
    match named.iter().find(|name| !readers.contains(&name.as_str())) {
        Some(unknown) => {
            let near = featherbench_bench::did_you_mean(unknown, readers.iter().copied());
            Err(Fail::input(format!("--engines: there is no '{unknown}'{near}; choose from {}", readers.join(", "))))
        }
        None => Ok(named.clone()),
    }
}

fn hashes(files: &[Source]) -> String {
    hash::of_parts(&files.iter().map(|file| file.hash().as_bytes()).collect::<Vec<_>>())
}

/// The reference reading of a file that is no URDF.
fn compiled(file: RobotFile, reference: Option<&dyn Engine>) -> Result<Read, Fail> {
    let reference = reference.ok_or_else(|| {
        let (path, format) = (file.path.display(), file.format);
        Fail::input(format!("{path}: {} is the reference of {} files; do not leave it out of --engines", format.reference(), format.name()))
    })?;
    read(RobotSource::compiled(file, reference)?)
}

/// A robot at its states, with the remarks on its file.
fn read(source: RobotSource) -> Result<Read, Fail> {
    let path = source.file.as_ref().map(|file| file.path.display().to_string()).unwrap_or_default();
    let malformed = |error: &dyn std::error::Error| Fail::input(format!("{path}: {error}"));
    if let Some(what) = overflow(&source.description) {
        return Err(Fail::input(format!("{path}: {what}")));
    }
    let robot = Robot::new(&source.description, "file", source.origin, STATES, SEED).map_err(|error| malformed(&error))?;
    let remarks = source.remarks.iter().cloned().chain(singular(&robot)).collect();
    Ok((robot.with_source(&source, SEED).map_err(|error| malformed(&error))?, remarks))
}
