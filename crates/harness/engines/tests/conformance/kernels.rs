//! Our own kernels as an oracle in this process.

use featherbench_bench::{Engine, NoAnswer, Quantity, Robot, layout};
use featherbench_dynamics::Jacobian;
use featherbench_engines::Featherbench;
use featherbench_engines::conformance::Connection;
use featherbench_formats::urdf::{self, Base, Options};
use featherbench_protocol::{Block, Message};
use featherbench_results::ModelOrigin;
use featherbench_robots::StateBatch;
use serde_json::{Value, json};

/// The changes of requests before the right oracle gets them, and of its answers before they are sent.
#[derive(Clone, Copy)]
pub struct Plant {
    /// Whether it offers the derivatives too, by this method.
    pub derivatives: Option<&'static str>,
    pub request: fn(&mut Message, &Kernels),
    pub answer: fn(&mut Message, &Message, &Kernels),
}

/// No changes.
pub const HONEST: Plant = Plant { derivatives: None, request: |_, _| (), answer: |_, _, _| () };

/// Our own kernels as an oracle.
pub struct Kernels {
    plant: Plant,
    pub robot: Option<Robot>,
    /// The states as they were received.
    states: Option<(Message, StateBatch)>,
    /// Whether the robot was imported from a file.
    as_read: bool,
    /// Evaluations so far.
    pub evaluated: usize,
}

/// What it offers.
pub const OFFERED: [Quantity; 14] = [
    Quantity::InverseDynamics,
    Quantity::InverseDynamicsWrench,
    Quantity::Bias,
    Quantity::MassMatrix,
    Quantity::ForwardDynamics,
    Quantity::KineticEnergy,
    Quantity::PotentialEnergy,
    Quantity::CenterOfMass,
    Quantity::Momentum,
    Quantity::BodyPlacement,
    Quantity::BodyVelocity,
    Quantity::BodyAcceleration,
    Quantity::BodyJacobian,
    Quantity::StoredEntries,
];

/// The quantities of an imported robot.
const AS_READ: [Quantity; 5] =
    [Quantity::InverseDynamics, Quantity::Bias, Quantity::MassMatrix, Quantity::ForwardDynamics, Quantity::KineticEnergy];

fn failed(reason: impl ToString) -> NoAnswer {
    NoAnswer::Failed(reason.to_string())
}

impl Kernels {
    /// An oracle without a robot.
    pub fn new(plant: Plant) -> Self {
        Self { plant, robot: None, states: None, as_read: false, evaluated: 0 }
    }

    fn derivatives(&self) -> impl Iterator<Item = (Quantity, &'static str)> + use<> {
        let method = self.plant.derivatives;
        Quantity::DERIVATIVES.into_iter().filter_map(move |quantity| Some((quantity, method?)))
    }

