//! The session: requests of `../../PROTOCOL.md` to a robot and its states, one answer each.

use crate::refusal::{Refusal, failed};
use crate::robot::{GUARD, QUANTITIES, Robot, STEPS, State};
use crate::scenes;
use featherbench_formats::neutral;
use featherbench_protocol::{Block, Message};
use serde_json::{Map, Value, json};
use std::ops::Range;

/// The robot and the states so far.
#[derive(Default)]
pub struct Session {
    robot: Option<Robot>,
    states: Option<States>,
}

/// The states that were sent, array by array.
struct States {
    count: usize,
    q: Vec<f64>,
    v: Vec<f64>,
    tau: Vec<f64>,
    probe: Vec<f64>,
}

impl Session {
    /// The answer to a request.
    pub fn answer(&mut self, request: &Message) -> Result<Message, Refusal> {
        match request.text("op") {
            "hello" => Ok(hello()),
            "prepare" => self.prepare(request),
            "states" => self.take_states(request),
            "evaluate" => self.evaluate(request),
            "step" => self.step(request),
            "fall" => self.fall(request),
            "scene" => scenes::simulate(request),
            "scene_derivative" => Err(Refusal::Unsupported("rapier has no derivatives".into())),
            "import" => Err(Refusal::Unsupported("rapier imports no files here".into())),
            other => Err(failed(format!("there is no op '{other}'"))),
        }
    }

    fn prepare(&mut self, request: &Message) -> Result<Message, Refusal> {
        (self.robot, self.states) = (None, None);
        let model = request.header.get("model").ok_or_else(|| failed("there is no model"))?;
        let robot = Robot::new(neutral::parse(&model.to_string(), "the model").map_err(failed)?)?;
        let readback = Block::new("readback", &[robot.description().bodies.len(), 22], &robot.readback()?);
        let header = json!({"nq": robot.description().nq(), "nv": robot.description().nv()});
        self.robot = Some(robot);
        Ok(Message::new(header, vec![readback]))
    }

    fn take_states(&mut self, request: &Message) -> Result<Message, Refusal> {
        self.states = None;
        let robot = self.robot.as_ref().ok_or_else(|| failed("there is no robot"))?.description();
        let (count, nq, nv) = (natural(request, "count")?, robot.nq(), robot.nv());
        let take = |name: &str, shape: [usize; 2]| {
            let block = request.block(name).filter(|block| block.shape == shape);
            block.map(|block| block.data.clone()).ok_or_else(|| failed(format!("the block {name} must be there with the shape {shape:?}")))
        };
        let (q, v, tau) = (take("q", [count, nq])?, take("v", [count, nv])?, take("tau", [count, nv])?);
        self.states = Some(States { count, q, v, tau, probe: take("probe", [4, nv])? });
        Ok(Message::default())
    }

    fn evaluate(&self, request: &Message) -> Result<Message, Refusal> {
        let (quantity, method) = (request.text("quantity"), request.text("method"));
        if !QUANTITIES.contains(&(quantity, method)) {
            return Err(Refusal::Unsupported(format!("rapier does not answer {quantity} by '{method}'")));
        }
        let (robot, states, range) = self.asked(request)?;
        let (nv, bodies) = (robot.description().nv(), robot.description().bodies.len());
        let jacobian = quantity == "body_jacobian";
        let body = if jacobian { natural(request, "body")? } else { 0 };
        if jacobian && body >= bodies {
            return Err(failed(format!("there is no body {body}")));
        }
        let shape: &[usize] = match quantity {
            "mass_matrix" => &[nv, nv],
            "mass_matrix_probe" | "body_jacobian" => &[6, nv],
            "body_placement" => &[bodies, 12],
            "body_velocity" => &[bodies, 6],
            "kinetic_energy" => &[1],
            _ => &[nv],
        };
        states.answer(range, shape, |state| robot.value(quantity, state, body))
    }

    fn step(&self, request: &Message) -> Result<Message, Refusal> {
        let (settings, dt) = steps(request)?;
        let (robot, states, range) = self.asked(request)?;
        states.answer(range, &[robot.description().nv()], |state| robot.step(state, settings, dt))
    }

    fn fall(&self, request: &Message) -> Result<Message, Refusal> {
        let ((settings, dt), count) = (steps(request)?, natural(request, "steps")?);
        let (robot, states, range) = self.asked(request)?;
        states.answer(range, &[count], |state| robot.fall(state, settings, dt, count))
    }

    /// The robot, the states, and which of them a request is about.
    fn asked(&self, request: &Message) -> Result<(&Robot, &States, Range<usize>), Refusal> {
        let robot = self.robot.as_ref().ok_or_else(|| failed("there is no robot"))?;
        let states = self.states.as_ref().ok_or_else(|| failed("there are no states"))?;
        let (first, count) = (natural(request, "first")?, natural(request, "count")?);
        let end = first.checked_add(count).filter(|&end| end <= states.count);
        let end = end.ok_or_else(|| failed(format!("{count} states from {first} on were not sent; there are {}", states.count)))?;
        Ok((robot, states, first..end))
    }
}

impl States {
    /// The block `value` with the results at each state of a range.
    fn answer(&self, range: Range<usize>, shape: &[usize], value: impl Fn(State) -> Result<Vec<f64>, Refusal>) -> Result<Message, Refusal> {
        let (nq, nv) = (self.q.len() / self.count.max(1), self.probe.len() / 4);
        let (shape, mut values) = ([&[range.len()], shape].concat(), Vec::new());
        for k in range {
            let (q, v) = (k * nq..(k + 1) * nq, k * nv..(k + 1) * nv);
            values.extend(value(State { q: &self.q[q], v: &self.v[v.clone()], tau: &self.tau[v], probe: &self.probe })?);
        }
        Ok(Message::new(json!({}), vec![Block::new("value", &shape, &values)]))
    }
}

/// The answer to `hello`.
fn hello() -> Message {
    let methods: Map<String, Value> = QUANTITIES.iter().map(|&(quantity, method)| (quantity.to_owned(), json!([method]))).collect();
    let steps = STEPS.map(|(method, _)| method);
    Message::new(
        json!({
            "protocol": 1,
            "engine": "rapier",
            "version": env!("RAPIER_VERSION"),
            "build": {"language": "Rust (crate rapier3d-f64)", "compiler": env!("RAPIER_COMPILER")},
            "methods": methods,
            "steps": {"methods": steps, "guard": GUARD},
            "scenes": scenes::offered(),
        }),
        Vec::new(),
    )
}

/// A whole number of a request.
fn natural(request: &Message, key: &str) -> Result<usize, Refusal> {
    let number = request.header.get(key).and_then(Value::as_u64).and_then(|number| usize::try_from(number).ok());
    number.ok_or_else(|| failed(format!("'{key}' must be a whole number")))
}

/// The way to step that a request names, and its length.
fn steps(request: &Message) -> Result<(crate::world::Settings, f64), Refusal> {
    let method = request.text("method");
    let found = STEPS.iter().find(|(name, _)| *name == method);
    let (_, settings) = found.ok_or_else(|| Refusal::Unsupported(format!("rapier has no steps by '{method}'")))?;
    let dt = request.header.get("dt").and_then(Value::as_f64).filter(|dt| dt.is_finite() && *dt > 0.0);
    Ok((*settings, dt.ok_or_else(|| failed("'dt' must be a positive number of seconds"))?))
}
