//! Who is asked: our own kernels, and the engines of the suite, live or recorded.

use crate::args::RunArgs;
use crate::external;
use crate::fail::Fail;
use crate::native;
use crate::oracles;
use crate::rapier;
use crate::robots::Loaded;
use crate::root::Root;
use ::featherbench_results::{EngineInfo, EngineSource};
use featherbench_bench::{Engine, Robot};
use featherbench_engines::{Featherbench, Limits, Recorded, read_recordings};
use std::sync::Arc;
use std::time::Duration;

/// The engines of a run, and what is to be said about each engine, the missing ones too.
pub struct Opened {
    pub engines: Vec<Box<dyn Engine>>,
    pub infos: Vec<EngineInfo>,
}

/// Opens the engines that a run asks.
pub fn open(root: &Root, args: &RunArgs, loaded: &Loaded) -> Result<Opened, Fail> {
    let mut opened = Opened { engines: Vec::new(), infos: Vec::new() };
    opened.add(Ok(Box::new(Featherbench::new())), "featherbench", EngineSource::Own);
    let engines: &[String] = loaded.suite.agreement.as_ref().map_or(&[], |agreement| &agreement.engines);
    let taken: Vec<&str> = ["featherbench"].into_iter().chain(engines.iter().map(String::as_str)).collect();
    external::check_names(&args.externals, &taken)?;
    let limits = limits(args);
    if let Some(timing) = loaded.suite.timing.as_ref().filter(|_| !args.no_timing) {
        // One that is asked for agreement too is the same engine: see below.
        for name in timing.peers.iter().filter(|name| !engines.contains(name)) {
            let peer = match oracles::ESTIMATING.contains(&name.as_str()) {
                true => oracles::start_timed(root, name, limits),
                false => native::start(root, name, limits, None),
            };
            opened.add(peer.map(|peer| Box::new(peer) as Box<dyn Engine>), name, EngineSource::Live);
        }
    }
    // Rapier is not recorded: a run that asks for it builds it and asks it itself.
    let (unrecorded, others): (Vec<&String>, Vec<&String>) = engines.iter().partition(|engine| *engine == rapier::NAME);
    for engine in unrecorded {
        opened.add(Ok(Box::new(rapier::start(root, limits)?)), engine, EngineSource::Live);
    }
    if args.live && !others.is_empty() {
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
        let folder = args.recorded.clone().unwrap_or_else(|| root.recorded());
        let asked: Vec<&Robot> = loaded.robots.iter().filter(|robot| robot.takes("agreement") || robot.takes("operations")).collect();
        let recordings = Arc::new(read_recordings(&folder, &asked));
        for engine in others {
            let recorded = Recorded::new(&recordings, engine).map(|recorded| Box::new(recorded) as Box<dyn Engine>);
            opened.add(recorded, engine, EngineSource::Recorded);
        }
    }
    for external in &args.externals {
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

    /// The engines that should be there and are not. A peer of the timing study may be missing: the report says so.
    pub fn missing(&self, loaded: &Loaded) -> Vec<&EngineInfo> {
        let due = |engine: &EngineInfo| loaded.suite.agreement.as_ref().is_some_and(|agreement| agreement.engines.contains(&engine.name));
        self.infos.iter().filter(|engine| engine.status != "ok" && due(engine)).collect()
    }
}
