//! Installing the reference engines, and looking at them.

pub mod check;
pub mod compiled;
pub mod engines;
pub mod environment;
pub mod external;
pub mod interpreters;
pub mod native;
pub mod offers;
pub mod package;
pub mod record;

use crate::args::InstallArgs;
use crate::fail::Fail;
use crate::message::{say, tell};
use crate::oracles::compiled::Compiled;
use crate::oracles::environment::{Alone, Environment, pins};
use crate::progress::spinner;
use crate::root::Root;
use featherbench_bench::alone::{Measured, Question};
use featherbench_bench::{DescribedEngine, Engine, Engines, Identity, NoAnswer, OWN, Robot, Start};
use featherbench_engines::{Limits, Oracle, alone};
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// What the oracles share.
const SHARED: &str = "requirements.txt";
/// The packages of robots.
const ROBOTS: &str = "packages.txt";
/// What is said where the environment is missing.
const MISSING: &str = "the reference engines are not installed: run `featherbench oracles install`";

/// What is said where the environment cannot be made.
const MISSING_PYTHON: &str = "the engines need Python 3.11 or later with venv (Debian: python3 python3-venv) and a reachable package index; \
                              without them, `featherbench run` compares with the recorded answers";

/// The engines that `oracles/engines.toml` describes.
pub fn described(root: &Root) -> Result<Engines, Fail> {
    Ok(Engines::read(&root.described())?)
}

/// The environment's Python, or `None` when the engines are not installed in these versions.
pub fn python(root: &Root) -> Option<PathBuf> {
    let python = root.engines().join("venv/bin/python");
    let wanted = stamp(root).ok()?;
    let there = std::fs::read_to_string(root.engines().join("installed")).ok()?;
    (there == wanted && python.exists()).then_some(python)
}

/// Installs what is named: engines of this Python environment by all of it, the others one by one. Without a name, the environment.
pub fn install_named(root: &Root, args: &InstallArgs) -> Result<(), Fail> {
    let engines = described(root)?;
    let named = |name: &String| engines.get(name).map_err(Fail::input);
    let mut named: Vec<&DescribedEngine> = args.engines.iter().map(named).collect::<Result<_, _>>()?;
    if args.native {
        named.extend(engines.iter().filter(|engine| engine.is_native()));
    }
    for engine in &named {
        let compiled = match &engine.start {
            Start::Cargo { folder, program } => Compiled::program(root, engine, folder, program),
            Start::CargoLibrary { folder, library } => Compiled::library(root, engine, folder, library),
            Start::PythonAlone { module } => {
                tell!("{} is installed: {}", engine.name, Alone::new(root, engine, &engines, module).install()?.display());
                continue;
            }
            Start::Python { .. } | Start::Native(_) => continue,
        };
        tell!("{} is built: {}", engine.name, compiled.install()?.display());
    }
    let (native, others): (Vec<&DescribedEngine>, Vec<_>) = named.into_iter().partition(|engine| engine.is_native());
    if !native.is_empty() || others.is_empty() || others.iter().any(|engine| engine.is_python()) {
        install(root)?;
    }
    if native.is_empty() { Ok(()) } else { native::install(root, &engines, &native) }
}

/// Makes the environment of an engine that has one of its own, unless it is there.
pub fn install_alone(root: &Root, engine: &DescribedEngine, engines: &Engines) -> Result<(), Fail> {
    let Start::PythonAlone { module } = &engine.start else { return Ok(()) };
    Alone::new(root, engine, engines, module).install().map(|_| ())
}

/// Whether an engine is in the shared environment, which is made for every run, or its own environment is there.
pub fn is_at_hand(root: &Root, engine: &DescribedEngine, engines: &Engines) -> bool {
    let Start::PythonAlone { module } = &engine.start else { return true };
    Alone::new(root, engine, engines, module).command().is_ok()
}

