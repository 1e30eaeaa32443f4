//! The robots of a suite.

use crate::fail::Fail;
use crate::oracles;
use crate::root::Root;
use ::record::ModelOrigin;
use formats::urdf::{Base, Note, Options};
use harness::{Problem, ProblemEntry, Suite};
use model::generate::Family;
use model::{Description, StateBatch};
use std::path::{Path, PathBuf};

/// A suite with its file's hash and its robots.
pub struct Loaded {
    pub name: String,
    pub suite: Suite,
    pub hash: String,
    pub problems: Vec<Problem>,
}

/// Reads a suite by name or path, and its robots; another seed than its own draws other states.
pub fn load(root: &Root, suite: &str, live: bool, seed: Option<u64>) -> Result<Loaded, Fail> {
    let path = if suite.ends_with(".toml") { PathBuf::from(suite) } else { root.suites().join(format!("{suite}.toml")) };
    let (mut parsed, hash) = Suite::read(&path)?;
    parsed.seed = seed.unwrap_or(parsed.seed);
    let states = parsed.agreement.as_ref().map_or(1, |agreement| agreement.states);
    let mut problems: Vec<Problem> = Vec::with_capacity(parsed.problem.len());
    for entry in &parsed.problem {
        let (description, origin) = describe(root, entry, live)?;
        let bad = |error: &dyn std::error::Error| Fail::input(format!("{}: robot '{}': {error}", path.display(), description.name));
        let states = entry.states.unwrap_or(states);
        let mut problem = Problem::new(&description, &entry.family, origin, states, parsed.seed).map_err(|error| bad(&error))?;
        if entry.reach.is_some() || entry.speed.is_some() {
            let (reach, speed) = (entry.reach.unwrap_or(std::f64::consts::PI), entry.speed.unwrap_or(1.0));
            let drawn = StateBatch::narrow(&problem.model, states, parsed.seed, reach, speed);
            problem = problem.at(drawn);
        }
        problem.name = entry.name.clone().unwrap_or(problem.name);
        problem.studies.clone_from(&entry.studies);
        if problems.iter().any(|known| known.name == problem.name) {
            return Err(Fail::input(format!("{}: two robots are named '{}'", path.display(), problem.name)));
        }
        problems.push(problem);
    }
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Loaded { name, suite: parsed, hash, problems })
}

fn describe(root: &Root, entry: &ProblemEntry, live: bool) -> Result<(Description, ModelOrigin), Fail> {
    if let Some(name) = &entry.model {
        let description = read_model(&root.models().join(format!("{name}.json")))?;
        let origin = if description.provenance.is_some() { ModelOrigin::Robot } else { ModelOrigin::Generated };
        return Ok((description, origin));
    }
    if let Some(spec) = &entry.generate {
        let generated = Family::parse(spec).and_then(|family| family.generate());
        return generated.map(|description| (description, ModelOrigin::Generated)).map_err(|error| Fail::input(error.to_string()));
    }
    let file = entry.urdf.as_deref().unwrap_or_default();
    let folder = live.then(|| oracles::robots(root)).flatten().ok_or_else(|| {
        let message = format!("the suite takes {file} from the package of robots, which only live runs have");
        Fail::Missing { message, advice: "run it with --live, after `featherbench oracles install`".into() }
    })?;
    let base = if entry.floating { Base::Floating } else { Base::Fixed };
    // As engines read such files by default: mimics move on their own, and a body without mass is known by its warning.
    let options = Options { base, independent_mimics: true, allow_massless: true };
    let (mut description, _) = import(&folder.join(file), &options)?;
    // One package holds several variants of one robot's name: the file's name tells them apart.
    description.name = Path::new(file).file_stem().map_or(description.name, |stem| stem.to_string_lossy().into_owned());
    Ok((description, ModelOrigin::Robot))
}

/// Reads a description file.
pub fn read_model(path: &Path) -> Result<Description, Fail> {
    formats::neutral::read(path).map_err(|error| Fail::input(error.to_string()))
}

/// Reads a URDF file, with notes on what was left out.
pub fn import(path: &Path, options: &Options) -> Result<(Description, Vec<Note>), Fail> {
    formats::urdf::read(path, options).map_err(|error| Fail::input(error.to_string()))
}
