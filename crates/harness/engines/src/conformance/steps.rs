//! Steps, if an oracle offers them: shapes, repetition, ranges, requests without an answer. A short step must begin with featherbench's
//! acceleration, and a short fall must keep its energy.

use super::answers::{numbers, repeated};
use super::exchange::Exchange;
use super::values::Scene;
use super::{Standing, robots};
use crate::oracle::steps::Steps;
use featherbench_bench::Quantity;
use featherbench_bench::measure::worst;
use serde_json::{Value, json};

/// A length of a step, s. It is so short that at every state its own error is small, and so is the rounding of a difference of velocities.
const SHORT: f64 = 1e-9;
/// The largest error of such a step's acceleration, in the measure of forward dynamics; mistaken conventions cause a larger one.
const NEAR: f64 = 1e-4;
/// A fall from the first state: the length of its steps, s, and their number.
const FALL: (f64, usize) = (2e-5, 100);
/// The largest drift of its energy, in the measure of the potential energy.
const HELD: f64 = 1e-4;

/// The errors of the first method to step, which has no extras: robot by robot.
#[derive(Default)]
pub(super) struct Found {
    accelerations: Vec<(&'static str, f64)>,
    energies: Vec<(&'static str, f64)>,
}

/// Asks for steps of the robot from the states that the oracle has.
pub(super) fn ask(exchange: &mut Exchange, scene: &Scene, steps: &Steps, found: &mut Found) {
    let Some(plain) = steps.methods.first() else { return };
    unanswerable(exchange, plain);
    for method in &steps.methods {
        let accelerations = answers(exchange, scene, question("step", method, SHORT), scene.robot.states.nv);
        let energies = answers(exchange, scene, question("fall", method, FALL.0), FALL.1);
        if method != plain {
            continue;
        }
        let due = accelerations.zip(scene.featherbench(Quantity::ForwardDynamics));
        found.accelerations.extend(due.map(|(value, due)| (scene.shows, scene.error(Quantity::ForwardDynamics, &due, &value))));
        found.energies.extend(energies.and_then(|value| Some((scene.shows, scene.drift(&value[..FALL.1])?))));
    }
}

/// Notes the findings about all robots.
pub(super) fn judge(exchange: &mut Exchange, steps: &Steps, found: &Found) {
    let Some(plain) = steps.methods.first() else { return };
    let accelerations = [
        "a short step begins with the acceleration of forward dynamics: in neutral coordinates, under gravity and the state's tau",
        "the first way to step has no damping, friction, limits or contacts of the engine's own",
    ];
    let energies = [
        "a fall is under gravity alone, without tau; its energies are those *after* each step, kinetic (armature included) and potential",
        "the potential energy is zero at the world's origin",
    ];
    let about = [("step", &found.accelerations, NEAR, accelerations), ("fall", &found.energies, HELD, energies)];
    for (op, errors, tolerance, advice) in about {
        let (named, largest) = (format!("{op} by {plain}"), errors.iter().map(|(_, error)| *error).fold(0.0, worst));
        // A NaN is not a small error.
        let wrong: Vec<_> = errors.iter().filter(|(_, error)| !matches!(error.partial_cmp(&tolerance), Some(o) if o.is_le())).collect();
        match wrong.first() {
            None if errors.is_empty() => {}
            None => exchange.note(Standing::Right, &named, &format!("{} robots, largest error {largest:.1e}", errors.len()), &[]),
            Some((shows, error)) => {
                let (some, all) = (wrong.len(), errors.len());
                let reason = format!("{some} of {all} robots are off, the first being {shows} by {error:.1e} (at most {tolerance:.0e})");
                exchange.note(Standing::Wrong, &named, &reason, &advice);
            }
        }
    }
}

/// A question about one state.
fn question(op: &str, method: &str, dt: f64) -> Value {
    json!({"op": op, "method": method, "first": 0, "count": 1, "dt": dt, "steps": FALL.1})
}

/// Requests for steps that have no answer.
fn unanswerable(exchange: &mut Exchange, method: &str) {
    for op in ["step", "fall"] {
        let nothing = question(op, "no such way", SHORT);
        exchange.expect(&format!("a {op} by a way that it does not have is unsupported"), nothing, Vec::new(), &["unsupported"]);
    }
    // The oracle may report first what the robot does not have.
    let refused = ["error", "unsupported"];
    for op in ["step", "fall"] {
        exchange.expect(&format!("a {op} of no length is refused"), question(op, method, 0.0), Vec::new(), &refused);
        let mut beyond = question(op, method, SHORT);
        beyond["first"] = robots::STATES.into();
        exchange.expect(&format!("a {op} from a state that was not sent is refused"), beyond, Vec::new(), &refused);
    }
}

/// The answers at every state, each with this number of values, asked for in several ways.
fn answers(exchange: &mut Exchange, scene: &Scene, question: Value, size: usize) -> Option<Vec<f64>> {
    let named = format!("{} by {}", question["op"].as_str()?, question["method"].as_str()?);
    repeated(exchange, &named, size, |exchange, first, count| {
        let mut header = question.clone();
        (header["first"], header["count"]) = (first.into(), count.into());
        numbers(exchange, scene, &named, header, &[count, size])
    })
}
