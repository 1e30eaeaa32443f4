//! An engine behind the oracle protocol: one program, with one process per thread that asks.

mod asked;
pub(crate) mod contacts;
mod folders;
mod import;
pub(crate) mod loops;
pub(crate) mod residual;
pub(crate) mod rods;
pub(crate) mod scenes;
pub(crate) mod semidefinite;
pub(crate) mod steps;

pub(crate) use import::reading;
pub use residual::OracleResidual;

use crate::{request, shape};
use asked::Asked;
use featherbench_bench::provenance::{PROGRAM, SOURCES};
use featherbench_bench::{
    ContactSolver, Engine, Evaluation, Identity, Import, LoopSolver, NoAnswer, Quantity, Robot, RobotFile, RodSolver, Route, SceneEngine,
    SemidefiniteSolver, StepMethod, Stepper,
};
use featherbench_protocol::{Block, Clock, Limits, Message, Process, SystemClock, VERSION};
use featherbench_results::EngineSource;
use featherbench_robots::StateBatch;
use loops::Loops;
use scenes::Scenes;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::sync::{Arc, Mutex, PoisonError};
use steps::Steps;

/// An engine that runs in its own process.
pub struct Oracle {
    identity: Identity,
    methods: BTreeMap<String, Vec<String>>,
    timed_by: TimedBy,
    /// Whether it can relocate its data in memory.
    relocate: bool,
    /// What it offers of steps, if it integrates.
    steps: Option<Steps>,
    /// What it offers of robots with loops.
    loops: Option<Loops>,
    /// Its solvers of contact problems.
    contact_solvers: Vec<String>,
    /// Its solvers of their convex relaxation.
    contact_relaxations: Vec<String>,
    /// Its methods for steps of a robot on its contacts.
    contact_steps: Vec<StepMethod>,
    /// Its methods for least squares under semidefinite conditions.
    semidefinite: Vec<String>,
    /// Its elements of elastic rods.
    rods: Vec<String>,
    /// What it offers of scenes.
    scenes: Scenes,
    /// What it says of its residual, if it has one.
    residual: Option<residual::Offered>,
    command: Vec<OsString>,
    limits: Limits,
    clock: Arc<dyn Clock>,
    idle: Mutex<Vec<Session>>,
}

/// Which clock measures a time.
enum TimedBy {
    /// Ours, around the whole request and answer.
    Us,
    /// The oracle's, beside its loop.
    Itself,
    /// The oracle's, in a language whose overhead it subtracts, and for these methods only.
    Estimate(BTreeMap<String, Vec<String>>),
}

/// A part of the identity of an oracle whose times are estimates.
const ESTIMATE: &str = "estimate: the overhead of calling the engine is measured and subtracted";

/// A process and its latest robot and states.
struct Session {
    process: Process,
    /// Hash of the robot that it has built, or of the file and base that it has imported.
    model: String,
    readback: Vec<f64>,
    states: Option<String>,
    /// The imported file, while no other robot was built after it.
    reading: Option<(RobotFile, Import)>,
}

impl Oracle {
    /// Starts the program and asks for its identity.
    ///
    /// # Errors
    /// A sentence, when it does not start or does not follow the protocol.
    pub fn start(command: Vec<OsString>, limits: Limits) -> Result<Self, String> {
        Self::start_by(command, limits, Arc::new(SystemClock::default()))
    }