    fn answer(&mut self, request: &Message) -> Result<Message, NoAnswer> {
        let number =
            |key: &str| request.header.get(key).and_then(Value::as_u64).map(|n| n as usize).ok_or_else(|| failed("a number is missing"));
        match request.text("op") {
            "hello" => {
                let mut methods: serde_json::Map<String, Value> = OFFERED.iter().map(|q| (q.name().into(), json!(["kernel"]))).collect();
                methods.extend(self.derivatives().map(|(quantity, method)| (quantity.name().into(), json!([method]))));
                Ok(Message::new(json!({"protocol": 1, "engine": "kernels", "version": "1", "build": {}, "methods": methods}), Vec::new()))
            }
            "prepare" => {
                (self.robot, self.states, self.as_read) = (None, None, false);
                let model = request.header.get("model").ok_or_else(|| failed("there is no model"))?;
                let description = featherbench_formats::neutral::parse(&model.to_string(), "request").map_err(failed)?;
                let robot = Robot::new(&description, "", ModelOrigin::Generated, 1, 0).map_err(failed)?;
                let readback = Block::new("readback", &[robot.description.bodies.len(), 22], &robot.readback());
                let header = json!({"nq": robot.description.nq(), "nv": robot.states.nv});
                self.robot = Some(robot);
                Ok(Message::new(header, vec![readback]))
            }
            "import" => {
                (self.robot, self.states, self.as_read) = (None, None, true);
                if request.text("format") != "urdf" {
                    return Err(NoAnswer::NotOffered("the kernels read URDF alone".into()));
                }
                let base = if request.text("base") == "free" { Base::Floating } else { Base::Fixed };
                let (description, _) = urdf::read(request.text("file"), &Options { base, ..Options::default() }).map_err(failed)?;
                let robot = Robot::new(&description, "", ModelOrigin::Robot, 1, 0).map_err(failed)?;
                let model: Value =
                    serde_json::from_str(&featherbench_formats::neutral::to_string(&description).map_err(failed)?).map_err(failed)?;
                let header = json!({"nq": description.nq(), "nv": description.nv(), "model": model, "notes": []});
                self.robot = Some(robot);
                Ok(Message::new(header, Vec::new()))
            }
            "states" => {
                self.states = None;
                let (count, robot) = (number("count")?, self.robot.as_ref().ok_or_else(|| failed("there is no robot"))?);
                let empty = &robot.states;
                let take = |name: &str, each: usize| {
                    let block = request.block(name).filter(|block| block.data.len() == count * each);
                    block.map(|block| block.data.clone()).ok_or_else(|| failed(format!("block {name} is missing or has another length")))
                };
                let batch = StateBatch {
                    cases: vec![featherbench_robots::Case::Random; count],
                    q: take("q", empty.nq)?,
                    v: take("v", empty.nv)?,
                    a: take("a", empty.nv)?,
                    tau: take("tau", empty.nv)?,
                    wrench: take("wrench", 6 * empty.bodies)?,
                    ..empty.clone()
                };
                self.states = Some((request.clone(), batch));
                Ok(Message::default())
            }
            "evaluate" => {
                let mut offered = OFFERED.into_iter().map(|quantity| (quantity, "kernel")).chain(self.derivatives());
                let asked = (Quantity::parse(request.text("quantity")), request.text("method"));
                let quantity = offered.find(|(quantity, method)| asked == (Some(*quantity), method)).map(|(quantity, _)| quantity);
                let quantity = quantity.ok_or_else(|| NoAnswer::NotOffered("there is no such kernel".into()))?;
                if self.as_read && !AS_READ.contains(&quantity) {
                    return Err(NoAnswer::NotOffered("a robot as read has no such answer".into()));
                }
                let (Some(robot), Some((_, states))) = (&self.robot, &self.states) else { return Err(failed("nothing to evaluate")) };
                let (first, count) = (number("first")?, number("count")?);
                if first + count > states.count() {
                    return Err(failed("there are no such states"));
                }
                self.evaluated += 1;
                let shape: Vec<usize> = std::iter::once(count).chain(quantity.shape(robot)).collect();
                if quantity == Quantity::BodyJacobian {
                    let (model, body) = (&robot.model, number("body")?);
                    let body = *robot.model.described.get(body).ok_or_else(|| failed("there is no such body"))?;
                    let mut value = vec![0.0; shape.iter().product()];
                    for (k, out) in (first..first + count).zip(value.chunks_exact_mut(quantity.size(robot))) {
                        let mut work = Jacobian::new(&model.topology);
                        layout::jacobian(work.run(model, states.q(k), body).map_err(failed)?, out);
                    }
                    return Ok(Message::new(json!({}), vec![Block::new("value", &shape, &value)]));
                }
                let featherbench = Featherbench::new();
                let method = featherbench.methods(quantity).swap_remove(0);
                let mut prepared = featherbench.prepare(robot, quantity, &method, states)?;
                prepared.run(first..first + count)?;
                Ok(Message::new(json!({}), vec![Block::new("value", &shape, prepared.read())]))
            }
            "residual" => {
                let (Some(robot), Some((_, states))) = (&self.robot, &self.states) else { return Err(failed("nothing to correct")) };
                let (first, count) = (number("first")?, number("count")?);
                if first + count > states.count() {
                    return Err(failed("there are no such states"));
                }
                let nv = robot.states.nv;
                let range = first * nv..(first + count) * nv;
                let r: Vec<f64> = states.v[range.clone()].iter().zip(&states.a[range]).map(|(v, a)| 0.3 * v + 0.2 * a).collect();
                Ok(Message::new(json!({}), vec![Block::new("value", &[count, nv], &r)]))
            }
            op @ ("step" | "fall") => self.step(op, request),
            other => Err(failed(format!("there is no op '{other}'"))),
        }
    }
}

impl Kernels {
    /// An integrator without error: steps begin with the acceleration of forward dynamics, and a fall keeps its energy.
    fn step(&self, op: &str, request: &Message) -> Result<Message, NoAnswer> {
        let number = |key: &str| request.header.get(key).and_then(Value::as_u64).map(|n| n as usize).unwrap_or_default();
        if request.text("method") != "exact" {
            return Err(NoAnswer::NotOffered("there is no such way to step".into()));
        }
        let dt = request.header.get("dt").and_then(Value::as_f64).unwrap_or_default();
        let (Some(robot), Some((_, states))) = (&self.robot, &self.states) else { return Err(failed("nothing to step")) };
        let (first, count) = (number("first"), number("count"));
        if dt <= 0.0 || first + count > states.count() {
            return Err(failed("there is no such step"));
        }
        let featherbench = Featherbench::new();
        let values = |quantity: Quantity| {
            let method = featherbench.methods(quantity).swap_remove(0);
            let mut prepared = featherbench.prepare(robot, quantity, &method, states)?;
            prepared.run(first..first + count)?;
            Ok::<_, NoAnswer>(prepared.read().to_vec())
        };
        let (each, value) = if op == "step" {
            (robot.states.nv, values(Quantity::ForwardDynamics)?)
        } else {
            let (kinetic, potential) = (values(Quantity::KineticEnergy)?, values(Quantity::PotentialEnergy)?);
            let steps = number("steps");
            (steps, kinetic.iter().zip(potential).flat_map(|(k, p)| vec![k + p; steps]).collect())
        };
        Ok(Message::new(json!({}), vec![Block::new("value", &[count, each], &value)]))
    }
}

impl Connection for Kernels {
    fn ask(&mut self, request: &Message) -> Result<Message, String> {
        let plant = self.plant;
        let mut heard = request.clone();
        (plant.request)(&mut heard, self);
        let mut answer = match self.answer(&heard) {
            Ok(mut message) => {
                message.header.insert("status".into(), "ok".into());
                message
            }
            Err(NoAnswer::NotOffered(reason)) => Message::new(json!({"status": "unsupported", "reason": reason}), Vec::new()),
            Err(NoAnswer::Failed(reason)) => Message::new(json!({"status": "error", "reason": reason}), Vec::new()),
        };
        (plant.answer)(&mut answer, request, self);
        if answer.text("status") == "dead" { Err("the oracle exited".into()) } else { Ok(answer) }
    }

    fn close(self: Box<Self>) -> Result<(), String> {
        Ok(())
    }
}