/// Makes the environment unless it is there; what was downloaded before a break is used again.
pub fn install(root: &Root) -> Result<PathBuf, Fail> {
    if let Some(python) = python(root) {
        tell!("the reference engines are installed in {}", root.engines().display());
        return Ok(python);
    }
    let folder = root.engines();
    let requirements = root.oracles().join(SHARED);
    let packages = root.oracles().join(ROBOTS);
    let pins = described(root)?.pins().into_iter().map(OsString::from);
    let engines: Vec<OsString> = pins.chain(["-r".into(), requirements.into_os_string()]).collect();
    let bar = spinner("installing the reference engines (about 1.6 GB) …");
    let environment = Environment::install(&bar, &folder.join("venv"), MISSING_PYTHON, &engines)?;
    let into = root.packages();
    environment.install_into(&into, &["--no-deps".into(), "-r".into(), packages.into_os_string()])?;
    let python = environment.python;
    bar.finish_and_clear();
    let stamp = stamp(root)?;
    ::featherbench_results::atomic_write(&folder.join("installed"), stamp.as_bytes())?;
    tell!("installed the reference engines in {}", folder.display());
    Ok(python)
}

/// What an installation is known by: the hash of what it was asked for, in any order and whatever the comments.
fn stamp(root: &Root) -> Result<String, Fail> {
    let mut environment = described(root)?.pins();
    environment.extend(pins(&root.oracles().join(SHARED))?);
    let mut robots = pins(&root.oracles().join(ROBOTS))?;
    let asked = [&mut environment, &mut robots].map(|asked| {
        asked.sort();
        asked.dedup();
        asked.join("\n")
    });
    Ok(featherbench_bench::hash::of_parts(&asked.each_ref().map(|asked| asked.as_bytes())))
}

/// Starts an engine's oracle, in the way that its description says. An engine that cargo builds is built if need be; the others must be
/// installed.
pub fn start(root: &Root, engine: &DescribedEngine, limits: Limits) -> Result<Oracle, Fail> {
    let missing = |message| Fail::Missing { message, advice: "look at `featherbench oracles status`".into() };
    match &engine.start {
        Start::Python { module } => {
            let command = python(root).ok_or_else(|| MISSING.to_owned()).and_then(|python| package::command(root, &python, module));
            command.and_then(|command| Oracle::start(command, limits)).map_err(missing)
        }
        Start::PythonAlone { module } => {
            let engines = described(root)?;
            let command = Alone::new(root, engine, &engines, module).command();
            command.and_then(|command| Oracle::start(command, limits)).map_err(missing)
        }
        Start::Cargo { folder, program } => Compiled::program(root, engine, folder, program).start(limits),
        Start::CargoLibrary { folder, library } => Compiled::library(root, engine, folder, library).start(limits),
        Start::Native(library) => native::start(root, engine, library, limits).map_err(missing),
    }
}

/// Evaluates reproductions of known deviations in the engines' environment.
pub fn reproducer(root: &Root, limits: Limits) -> featherbench_study::Reproduce {
    let command = python(root).ok_or_else(|| MISSING.to_owned()).and_then(|python| package::command(root, &python, "abilities.reproduce"));
    Arc::new(move |name, seeds| match &command {
        Ok(command) => featherbench_engines::reproduce(command, limits, name, seeds),
        Err(reason) => Err(NoAnswer::Failed(reason.clone())),
    })
}

/// Measures questions in processes of their own: ours by this program, one for each question; other engines by their oracles, one for each
/// robot.
pub fn measurer(root: &Root) -> Result<featherbench_bench::alone::Ask, Fail> {
    let program = std::env::current_exe().map_err(|error| Fail::input(format!("this program's path: {error}")))?;
    let (root, described) = (root.clone(), described(root)?);
    let last: Mutex<Option<Built>> = Mutex::new(None);
    Ok(Arc::new(move |question| {
        if question.engine == OWN {
            return alone::ask(&alone::command(&program), question);
        }
        let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.as_ref().is_none_or(|built| !built.is_for(question)) {
            // The process of the last robot ends before the next one begins.
            *last = None;
            *last = Some(Built::new(&root, &described, question));
        }
        last.as_ref().map_or_else(|| Err(NoAnswer::Failed("there is no oracle".into())), |built| built.measure(question))
    }))
}

/// An oracle with a robot, for the questions about it that follow each other.
struct Built {
    /// The question that it was built for.
    first: Question,
    /// The oracle, its robot and the seconds from the description to the model; or why there is none.
    state: Result<(Oracle, Robot, f64), NoAnswer>,
}

