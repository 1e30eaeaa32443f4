//! Native oracles: an engine as a library, in a child process that follows the oracle protocol. It reads the clock next to the engine's
//! loop.
//!
//! [`command`] gives the command for [`Oracle::start`](crate::Oracle::start): this same program as `featherbench serve LIBRARY`, which calls
//! [`serve`].

mod library;

use crate::shape;
use featherbench_bench::{NoAnswer, Quantity, Relocation, Robot};
use featherbench_protocol::{Block, Message};
use featherbench_results::ModelOrigin;
use featherbench_robots::Random;
use library::{Built, Library};
use serde_json::{Map, Value, json};
use std::ffi::OsString;
use std::fs::File;
use std::io::{BufReader, Write, stdin};
use std::path::Path;
use std::time::Instant;

/// The command line of a child process that serves a library; with a core, it is pinned there.
pub fn command(program: &Path, library: &Path, core: Option<usize>) -> Vec<OsString> {
    let pinned = core.map(|core| ["--core".into(), core.to_string().into()]);
    [program.into(), "serve".into(), library.into()].into_iter().chain(pinned.into_iter().flatten()).collect()
}

/// Answers requests about a library on standard input and output until the input ends. Output of the library goes to standard error.
///
/// # Errors
/// A sentence, when the library cannot be loaded, the core is not available or the stream fails.
pub fn serve(path: &Path, core: Option<usize>) -> Result<(), String> {
    if let Some(core) = core {
        pin(core)?;
    }
    let io = |error: rustix::io::Errno| format!("standard output: {error}");
    let mut answers = File::from(rustix::io::dup(rustix::stdio::stdout()).map_err(io)?);
    rustix::stdio::dup2_stdout(rustix::stdio::stderr()).map_err(io)?;
    // Without a folder in its name a library would be searched in the system's folders.
    let library = Library::open(&path.canonicalize().map_err(|error| format!("{}: {error}", path.display()))?)?;
    let mut session = Session { library: &library, robot: None, states: None, built: None };
    let mut requests = BufReader::new(stdin());
    while let Some(request) = Message::read(&mut requests).map_err(|error| error.to_string())? {
        let answer = match session.answer(&request) {
            Ok((mut header, blocks)) => {
                header.insert("status".into(), "ok".into());
                Message { header, blocks }
            }
            Err(NoAnswer::NotOffered(reason)) => Message::new(json!({"status": "unsupported", "reason": reason}), Vec::new()),
            Err(NoAnswer::Failed(reason)) => Message::new(json!({"status": "error", "reason": reason}), Vec::new()),
        };
        answer.write(&mut answers).and_then(|()| answers.flush()).map_err(|error| format!("standard output: {error}"))?;
    }
    Ok(())
}

fn pin(core: usize) -> Result<(), String> {
    let refused = |what: &str| format!("core {core} cannot be had: {what}");
    if core >= rustix::thread::CpuSet::MAX_CPU {
        return Err(refused("there are not so many"));
    }
    let mut set = rustix::thread::CpuSet::new();
    set.set(core);
    rustix::thread::sched_setaffinity(None, &set).map_err(|error| refused(&error.to_string()))
}

/// The latest robot and states of the library.
struct Session<'a> {
    library: &'a Library,
    robot: Option<Robot>,
    /// The last batch of states: its number of states, and q, v, a and τ.
    states: Option<(usize, [Vec<f64>; 4])>,
    built: Option<Built<'a>>,
}

/// The header of an answer, without its status, and the blocks after it.
type Answer = Result<(Map<String, Value>, Vec<Block>), NoAnswer>;

fn ok(header: Value, blocks: Vec<Block>) -> Answer {
    Ok((Message::new(header, Vec::new()).header, blocks))
}

fn failed(what: impl Into<String>) -> NoAnswer {
    NoAnswer::Failed(what.into())
}

impl<'a> Session<'a> {
    fn answer(&mut self, request: &Message) -> Answer {
        match request.text("op") {
            "hello" => self.hello(),
            "prepare" => self.prepare(request),
            "states" => self.states(request),
            "evaluate" => self.evaluate(request),
            "clock" => self.clock(request),
            "relocate" => self.relocate(request),
            other => Err(failed(format!("unknown op {other}"))),
        }
    }

    fn hello(&self) -> Answer {
        let Library { engine, version, build, methods, .. } = self.library;
        let lines = build.lines().filter_map(|line| line.split_once('='));
        let build: Map<String, Value> = lines.map(|(key, value)| (key.to_owned(), value.into())).collect();
        let mut offered: Map<String, Value> = Map::new();
        for (quantity, method) in methods {
            let named = offered.entry(quantity).or_insert_with(|| json!([]));
            named.as_array_mut().into_iter().for_each(|named| named.push(method.as_str().into()));
        }
        ok(
            json!({"protocol": 1, "engine": engine, "version": version, "build": build, "methods": offered, "clock": true, "relocate": true}),
            Vec::new(),
        )
    }

