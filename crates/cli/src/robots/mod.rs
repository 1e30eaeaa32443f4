//! The robots of a suite.

pub mod generate;
pub mod identify;
pub mod residuals;
mod sections;
pub mod uncertainty;

use crate::fail::Fail;
use crate::message::tell;
use crate::oracles;
use crate::robots::sections::{Taker, heed};
use crate::root::Root;
use ::featherbench_results::ModelOrigin;
use featherbench_bench::{FileBase, FileContent, FileFormat, Robot, RobotEntry, RobotSource, Suite, did_you_mean};
use featherbench_engines::{Limits, Oracle};
use featherbench_formats::urdf::{Note, Options, UrdfProblem};
use featherbench_model::Description;
use featherbench_robots::{Family, StateBatch};
use std::collections::HashSet;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// A suite with its file's hash and its robots.
pub struct Loaded {
    pub name: String,
    pub suite: Suite,
    pub hash: String,
    pub robots: Vec<Robot>,
    /// Whether it draws the number of robots that its file says.
    pub own_size: bool,
}

/// Whether a run with this `--size` draws the number of robots that the suite's file says: `ci/counts.csv` is about such a run.
pub fn is_own_size(suite: &Suite, size: Option<NonZeroUsize>) -> bool {
    size.is_none_or(|size| suite.draw.as_ref().is_some_and(|draw| draw.size == size.get()))
}

/// Reads a suite by name or path, and its robots; another seed than its own draws other states, another size more or fewer robots.
pub fn load(root: &Root, suite: &str, live: bool, seed: Option<u64>, size: Option<NonZeroUsize>) -> Result<Loaded, Fail> {
    let path = suite_path(root, suite)?;
    let (mut parsed, mut hash) = Suite::read(&path)?;
    parsed.seed = seed.unwrap_or(parsed.seed);
    let own_size = is_own_size(&parsed, size);
    if let Some(size) = size {
        parsed = parsed.with_size(size.get())?;
        hash = featherbench_bench::hash::of_parts(&[hash.as_bytes(), &size.get().to_le_bytes()]);
    }
    let drawn: Vec<RobotEntry> = parsed.draw.iter().flat_map(|draw| draw.robots(parsed.seed)).collect();
    parsed.robots.extend(drawn);
    let states = parsed.states;
    let mut files = Files { root, live, compiler: None };
    let mut robots: Vec<Robot> = Vec::with_capacity(parsed.robots.len());
    let mut names = HashSet::new();
    let left_out = parsed.robots.iter().filter(|entry| entry.only_live && !live).count();
    if left_out > 0 {
        tell!("note: {left_out} of the suite's robots need --live and are left out");
    }
    for entry in parsed.robots.iter().filter(|entry| live || !entry.only_live) {
        for (base, named) in entry.bases() {
            let source = files.describe(entry, base)?;
            let description = &source.description;
            let bad = |error: &dyn std::error::Error| Fail::input(format!("{}: robot '{}': {error}", path.display(), description.name));
            let states = entry.states.unwrap_or(states);
            let mut robot = Robot::new(description, &entry.family, source.origin, states, parsed.seed).map_err(|error| bad(&error))?;
            if entry.reach.is_some() || entry.speed.is_some() {
                let (reach, speed) = (entry.reach.unwrap_or(std::f64::consts::PI), entry.speed.unwrap_or(1.0));
                let drawn = StateBatch::narrow(&robot.model, states, parsed.seed, reach, speed);
                robot = robot.at(drawn);
            }
            robot = robot.with_source(&source, parsed.seed).map_err(|error| bad(&error))?;
            let name = entry.name.clone().unwrap_or(robot.name);
            robot.name = if named { format!("{name}-free") } else { name };
            robot.studies.clone_from(&entry.studies);
            robot.axes.clone_from(&entry.axes);
            if !names.insert(robot.name.clone()) {
                return Err(Fail::input(format!("{}: two robots are named '{}'", path.display(), robot.name)));
            }
            let residuals = parsed.studies.iter().any(|study| study == "residuals" && robot.takes(study));
            heed(&robot.description, &robot.name, Taker::Suite { residuals })?;
            robots.push(robot);
        }
    }
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Loaded { name, suite: parsed, hash, robots, own_size })
}

/// The file of a suite that is given by name or path.
pub fn suite_path(root: &Root, suite: &str) -> Result<PathBuf, Fail> {
    if suite.ends_with(".toml") {
        return Ok(PathBuf::from(suite));
    }
    let path = root.suites().join(format!("{suite}.toml"));
    if path.is_file() {
        return Ok(path);
    }
    let names = suites(root)?;
    let near = did_you_mean(suite, names.iter().map(String::as_str));
    Err(Fail::input(format!("there is no suite '{suite}'{near}; datasets/suites has {}", names.join(", "))))
}

/// The names of the suites, in alphabetical order.
pub fn suites(root: &Root) -> Result<Vec<String>, Fail> {
    names(&root.suites(), "toml")
}

/// The names of the committed robots, in alphabetical order.
pub fn models(root: &Root) -> Result<Vec<String>, Fail> {
    names(&root.models(), "json")
}