    /// Starts the program. Its limits and its times are measured by this clock.
    ///
    /// # Errors
    /// As of [`Oracle::start`].
    pub fn start_by(command: Vec<OsString>, limits: Limits, clock: Arc<dyn Clock>) -> Result<Self, String> {
        let mut process = Process::start_by(&command, limits, Arc::clone(&clock))?;
        let hello = checked(process.ask(&Message::new(json!({"op": "hello"}), Vec::new()))?).map_err(|refusal| refusal.to_string())?;
        let protocol = hello.header.get("protocol").and_then(Value::as_u64);
        if protocol != Some(VERSION) {
            return Err(format!("the oracle speaks protocol {protocol:?}, this program {VERSION}"));
        }
        let build = hello.header.get("build").cloned().unwrap_or_else(|| json!({}));
        let methods = hello.header.get("methods").cloned().unwrap_or_else(|| json!({}));
        let mut identity = Identity {
            name: hello.text("engine").to_owned(),
            version: hello.text("version").to_owned(),
            source: EngineSource::Live,
            build: serde_json::from_value(build).map_err(|error| format!("hello: build: {error}"))?,
        };
        let methods = serde_json::from_value(methods).map_err(|error| format!("hello: methods: {error}"))?;
        if identity.name.is_empty() || identity.version.is_empty() {
            return Err("hello: engine and version must not be empty".into());
        }
        let timed_by = match hello.header.get("clock") {
            Some(Value::Bool(true)) => TimedBy::Itself,
            Some(Value::String(kind)) if kind == "estimate" => {
                identity.build.insert("clock".into(), ESTIMATE.into());
                let timed = hello.header.get("timed").cloned().unwrap_or_else(|| json!({}));
                TimedBy::Estimate(serde_json::from_value(timed).map_err(|error| format!("hello: timed: {error}"))?)
            }
            _ => TimedBy::Us,
        };
        let relocate = hello.header.get("relocate").and_then(Value::as_bool).unwrap_or(false);
        let steps = Steps::offered(hello.header.get("steps")).map_err(|reason| format!("hello: {reason}"))?;
        let loops = Loops::offered(hello.header.get("loops")).map_err(|reason| format!("hello: {reason}"))?;
        let contact_steps = contacts::steps_offered(hello.header.get("contact_steps")).map_err(|reason| format!("hello: {reason}"))?;
        let scenes = Scenes::offered(&hello.header).map_err(|reason| format!("hello: {reason}"))?;
        let listed = |key: &str| -> Result<Vec<String>, String> {
            let names = hello.header.get(key).cloned().unwrap_or_else(|| json!([]));
            serde_json::from_value(names).map_err(|error| format!("hello: {key}: {error}"))
        };
        let (contact_solvers, contact_relaxations) = (listed("contact_solvers")?, listed("contact_relaxations")?);
        let (semidefinite, rods) = (listed("semidefinite_least_squares")?, listed("rods")?);
        let residual = hello.header.get("residual").cloned().map(serde_json::from_value).transpose();
        let residual = residual.map_err(|error| format!("hello: residual: {error}"))?;
        let session = Session { process, model: String::new(), readback: Vec::new(), states: None, reading: None };
        Ok(Self {
            identity,
            methods,
            timed_by,
            relocate,
            steps,
            loops,
            contact_solvers,
            contact_relaxations,
            contact_steps,
            semidefinite,
            rods,
            scenes,
            residual,
            command,
            limits,
            clock,
            idle: Mutex::new(vec![session]),
        })
    }

    /// The same oracle under another name; the engine's own name goes into its build, where it differs.
    pub fn named(mut self, name: &str) -> Self {
        if self.identity.name != name {
            let own = std::mem::replace(&mut self.identity.name, name.to_owned());
            self.identity.build.insert("engine".into(), own);
        }
        self
    }

    /// The same oracle with the content hash of its program in its build. It is for oracles of users.
    pub fn with_program(self, hash: &str) -> Self {
        self.with_hash(PROGRAM, hash)
    }

    /// The same oracle with the hash of its program's sources in its build.
    pub fn with_sources(self, hash: &str) -> Self {
        self.with_hash(SOURCES, hash)
    }

    fn with_hash(mut self, of: &str, hash: &str) -> Self {
        self.identity.build.insert(of.into(), hash.into());
        self
    }