    fn prepare(&mut self, request: &Message) -> Answer {
        (self.built, self.states, self.robot) = (None, None, None);
        let model = request.header.get("model").ok_or_else(|| failed("no model came"))?;
        let description = featherbench_formats::neutral::parse(&model.to_string(), "model").map_err(|error| failed(error.to_string()))?;
        // The robot has the compiled tree and the sizes of quantities; its own states are not used.
        let robot = Robot::new(&description, "", ModelOrigin::Generated, 1, 0).map_err(|error| failed(error.to_string()))?;
        let (built, readback) = self.library.build(&robot)?;
        let readback = Block::new("readback", &[robot.description.bodies.len(), 22], &readback);
        let sizes = json!({"nq": robot.description.nq(), "nv": robot.model.topology.nv()});
        (self.built, self.robot) = (Some(built), Some(robot));
        ok(sizes, vec![readback])
    }

    fn states(&mut self, request: &Message) -> Answer {
        self.states = None;
        let count = number(request, "count")?;
        let built = self.built.as_mut().ok_or_else(|| failed("no model was prepared"))?;
        let array = |name| request.block(name).map(|block| block.data.clone()).ok_or_else(|| failed(format!("block {name} is missing")));
        let arrays = [array("q")?, array("v")?, array("a")?, array("tau")?];
        built.states(count, arrays.each_ref().map(Vec::as_slice))?;
        self.states = Some((count, arrays));
        ok(json!({}), Vec::new())
    }

    /// Builds robot, states and the input of the last method again, at other addresses (memory layout randomization).
    fn relocate(&mut self, request: &Message) -> Answer {
        let (Some(robot), Some(built)) = (&self.robot, self.built.take()) else { return Err(failed("no model was prepared")) };
        let ready = built.is_ready();
        // Dropped before the new one is built: two of them may not fit the memory.
        drop(built);
        let _relocate = Relocation::new(&mut Random::new(number(request, "seed")? as u64, 0));
        let (mut built, _) = self.library.build(robot)?;
        if let Some((count, arrays)) = &self.states {
            built.states(*count, arrays.each_ref().map(Vec::as_slice))?;
        }
        if let Some((method, body)) = ready {
            built.ready(method, body)?;
        }
        self.built = Some(built);
        ok(json!({}), Vec::new())
    }

    /// The robot with the asked method ready, the range, and the shape of the answer.
    fn asked(&mut self, request: &Message) -> Result<(&mut Built<'a>, usize, usize, Vec<usize>), NoAnswer> {
        let (quantity, method) = (request.text("quantity"), request.text("method"));
        let named = |(of, name): &(String, String)| of == quantity && name == method;
        let index = self.library.methods.iter().position(named);
        let unsupported = || NoAnswer::NotOffered(format!("{} offers no method {method} for {quantity}", self.library.engine));
        let (index, quantity) = index.zip(Quantity::parse(quantity)).ok_or_else(unsupported)?;
        let (Some(robot), Some(built)) = (&self.robot, &mut self.built) else { return Err(failed("no model was prepared")) };
        let body = if quantity == Quantity::BodyJacobian { number(request, "body")? } else { 0 };
        if body >= robot.description.bodies.len() {
            return Err(failed(format!("there is no body {body}")));
        }
        built.ready(index, body)?;
        let (first, count) = (number(request, "first")?, number(request, "count")?);
        Ok((built, first, count, shape::of_value(quantity, robot, count)))
    }

    fn evaluate(&mut self, request: &Message) -> Answer {
        let (built, first, count, shape) = self.asked(request)?;
        if first.checked_add(count).is_none_or(|end| end > built.count()) {
            return Err(failed(format!("{count} states from {first} on do not exist")));
        }
        let size: usize = shape[1..].iter().product();
        let mut values = vec![0.0; count * size];
        // A robot that cannot move has no values.
        for (k, value) in values.chunks_exact_mut(size.max(1)).enumerate() {
            built.run(first + k, 1)?;
            built.read(value)?;
        }
        ok(json!({}), vec![Block::new("value", &shape, &values)])
    }

    fn clock(&mut self, request: &Message) -> Answer {
        let (built, first, count, _) = self.asked(request)?;
        let start = Instant::now();
        built.run(first, count)?;
        let elapsed = start.elapsed();
        ok(json!({"nanoseconds": u64::try_from(elapsed.as_nanos()).unwrap_or(u64::MAX)}), Vec::new())
    }
}

fn number(request: &Message, key: &str) -> Result<usize, NoAnswer> {
    let number = request.header.get(key).and_then(Value::as_u64).and_then(|number| usize::try_from(number).ok());
    number.ok_or_else(|| failed(format!("{key} must be a number")))
}