impl Built {
    /// Starts the oracle of a question and lets it build the robot.
    fn new(root: &Root, described: &Engines, question: &Question) -> Self {
        let failed = |reason: String| NoAnswer::Failed(reason);
        let build = || {
            let engine = described.get(&question.engine).map_err(|error| failed(error.to_string()))?;
            let oracle = start(root, engine, question.limits).map_err(|fail| failed(fail.to_string()))?;
            let robot = featherbench_bench::alone::robot(&question.robot, question.seed)?;
            let begun = Instant::now();
            drop(oracle.prepare(&robot, question.quantity, &question.method, &robot.states)?);
            let seconds = begun.elapsed().as_secs_f64();
            Ok((oracle, robot, seconds))
        };
        Self { first: question.clone(), state: build() }
    }

    /// Whether a question is about the same robot and engine.
    fn is_for(&self, question: &Question) -> bool {
        let key = |of: &Question| (of.engine.clone(), of.robot.clone(), of.seed, of.limits);
        key(&self.first) == key(question)
    }

    fn measure(&self, question: &Question) -> Result<Measured, NoAnswer> {
        let (oracle, robot, build) = self.state.as_ref().map_err(NoAnswer::clone)?;
        let measured = featherbench_bench::alone::measure(oracle, robot, question, || None)?;
        Ok(Measured { build: *build, ..measured })
    }
}

/// What is said of an engine that answers: its version, the day of that version's release, and something more.
fn answering(engines: &Engines, name: &str, version: &str, more: impl std::fmt::Display) -> String {
    format!("{version:<8} {:<11} {more}", engines.released(name, version).unwrap_or("unknown"))
}

/// The same of an oracle in Python: the version of its interpreter.
fn of_python(engines: &Engines, engine: &DescribedEngine, oracle: &Oracle) -> String {
    let Identity { version, build, .. } = oracle.identity();
    answering(engines, &engine.name, version, format_args!("Python {}", build.get("python").map_or("unknown", String::as_str)))
}

/// Prints what answers: engine, version, date and Python.
pub fn status(root: &Root) -> Result<(), Fail> {
    let engines = described(root)?;
    let installed = python(root).is_some();
    let mut broken = Vec::new();
    say!("engine           version  released    Python, or what is built");
    for engine in engines.iter() {
        let told = match &engine.start {
            Start::Python { .. } => match start(root, engine, Limits::default()) {
                Ok(oracle) => of_python(&engines, engine, &oracle),
                Err(_) if !installed => "is not installed: run `featherbench oracles install`".into(),
                Err(fail) => {
                    broken.push(engine.name.as_str());
                    format!("does not answer: {fail}")
                }
            },
            Start::PythonAlone { .. } => match start(root, engine, Limits::default()) {
                Ok(oracle) => of_python(&engines, engine, &oracle),
                Err(Fail::Missing { message, .. }) => message,
                Err(fail) => fail.to_string(),
            },
            Start::Cargo { folder, program } => Compiled::program(root, engine, folder, program).told(&engines),
            Start::CargoLibrary { folder, library } => Compiled::library(root, engine, folder, library).told(&engines),
            Start::Native(library) => native::status(root, &engines, engine, library).unwrap_or_else(|reason| reason),
        };
        say!("{:<16} {told}", engine.name);
    }
    if !installed {
        let message = "the reference engines are not installed (or not in the versions of oracles/engines.toml)".into();
        return Err(Fail::Missing { message, advice: "run `featherbench oracles install`".into() });
    }
    if broken.is_empty() {
        return Ok(());
    }
    let advice = format!("remove {} and run `featherbench oracles install` again", root.engines().display());
    Err(Fail::Missing { message: format!("no answer from {}", broken.join(", ")), advice })
}

/// The package's folder of robots, for suites that read URDF files live.
pub fn robots(root: &Root) -> Option<PathBuf> {
    let library = root.engines().join("venv/lib");
    let versions = std::fs::read_dir(library).ok()?;
    let inside = "site-packages/cmeel.prefix/share/example-robot-data/robots";
    versions.filter_map(Result::ok).map(|version| version.path().join(inside)).find(|folder| folder.is_dir())
}
