//! Steps of a robot on its contacts, if an oracle makes them: requests without an answer, repetition, and a body that lands.
//!
//! Engines have models of contact of their own, some of them soft. So what is asked for is the meaning of an impulse, and not its digits.

use super::Standing;
use super::exchange::Exchange;
use crate::oracle::{contacts, own_time, shaped};
use featherbench_bench::{ContactSteps, StepMethod};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType};
use serde_json::{Value, json};

/// How far an impulse may be off, of the normal one. A soft contact leaves some hundredths; mistaken rows or units cause errors of one.
const NEAR: f64 = 0.05;
const MASS: f64 = 2.0;
const FALL: f64 = 0.4;
const GRAVITY: f64 = 9.81;
const STEP: f64 = 1e-3;

/// A body on a free joint whose lowest point is below its centre, at two states: it falls, and it falls sideways with friction enough.
fn steps() -> ContactSteps {
    let joint = JointDescription { kind: JointType::Free, ..JointDescription::default() };
    // So large that the body does not turn by friction.
    let inertia = [1e3, 0.0, 0.0, 1e3, 0.0, 1e3];
    let body = BodyDescription { name: "lander".into(), parent: None, mass: MASS, com: [0.0; 3], inertia, joint };
    let robot = Description { name: "lander".into(), gravity: [0.0, 0.0, -GRAVITY], bodies: vec![body], ..Description::default() };
    ContactSteps {
        robot,
        dt: STEP,
        bodies: vec![0],
        points: vec![0.0, 0.0, -0.5],
        friction: vec![0.9],
        count: 2,
        q: [[0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0]; 2].concat(),
        v: [[0.0, 0.0, -FALL, 0.0, 0.0, 0.0], [0.2, -0.1, -FALL, 0.0, 0.0, 0.0]].concat(),
        tau: vec![0.0; 12],
    }
}

/// The impulses along z, x, y that stop the point: m (v + g dt), and m v sideways.
const DUE: [f64; 6] = [MASS * (FALL + GRAVITY * STEP), 0.0, 0.0, MASS * (FALL + GRAVITY * STEP), -MASS * 0.2, MASS * 0.1];

/// Asks for everything.
pub(super) fn ask(exchange: &mut Exchange, methods: &[StepMethod]) {
    let Some(first) = methods.first() else { return };
    exchange.expect("a step on contacts without a robot is an error", question(&first.name, 0, 1), Vec::new(), &["error"]);
    let refused = |exchange: &mut Exchange, what: &str, change: fn(&mut ContactSteps)| {
        let mut wrong = steps();
        change(&mut wrong);
        match contacts::steps_request(&wrong) {
            Ok((header, blocks)) => exchange.expect(what, header, blocks, &["error"]),
            Err(refusal) => {
                exchange.note(Standing::Wrong, what, &refusal.to_string(), &[]);
                None
            }
        }
    };
    refused(exchange, "a step with a negative friction is an error", |wrong| wrong.friction[0] = -0.1);
    refused(exchange, "a step from NaN is an error", |wrong| wrong.v[3] = f64::NAN);
    refused(exchange, "a step of zero is an error", |wrong| wrong.dt = 0.0);
    let kept = match contacts::steps_request(&steps()) {
        Ok((header, blocks)) => exchange.expect("a robot on its contacts is kept", header, blocks, &["ok"]),
        Err(_) => None,
    };
    if kept.is_none() {
        return;
    }
    let nobody = question("no such method", 0, 1);
    exchange.expect("a step by a method that it does not have is unsupported", nobody, Vec::new(), &["unsupported"]);
    for StepMethod { name, .. } in methods {
        stepped(exchange, name);
    }
}

fn question(method: &str, first: usize, count: usize) -> Value {
    json!({"op": "solve_contact_steps", "method": method, "first": first, "count": count, "tolerance": 1e-12, "iterations": 1000})
}

/// Both states, twice; and the first again after the second, as states begin again.
fn stepped(exchange: &mut Exchange, method: &str) {
    let what = format!("a step on contacts by {method}");
    let mut answer = |first| -> Result<Vec<f64>, String> {
        let answer = exchange.ask(question(method, first, 2), Vec::new())?;
        own_time(&answer).map_err(|refusal| refusal.to_string())?;
        shaped(&answer, "impulses", &[2, 3]).map_err(|refusal| refusal.to_string())
    };
    let answers = answer(0).and_then(|once| Ok((once, answer(0)?, answer(1)?)));
    let (once, again, around) = match answers {
        Ok(answers) => answers,
        Err(reason) => return exchange.note(Standing::Wrong, &what, &reason, &[]),
    };
    let bits = |impulses: &[f64]| impulses.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    if bits(&once) != bits(&again) || bits(&around) != bits(&[&once[3..], &once[..3]].concat()) {
        let advice = ["each solution begins at impulses of zero, whatever was asked before"];
        return exchange.note(Standing::Wrong, &what, "the same state has other impulses when it is asked again", &advice);
    }
    // A NaN is not near.
    if once.iter().zip(DUE).all(|(found, due)| (found - due).abs() <= NEAR * DUE[0]) {
        return exchange.note(Standing::Right, &what, "the impulses that stop a landing body", &[]);
    }
    let advice = ["the rows of a point are z, x, y", "impulses are those of one step, N·s, and act on the robot"];
    exchange.note(Standing::Wrong, &what, &format!("the impulses are {once:?}; due are {DUE:?}"), &advice);
}
