//! An engine behind the oracle protocol: one program, with one process per thread that asks.

mod asked;
pub(crate) mod contacts;
mod folders;
pub(crate) mod hello;
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
    ContactSolver, Engine, Evaluation, Identity, Import, ImportVariant, LoopSolver, NoAnswer, Quantity, Rewritten, Robot, RobotFile,
    RodSolver, Route, SceneEngine, SemidefiniteSolver, Stepper,
};
use featherbench_protocol::{Block, Clock, Limits, Message, Process, SystemClock, VERSION};
use featherbench_results::EngineSource;
use featherbench_robots::StateBatch;
use hello::Hello;
use serde_json::{Value, json};
use std::ffi::OsString;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// An engine that runs in its own process.
pub struct Oracle {
    identity: Identity,
    hello: Hello,
    command: Vec<OsString>,
    limits: Limits,
    clock: Arc<dyn Clock>,
    idle: Mutex<Vec<Session>>,
    /// Files that it does not import, each with the reason: they are not asked for again, as each attempt may take the time limit.
    refused: Mutex<Vec<(RobotFile, NoAnswer)>>,
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
        let hello = Hello::read(&hello.header).and_then(|hello| hello.check().map(|()| hello));
        let hello = hello.map_err(|reason| format!("hello: {reason}"))?;
        let (name, version, build) = (hello.engine.clone(), hello.version.clone(), hello.build.clone());
        let mut identity = Identity { name, version, source: EngineSource::Live, build };
        if hello.estimates() {
            identity.build.insert("clock".into(), ESTIMATE.into());
        }
        let session = Session { process, model: String::new(), readback: Vec::new(), states: None, reading: None };
        Ok(Self { identity, hello, command, limits, clock, idle: Mutex::new(vec![session]), refused: Mutex::default() })
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

    /// A free session, or a new one.
    fn session(&self) -> Result<Lent<'_>, NoAnswer> {
        let idle = self.lock().pop();
        let session = match idle {
            Some(session) => session,
            None => {
                let process = Process::start_by(&self.command, self.limits, Arc::clone(&self.clock)).map_err(NoAnswer::Failed)?;
                Session { process, model: String::new(), readback: Vec::new(), states: None, reading: None }
            }
        };
        Ok(Lent { oracle: self, session: Some(session) })
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
            // The products are made here, of the Jacobians of the bodies one by one.
            Quantity::BodyJacobians => self.methods(Quantity::BodyJacobian),
            _ => self.hello.methods.get(quantity.name()).cloned().unwrap_or_default(),
        }
    }

    fn timed(&self, quantity: Quantity) -> Vec<String> {
        match self.hello.estimates() {
            true => self.hello.timed.get(quantity.name()).cloned().unwrap_or_default(),
            false => self.methods(quantity),
        }
    }

    fn estimates(&self) -> bool {
        self.hello.estimates()
    }

    fn has_clock(&self) -> bool {
        self.hello.has_clock()
    }

    fn read(&self, file: &RobotFile) -> Result<Import, NoAnswer> {
        let known = || self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, reason)) = known().iter().find(|(other, _)| other == file) {
            return Err(reason.clone());
        }
        let read = self.session()?.open()?.read(file);
        if let Err(reason) = &read {
            known().push((file.clone(), reason.clone()));
        }
        read
    }

    fn variants(&self, file: &RobotFile) -> Result<Vec<ImportVariant>, NoAnswer> {
        let answer = self.session()?.ask(about("variants", file)?, Vec::new())?;
        import::variants(&answer).map_err(|message| NoAnswer::Failed(format!("the engine's variants: {message}")))
    }

    fn rewrite(&self, file: &RobotFile, into: &Path) -> Result<Vec<Rewritten>, NoAnswer> {
        if !self.hello.writes {
            return Ok(Vec::new());
        }
        let into = into.to_str().ok_or_else(|| NoAnswer::Failed("the folder's path is not UTF-8; rename it".into()))?;
        let mut question = about("rewrite", file)?;
        question["into"] = into.into();
        let answer = self.session()?.ask(question, Vec::new())?;
        import::rewritten(&answer).map_err(|message| NoAnswer::Failed(format!("what the engine wrote: {message}")))
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let mut session = self.session()?;
        session.open()?.hold(robot, states)?;
        Ok(Box::new(Asked::new(session, robot, quantity, method)))
    }

    fn contact_solver(&self) -> Option<&dyn ContactSolver> {
        self.hello.solves_contacts().then_some(self)
    }

    fn loop_solver(&self) -> Option<&dyn LoopSolver> {
        self.hello.loops.is_some().then_some(self)
    }

    fn semidefinite_solver(&self) -> Option<&dyn SemidefiniteSolver> {
        (!self.hello.semidefinite_least_squares.is_empty()).then_some(self)
    }

    fn rod_solver(&self) -> Option<&dyn RodSolver> {
        (!self.hello.rods.is_empty()).then_some(self)
    }

    fn scene_engine(&self) -> Option<&dyn SceneEngine> {
        self.hello.has_scenes().then_some(self)
    }

    fn stepper(&self) -> Option<&dyn Stepper> {
        self.hello.steps.is_some().then_some(self)
    }
}

/// A session that the oracle has back at the end, if its process lives.
struct Lent<'a> {
    oracle: &'a Oracle,
    session: Option<Session>,
}

impl Lent<'_> {
    fn open(&mut self) -> Result<&mut Session, NoAnswer> {
        self.session.as_mut().ok_or_else(|| NoAnswer::Failed("the oracle has ended".into()))
    }

    fn ask(&mut self, header: Value, blocks: Vec<Block>) -> Result<Message, NoAnswer> {
        self.open()?.ask(header, blocks)
    }
}

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        if let Some(session) = self.session.take().filter(|session| session.process.alive()) {
            self.oracle.lock().push(session);
        }
    }
}

impl Session {
    /// Lets the engine hold a robot in states.
    fn hold(&mut self, robot: &Robot, states: &StateBatch) -> Result<(), NoAnswer> {
        self.build(robot)?;
        self.send_states(robot, states)
    }

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
        sized(&answer, robot.description.nq(), robot.model.topology.nv())?;
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
        let answer = self.ask(about("import", file)?, Vec::new())?;
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

/// The request of an operation on a file.
fn about(op: &str, file: &RobotFile) -> Result<Value, NoAnswer> {
    let path = file.path.to_str().ok_or_else(|| NoAnswer::Failed("the file's path is not UTF-8; rename it".into()))?;
    Ok(json!({"op": op, "file": path, "format": file.format.name(), "base": file.base.name()}))
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

/// An error if the engine's robot has other sizes.
fn sized(answer: &Message, nq: usize, nv: usize) -> Result<(), NoAnswer> {
    for (key, due) in [("nq", nq), ("nv", nv)] {
        let found = answer.header.get(key).and_then(Value::as_u64);
        if found != Some(due as u64) {
            return Err(NoAnswer::Failed(format!("the engine reports {key} {found:?}, the robot has {due}")));
        }
    }
    Ok(())
}

/// A time that an answer tells.
fn told_time(answer: &Message, key: &str) -> Result<f64, NoAnswer> {
    let time = answer.header.get(key).and_then(Value::as_f64).filter(|time| time.is_finite() && *time >= 0.0);
    time.ok_or_else(|| NoAnswer::Failed(format!("the oracle's answer has no {key}")))
}

/// The engine's own time.
pub(crate) fn own_time(answer: &Message) -> Result<Duration, NoAnswer> {
    Ok(Duration::from_secs_f64(told_time(answer, "nanoseconds")? * 1e-9))
}
