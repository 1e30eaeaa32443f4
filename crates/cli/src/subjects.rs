//! Who is asked: the native kernels, and the engines of the suite, live or recorded.

use crate::args::RunArgs;
use crate::fail::Fail;
use crate::oracles;
use crate::problems::Loaded;
use crate::root::Root;
use ::record::{EngineInfo, EngineSource};
use engines::{Limits, Native, Recorded, read_recordings};
use harness::{Problem, Subject};
use std::sync::Arc;
use std::time::Duration;

/// The subjects of a run, and what is to be said about each engine, the missing ones too.
pub struct Subjects {
    pub subjects: Vec<Box<dyn Subject>>,
    pub engines: Vec<EngineInfo>,
}

/// Opens the subjects that a run asks.
pub fn open(root: &Root, args: &RunArgs, loaded: &Loaded) -> Result<Subjects, Fail> {
    let mut opened = Subjects { subjects: Vec::new(), engines: Vec::new() };
    opened.add(Ok(Box::new(Native::new())), "native", EngineSource::Native);
    if let Some(timing) = loaded.suite.timing.as_ref().filter(|_| !args.no_timing) {
        for name in &timing.peers {
            opened.add(peer(name), name, EngineSource::Live);
        }
    }
    let Some(agreement) = &loaded.suite.agreement else { return Ok(opened) };
    if args.live {
        let python = oracles::install(root)?;
        let limits = Limits { answer: Duration::from_secs(args.answer_within), memory: args.memory << 20 };
        for engine in &agreement.engines {
            let oracle = oracles::start(root, &python, engine, limits);
            opened.add(oracle.map(|oracle| Box::new(oracle) as Box<dyn Subject>), engine, EngineSource::Live);
        }
    } else {
        let folder = args.recorded.clone().unwrap_or_else(|| root.recorded());
        let asked: Vec<&Problem> =
            loaded.problems.iter().filter(|problem| problem.takes("agreement") || problem.takes("structure")).collect();
        let recordings = Arc::new(read_recordings(&folder, &asked));
        for engine in &agreement.engines {
            let recorded = Recorded::new(&recordings, engine).map(|recorded| Box::new(recorded) as Box<dyn Subject>);
            opened.add(recorded, engine, EngineSource::Recorded);
        }
    }
    Ok(opened)
}

/// A native peer, by its name.
fn peer(name: &str) -> Result<Box<dyn Subject>, String> {
    Err(format!("no native peer '{name}' is built here"))
}

impl Subjects {
    fn add(&mut self, subject: Result<Box<dyn Subject>, String>, name: &str, source: EngineSource) {
        let info = match &subject {
            Ok(subject) => {
                let identity = subject.identity().clone();
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
        self.engines.push(info);
        self.subjects.extend(subject);
    }

    /// The engines that should be there and are not. A peer of the timing study may be missing: the report says so.
    pub fn missing(&self, loaded: &Loaded) -> Vec<&EngineInfo> {
        let due = |engine: &EngineInfo| loaded.suite.agreement.as_ref().is_some_and(|agreement| agreement.engines.contains(&engine.name));
        self.engines.iter().filter(|engine| engine.status != "ok" && due(engine)).collect()
    }
}
