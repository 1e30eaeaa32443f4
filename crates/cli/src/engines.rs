//! Who is asked: our own kernels, and the engines of the suite, live or recorded.

use crate::args::RunArgs;
use crate::external::{self, External};
use crate::fail::Fail;
use crate::native;
use crate::oracles;
use crate::rapier;
use crate::robots::Loaded;
use crate::root::Root;
use ::featherbench_results::{EngineInfo, EngineSource};
use featherbench_bench::{Engine, OWN, Robot, Study};
use featherbench_engines::{Featherbench, Limits, Recorded, read_recordings};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// The engines of a run, and what is to be said about each engine, the missing ones too.
pub struct Opened {
    pub engines: Vec<Box<dyn Engine>>,
    pub infos: Vec<EngineInfo>,
}

/// What a run asks of engines.
pub struct Asked<'a> {
    /// Engines beside ours that must answer.
    pub engines: &'a [String],
    /// Engines that are timed if they are installed.
    pub timed: Vec<String>,
    /// Engines that a user brings along.
    pub externals: &'a [External],
    /// Whether the engines themselves are asked.
    pub live: bool,
    /// The folder of recorded answers.
    pub recorded: PathBuf,
    /// The robots that recorded answers are about.
    pub robots: Vec<&'a Robot>,
    /// The limits of each engine's process.
    pub limits: Limits,
}

impl<'a> Asked<'a> {
    /// The engines of a suite and its studies.
    pub fn by_suite(root: &Root, args: &'a RunArgs, loaded: &'a Loaded, studies: &[Box<dyn Study>]) -> Self {
        let answers = |robot: &&Robot| studies.iter().any(|study| !study.measures_time() && robot.takes(study.name()));
        Self {
            engines: loaded.suite.engines(),
            timed: studies.iter().flat_map(|study| study.engines()).cloned().collect(),
            externals: &args.externals,
            live: args.live,
            recorded: args.recorded.clone().unwrap_or_else(|| root.recorded()),
            robots: loaded.robots.iter().filter(answers).collect(),
            limits: limits(args),
        }
    }

    /// Engines that are asked themselves, and must answer.
    pub fn live(root: &Root, engines: &'a [String], limits: Limits) -> Self {
        Self { engines, timed: Vec::new(), externals: &[], live: true, recorded: root.recorded(), robots: Vec::new(), limits }
    }
}

/// Opens the engines that a run asks.
pub fn open(root: &Root, asked: &Asked) -> Result<Opened, Fail> {
    let Asked { engines, limits, .. } = *asked;
    let mut opened = Opened { engines: Vec::new(), infos: Vec::new() };
    opened.add(Ok(Box::new(Featherbench::new())), OWN, EngineSource::Own);
    let taken: Vec<&str> = [OWN].into_iter().chain(engines.iter().map(String::as_str)).collect();
    external::check_names(asked.externals, &taken)?;
    // One that is asked for answers too is the same engine: see below.
    for name in asked.timed.iter().filter(|name| !engines.contains(name)) {
        let engine = match oracles::ESTIMATING.contains(&name.as_str()) {
            true => oracles::start_timed(root, name, limits),
            false => native::start(root, name, limits, None),
        };
        opened.add(engine.map(|engine| Box::new(engine) as Box<dyn Engine>), name, EngineSource::Live);
    }
    // Rapier is not recorded: a run that asks for it builds it and asks it itself.
    let (unrecorded, others): (Vec<&String>, Vec<&String>) = engines.iter().partition(|engine| *engine == rapier::NAME);
    for engine in unrecorded {
        opened.add(Ok(Box::new(rapier::start(root, limits)?)), engine, EngineSource::Live);
    }
    if asked.live && !others.is_empty() {
        let python = oracles::install(root)?;
        // Together: an engine's start is its libraries being read from disk.
        let started: Vec<_> = std::thread::scope(|scope| {
            let start = |engine: &str| match native::PEERS.contains(&engine) {
                true => native::start(root, engine, limits, None),
                false => oracles::start(root, &python, engine, limits),
            };
            let starting: Vec<_> = others.iter().map(|engine| scope.spawn(move || start(engine))).collect();
            let lost = |_| Err("the engine's start broke off".into());
            starting.into_iter().map(|thread| thread.join().unwrap_or_else(lost)).collect()
        });
        for (engine, oracle) in others.into_iter().zip(started) {
            opened.add(oracle.map(|oracle| Box::new(oracle) as Box<dyn Engine>), engine, EngineSource::Live);
        }
    } else if !others.is_empty() {
        let recordings = Arc::new(read_recordings(&asked.recorded, &asked.robots));
        for engine in others {
            let recorded = Recorded::new(&recordings, engine).map(|recorded| Box::new(recorded) as Box<dyn Engine>);
            opened.add(recorded, engine, EngineSource::Recorded);
        }
    }
    for external in asked.externals {
        opened.add(Ok(Box::new(external.start(root, limits)?)), &external.name, EngineSource::Live);
    }
    Ok(opened)
}

/// The limits that a run's arguments set for each engine's process.
pub fn limits(args: &RunArgs) -> Limits {
    Limits { answer: Duration::from_secs(args.timeout), memory: args.memory << 20 }
}

impl Opened {
    fn add(&mut self, engine: Result<Box<dyn Engine>, String>, name: &str, source: EngineSource) {
        let info = match &engine {
            Ok(engine) => {
                let identity = engine.identity().clone();
                EngineInfo {
                    name: identity.name,
                    version: identity.version,
                    source,
                    build: identity.build,
                    status: "ok".into(),
                    reason: String::new(),
                }
            }
            Err(reason) => EngineInfo {
                name: name.into(),
                version: String::new(),
                source,
                build: Default::default(),
                status: "missing".into(),
                reason: reason.clone(),
            },
        };
        self.infos.push(info);
        self.engines.extend(engine);
    }

    /// Those of these engines that are not there.
    pub fn missing(&self, engines: &[String]) -> Vec<&EngineInfo> {
        self.infos.iter().filter(|engine| engine.status != "ok" && engines.contains(&engine.name)).collect()
    }
}