/// The names of the files of a folder that have an ending, without it.
fn names(folder: &Path, ending: &str) -> Result<Vec<String>, Fail> {
    let failed = |error: std::io::Error| Fail::input(format!("{}: {error}", folder.display()));
    let paths = std::fs::read_dir(folder).map_err(failed)?.map(|entry| entry.map(|entry| entry.path()));
    let paths = paths.collect::<Result<Vec<_>, _>>().map_err(failed)?;
    let of = |path: &PathBuf| {
        path.extension().is_some_and(|found| found == ending).then(|| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()))?
    };
    let mut names: Vec<String> = paths.iter().filter_map(of).collect();
    names.sort();
    Ok(names)
}

/// A description or URDF file, a robot of datasets/models, or a family of generated robots.
pub fn named(root: impl Fn() -> Result<Root, Fail>, name: &str) -> Result<Description, Fail> {
    let path = Path::new(name);
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("json") => return read_model(path),
        Some("urdf") => {
            let (description, notes) = import(path, &Options::default())?;
            notes.iter().for_each(|note| tell!("note: {name}: {note}"));
            return Ok(description);
        }
        _ => {}
    }
    let known = root().map(|root| root.models().join(format!("{name}.json"))).ok().filter(|path| path.is_file());
    if let Some(path) = known {
        return read_model(&path);
    }
    let generated = Family::parse(name).and_then(|family| family.generate());
    generated.map_err(|error| {
        let committed = root().and_then(|root| models(&root)).unwrap_or_default();
        let near = did_you_mean(name, committed.iter().map(String::as_str).chain(Family::NAMES));
        Fail::input(format!(
            "{name}: no file that ends in .json or .urdf, no robot of datasets/models, and no family of generated robots{near}: {error}"
        ))
    })
}

/// Where the robots of a suite come from.
struct Files<'a> {
    root: &'a Root,
    live: bool,
    /// MuJoCo, once a robot has asked for it.
    compiler: Option<Oracle>,
}

impl Files<'_> {
    fn describe(&mut self, entry: &RobotEntry, base: FileBase) -> Result<RobotSource, Fail> {
        if let Some(name) = &entry.model {
            let description = read_model(&self.root.models().join(format!("{name}.json")))?;
            let origin = if description.provenance.is_some() { ModelOrigin::Robot } else { ModelOrigin::Generated };
            return Ok(RobotSource::new(description, origin));
        }
        if let Some(spec) = &entry.generate {
            let generated = Family::parse(spec).and_then(|family| family.generate());
            return generated
                .map(|description| RobotSource::new(description, ModelOrigin::Generated))
                .map_err(|error| Fail::input(error.to_string()));
        }
        let (file, folder, format) = match &entry.mjcf {
            Some(file) => (file.as_str(), self.live.then(|| self.root.packages()), FileFormat::Mjcf),
            None => {
                let folder = self.live.then(|| oracles::robots(self.root)).flatten();
                (entry.urdf.as_deref().unwrap_or_default(), folder, FileFormat::Urdf)
            }
        };
        let folder = folder.filter(|folder| folder.is_dir()).ok_or_else(|| {
            let message = format!("the suite takes {file} from the packages of robots, which only live runs have");
            Fail::Missing { message, advice: "run it with --live, after `featherbench oracles install`".into() }
        })?;
        let content = FileContent::read(&folder.join(file), format)?;
        Ok(match format {
            FileFormat::Urdf => RobotSource::urdf(&content, base)?,
            FileFormat::Mjcf | FileFormat::Sdf | FileFormat::Usd => RobotSource::compiled(content.file(base)?, self.compiler()?)?,
        })
    }

    /// MuJoCo, started when the first MJCF file is read.
    fn compiler(&mut self) -> Result<&Oracle, Fail> {
        if self.compiler.is_none() {
            if oracles::python(self.root).is_none() {
                oracles::install(self.root)?;
            }
            self.compiler = Some(reference(self.root, FileFormat::Mjcf)?);
        }
        self.compiler.as_ref().ok_or_else(|| Fail::input("MuJoCo was not started".into()))
    }
}

/// The engine whose import of a format is the reference.
pub fn reference(root: &Root, format: FileFormat) -> Result<Oracle, Fail> {
    let described = oracles::described(root)?;
    let engine = described.get(format.reference()).map_err(Fail::input)?;
    oracles::install_alone(root, engine, &described)?;
    oracles::start(root, engine, Limits::default())
}

/// Reads a description file.
pub fn read_model(path: &Path) -> Result<Description, Fail> {
    featherbench_formats::neutral::read(path).map_err(|error| Fail::input(error.to_string()))
}

/// Reads a URDF file, with notes on what was left out.
pub fn import(path: &Path, options: &Options) -> Result<(Description, Vec<Note>), Fail> {
    featherbench_formats::urdf::read(path, options).map_err(|error| {
        // Other readers of the same file have no such options.
        let option = match *error.problem {
            UrdfProblem::Massless { .. } => "; --allow-massless imports it all the same",
            UrdfProblem::Mimic { .. } => "; --independent-mimics frees it",
            _ => "",
        };
        Fail::input(format!("{error}{option}"))
    })
}