    fn session(&self) -> Result<Session, NoAnswer> {
        let idle = self.lock().pop();
        match idle {
            Some(session) => Ok(session),
            None => {
                let process = Process::start_by(&self.command, self.limits, Arc::clone(&self.clock)).map_err(NoAnswer::Failed)?;
                Ok(Session { process, model: String::new(), readback: Vec::new(), states: None, reading: None })
            }
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<Session>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Engine for Oracle {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        // The read-back comes with every robot.
        match quantity {
            Quantity::Readback => vec!["build".into()],
            _ => self.methods.get(quantity.name()).cloned().unwrap_or_default(),
        }
    }

    fn timed(&self, quantity: Quantity) -> Vec<String> {
        match &self.timed_by {
            TimedBy::Estimate(timed) => timed.get(quantity.name()).cloned().unwrap_or_default(),
            TimedBy::Us | TimedBy::Itself => self.methods(quantity),
        }
    }

    fn estimates(&self) -> bool {
        matches!(self.timed_by, TimedBy::Estimate(_))
    }

    fn has_clock(&self) -> bool {
        !matches!(self.timed_by, TimedBy::Us)
    }

    fn read(&self, file: &RobotFile) -> Result<Import, NoAnswer> {
        let mut session = self.session()?;
        let reading = session.read(file);
        self.give_back(session);
        reading
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let mut session = self.session()?;
        match session.build(robot).and_then(|()| session.send_states(robot, states)) {
            Ok(()) => Ok(Box::new(Asked::new(self, session, robot, quantity, method))),
            Err(refusal) => {
                self.give_back(session);
                Err(refusal)
            }
        }
    }

    fn contact_solver(&self) -> Option<&dyn ContactSolver> {
        let lists = [&self.contact_solvers, &self.contact_relaxations];
        (lists.iter().any(|names| !names.is_empty()) || !self.contact_steps.is_empty()).then_some(self)
    }

    fn loop_solver(&self) -> Option<&dyn LoopSolver> {
        self.loops.is_some().then_some(self)
    }

    fn semidefinite_solver(&self) -> Option<&dyn SemidefiniteSolver> {
        (!self.semidefinite.is_empty()).then_some(self)
    }

    fn rod_solver(&self) -> Option<&dyn RodSolver> {
        (!self.rods.is_empty()).then_some(self)
    }

    fn scene_engine(&self) -> Option<&dyn SceneEngine> {
        (!self.scenes.is_empty()).then_some(self)
    }

    fn stepper(&self) -> Option<&dyn Stepper> {
        self.steps.is_some().then_some(self)
    }
}

impl Oracle {
    fn give_back(&self, session: Session) {
        if session.process.alive() {
            self.lock().push(session);
        }
    }
}

impl Session {
    fn ask(&mut self, header: Value, blocks: Vec<Block>) -> Result<Message, NoAnswer> {
        checked(self.process.ask(&Message::new(header, blocks)).map_err(NoAnswer::Failed)?)
    }

    /// Lets the engine build the robot, unless it has done so already, and reads it back.
    fn build(&mut self, robot: &Robot) -> Result<(), NoAnswer> {
        if self.model == robot.hash {
            return Ok(());
        }
        if robot.route == Route::AsRead {
            return self.build_as_read(robot);
        }
        self.model.clear();
        self.states = None;
        self.reading = None;
        let description = request::description(robot).map_err(NoAnswer::Failed)?;
        let answer = self.ask(json!({"op": "prepare", "model": description}), Vec::new())?;
        let topology = &robot.model.topology;
        for (key, expected) in [("nq", robot.description.nq()), ("nv", topology.nv())] {
            let found = answer.header.get(key).and_then(Value::as_u64);
            if found != Some(expected as u64) {
                return Err(NoAnswer::Failed(format!("the engine reports {key} {found:?}, the robot has {expected}")));
            }
        }
        self.readback = shaped(&answer, "readback", &shape::of_readback(robot))?;
        self.model.clone_from(&robot.hash);
        Ok(())
    }

    /// Lets the engine import the robot's file again; an error if the result differs from the first import.
    fn build_as_read(&mut self, robot: &Robot) -> Result<(), NoAnswer> {
        let file = robot.file.as_ref().ok_or_else(|| NoAnswer::Failed("the robot has no file to read".into()))?;
        let reading = self.read(file)?;
        if reading.description.bodies != robot.description.bodies || reading.description.gravity != robot.description.gravity {
            return Err(NoAnswer::Failed("the engine does not read the same robot twice from the same file".into()));
        }
        self.model.clone_from(&robot.hash);
        Ok(())
    }

    /// Lets the engine's own parser import a file, and asks for the result.
    fn read(&mut self, file: &RobotFile) -> Result<Import, NoAnswer> {
        if let Some((_, reading)) = self.reading.as_ref().filter(|(known, _)| known == file) {
            return Ok(reading.clone());
        }
        self.model.clear();
        self.states = None;
        self.reading = None;
        self.readback.clear();
        let path = file.path.to_str().ok_or_else(|| NoAnswer::Failed("the file's path is not UTF-8; rename it".into()))?;
        let header = json!({"op": "import", "file": path, "format": file.format.name(), "base": file.base.name()});
        let answer = self.ask(header, Vec::new())?;
        let reading = reading(&answer).map_err(|message| NoAnswer::Failed(format!("the engine's reading: {message}")))?;
        self.reading = Some((file.clone(), reading.clone()));
        Ok(reading)
    }

    fn send_states(&mut self, robot: &Robot, states: &StateBatch) -> Result<(), NoAnswer> {
        let numbers = [&states.q, &states.v, &states.a, &states.tau, &states.wrench].into_iter().flatten();
        let bytes: Vec<u8> = numbers.flat_map(|x| x.to_le_bytes()).collect();
        let key = featherbench_bench::hash::of(&bytes);
        if self.states.as_ref() == Some(&key) {
            return Ok(());
        }
        let (header, blocks) = request::states(robot, states);
        self.ask(header, blocks)?;
        self.states = Some(key);
        Ok(())
    }
}

/// The answer if its status is `ok`, else the error of its status.
pub(crate) fn checked(answer: Message) -> Result<Message, NoAnswer> {
    let reason = || match answer.text("reason") {
        "" => "the oracle gives no reason".to_owned(),
        reason => folders::without_folders(reason),
    };
    match answer.text("status") {
        "ok" => Ok(answer),
        "unsupported" => Err(NoAnswer::NotOffered(reason())),
        "error" => Err(NoAnswer::Failed(reason())),
        other => Err(NoAnswer::Failed(format!("the oracle answers with status '{other}'"))),
    }
}

/// The numbers of a block that must have this shape.
pub(crate) fn shaped(answer: &Message, name: &str, due: &[usize]) -> Result<Vec<f64>, NoAnswer> {
    shape::block(answer, name, due).map(<[f64]>::to_vec).map_err(NoAnswer::Failed)
}
