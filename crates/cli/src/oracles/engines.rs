//! Who is asked: our own kernels, and the engines of the suite, live or recorded.

use crate::args::RunArgs;
use crate::fail::Fail;
use crate::oracles;
use crate::oracles::external::{self, External};
use crate::robots::Loaded;
use crate::root::Root;
use ::featherbench_results::{EngineInfo, EngineSource};
use featherbench_bench::{DescribedEngine, Engine, OWN, Robot, Start, Study};
use featherbench_engines::{Featherbench, Limits, Recorded, read_recordings, recording_name};
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
    pub engines: Vec<String>,
    /// Engines that are timed if they are installed, and have a clock.
    pub timed: Vec<String>,
    /// Engines that are asked alone if they are installed, with or without a clock.
    pub alone: Vec<String>,
    /// Engines that a user brings along.
    pub externals: &'a [External],
    /// Whether the engines themselves are asked.
    pub live: bool,
    /// The seed that is asked for, if any: answers are recorded to the suite's own.
    pub seed: Option<u64>,
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
        let of_studies = |clocks: bool| -> Vec<String> {
            studies.iter().filter(|study| study.needs_clocks() == clocks).flat_map(|study| study.engines()).cloned().collect()
        };
        let (timed, alone) = (of_studies(true), of_studies(false));
        // A process that answers for one study needs the engines that this one names.
        let is_due = |name: &&String| args.answer.is_none() || timed.contains(name) || alone.contains(name);
        Self {
            engines: loaded.suite.engines().iter().filter(is_due).cloned().collect(),
            timed,
            alone,
            externals: if args.answer.is_none() { &args.asked.externals } else { &[] },
            live: args.asked.live,
            seed: args.asked.seed,
            recorded: args.asked.recorded.clone().unwrap_or_else(|| root.recorded()),
            robots: loaded.robots.iter().filter(answers).collect(),
            limits: limits(args),
        }
    }

    /// Engines that are asked themselves, and must answer.
    pub fn live(root: &Root, engines: &'a [String], limits: Limits) -> Self {
        Self {
            engines: engines.to_vec(),
            timed: Vec::new(),
            alone: Vec::new(),
            externals: &[],
            live: true,
            seed: None,
            recorded: root.recorded(),
            robots: Vec::new(),
            limits,
        }
    }
}

/// Opens the engines that a run asks.
pub fn open(root: &Root, asked: &Asked) -> Result<Opened, Fail> {
    let limits = asked.limits;
    let mut opened = Opened { engines: Vec::new(), infos: Vec::new() };
    opened.add(Ok(Box::new(Featherbench::new())), OWN, EngineSource::Own);
    let described = oracles::described(root)?;
    let find = |name: &String| described.get(name).map_err(Fail::input);
    let due: Vec<&DescribedEngine> = asked.engines.iter().map(find).collect::<Result<_, _>>()?;
    let mut timed: Vec<&DescribedEngine> = asked.timed.iter().map(find).collect::<Result<_, _>>()?;
    if let Some(engine) = timed.iter().find(|engine| engine.clock.is_none()) {
        let can = described.names(|engine| engine.clock.is_some()).join(", ");
        return Err(Fail::input(format!("{} cannot be timed; oracles/engines.toml has a clock for {can}", engine.name)));
    }
    for engine in asked.alone.iter().map(find).collect::<Result<Vec<_>, _>>()? {
        if !timed.contains(&engine) {
            timed.push(engine);
        }
    }
    let taken: Vec<&str> = [OWN].into_iter().chain(described.names(|_| true)).collect();
    external::check_names(asked.externals, &taken)?;
    // One that is asked for answers too is the same engine: see below.
    for engine in timed.into_iter().filter(|engine| !due.contains(engine)) {
        opened.add(started(root, engine, limits), &engine.name, EngineSource::Live);
    }
    let (live, recorded): (Vec<&DescribedEngine>, Vec<_>) = due.into_iter().partition(|engine| asked.live || !engine.recorded);
    if let Some(seed) = asked.seed {
        let answered = |robot: &&Robot| asked.recorded.join(recording_name(&robot.name)).exists();
        if !recorded.is_empty() && asked.robots.iter().any(answered) {
            let names: Vec<&str> = recorded.iter().map(|engine| engine.name.as_str()).collect();
            return Err(Fail::input(format!(
                "--seed {seed}: the answers of {} are recorded to the suite's own seed; add --live to ask the engines, or leave --seed out",
                names.join(", ")
            )));
        }
    }
    if !recorded.is_empty() && !asked.recorded.is_dir() {
        let folder = asked.recorded.display();
        return Err(Fail::input(format!(
            "--recorded {folder}: there is no such folder; leave --recorded out, or ask the engines with --live"
        )));
    }
    let (compiled, installed): (Vec<_>, Vec<_>) = live.into_iter().partition(|engine| engine.is_compiled());
    // What cannot be built is told before anything else is started.
    for engine in compiled {
        opened.add(Ok(Box::new(oracles::start(root, engine, limits)?)), &engine.name, EngineSource::Live);
    }
    if !installed.is_empty() {
        // An engine with an environment of its own needs nothing of the others'.
        if installed.iter().any(|engine| !matches!(engine.start, Start::PythonAlone { .. })) {
            oracles::install(root)?;
        }
        // Together: an engine's start is its libraries being read from disk.
        let answers: Vec<_> = std::thread::scope(|scope| {
            let starting: Vec<_> = installed.iter().map(|engine| scope.spawn(move || started(root, engine, limits))).collect();
            let lost = |_| Err("the engine's start broke off".into());
            starting.into_iter().map(|thread| thread.join().unwrap_or_else(lost)).collect()
        });
        for (engine, answer) in installed.iter().zip(answers) {
            opened.add(answer, &engine.name, EngineSource::Live);
        }
    }
    if !recorded.is_empty() {
        let recordings = Arc::new(read_recordings(&asked.recorded, &asked.robots));
        for engine in recorded {
            let answers = Recorded::new(&recordings, &engine.name).map(|recorded| Box::new(recorded) as Box<dyn Engine>);
            opened.add(answers, &engine.name, EngineSource::Recorded);
        }
    }
    for info in &mut opened.infos {
        info.released = described.released(&info.name, &info.version).unwrap_or_default().to_owned();
    }
    for external in asked.externals {
        opened.add(Ok(Box::new(external.start(root, limits)?)), &external.name, EngineSource::Live);
    }
    Ok(opened)
}

/// An engine's oracle, or the reason why there is none.
fn started(root: &Root, engine: &DescribedEngine, limits: Limits) -> Result<Box<dyn Engine>, String> {
    match oracles::start(root, engine, limits) {
        Ok(oracle) => Ok(Box::new(oracle)),
        Err(Fail::Missing { message, .. }) => Err(message),
        Err(fail) => Err(fail.to_string()),
    }
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
                    released: String::new(),
                    source,
                    build: identity.build,
                    status: "ok".into(),
                    reason: String::new(),
                }
            }
            Err(reason) => EngineInfo {
                name: name.into(),
                version: String::new(),
                released: String::new(),
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
