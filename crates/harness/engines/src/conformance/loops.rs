//! Robots with loops, if an oracle holds them: requests without an answer, and a parallelogram whose acceleration and energy are known.
//!
//! Engines hold loops by different models, some of them soft. So what is asked for is the meaning of an answer, and not its digits.

use super::Standing;
use super::exchange::Exchange;
use crate::oracle::{loops, shaped};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Loop, LoopEnd, LoopKind, LoopMotion, Placement};
use featherbench_protocol::Block;
use serde_json::{Value, json};

/// How far an acceleration may be off, of its size: MuJoCo's default loop leaves up to a tenth.
const ACCELERATION: f64 = 0.1;
/// How far an angle may be off after 0.2 s with steps of 1 ms, rad: first order, or a soft loop.
const ANGLE: f64 = 0.02;
const GRAVITY: f64 = 9.81;

/// A parallelogram of rods of 1 kg and 1 m: cranks hang down, and the coupler only translates.
fn four_bar() -> Description {
    let rod = |name: &str, parent, place: [f64; 3], end: [f64; 3]| {
        let [x, _, z] = end;
        let thick = 1e-3;
        let joint = JointDescription {
            kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] },
            placement: Placement { translation: place, ..Placement::default() },
            ..JointDescription::default()
        };
        // About its own axis the inertia does not act; MuJoCo takes none that is zero.
        let inertia = [z * z / 12.0 + thick * x * x, 0.0, 0.0, 1.0 / 12.0, 0.0, x * x / 12.0 + thick * z * z];
        BodyDescription { name: name.into(), parent, mass: 1.0, com: end.map(|x| 0.5 * x), inertia, joint }
    };
    let (down, along) = ([0.0, 0.0, -1.0], [1.0, 0.0, 0.0]);
    let bodies = vec![rod("a", None, [0.0; 3], down), rod("b", Some(0), down, along), rod("c", None, along, down)];
    let about_y = |body, translation| {
        let rotation = [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0];
        LoopEnd { body: Some(body), placement: Placement { rotation, translation } }
    };
    let kind = LoopKind::Joint { ends: [about_y(2, down), about_y(1, along)], motion: LoopMotion::Revolute };
    let loops = vec![Loop { name: "hinge".into(), kind }];
    Description { name: "four-bar".into(), gravity: [0.0, 0.0, -GRAVITY], bodies, loops, ..Description::default() }
}

/// The cranks' acceleration at an angle: inertia 2/3 + 1, moment 2 g sin θ.
fn acceleration(angle: f64) -> f64 {
    -2.0 * GRAVITY * angle.sin() / (5.0 / 3.0)
}

fn spread(angle: f64) -> [f64; 3] {
    [angle, -angle, angle]
}

/// Asks for everything.
pub(super) fn ask(exchange: &mut Exchange, offered: &loops::Loops) {
    let mut blocks =
        vec![Block::new("q", &[1, 3], &spread(0.7)), Block::new("v", &[1, 3], &spread(0.5)), Block::new("tau", &[1, 3], &[0.0; 3])];
    let question = |method: &str| json!({"op": "loop_accelerations", "method": method, "count": 1, "repeats": 1});
    if let Some(first) = offered.accelerations.first() {
        exchange.expect("accelerations without a robot with loops are an error", question(first), blocks.clone(), &["error"]);
    }
    let model = match loops::model(&four_bar()) {
        Ok(model) => model,
        Err(refusal) => return exchange.note(Standing::Wrong, "our own robot with loops", &refusal.to_string(), &[]),
    };
    let mut gear = model.clone();
    gear["loops"][0]["type"] = "no such loop".into();
    exchange.expect("a loop of no known type is refused", json!({"op": "loops", "model": gear}), Vec::new(), &["error", "unsupported"]);
    if exchange.expect("a robot with loops is built", json!({"op": "loops", "model": model}), Vec::new(), &["ok"]).is_none() {
        return;
    }
    let nobody = question("no such method");
    exchange.expect("loops by a method that it does not have are unsupported", nobody, blocks.clone(), &["unsupported"]);
    for method in &offered.accelerations {
        let due = spread(acceleration(0.7));
        let answer = answered(exchange, question(method), blocks.clone(), &[("acceleration", &[1, 3])]);
        let what = format!("accelerations with loops by {method}");
        judge(exchange, &what, answer, |found| {
            found[0].iter().zip(due).all(|(found, due)| (found - due).abs() <= ACCELERATION * due.abs())
        });
    }
    blocks = vec![Block::new("q", &[3], &spread(0.7)), Block::new("v", &[3], &spread(0.0))];
    let motion = |method: &str, dt: f64| json!({"op": "loop_motion", "method": method, "dt": dt, "steps": 200, "every": 100});
    if let Some(first) = offered.motions.first() {
        exchange.expect("a motion with steps of zero is an error", motion(first, 0.0), blocks.clone(), &["error"]);
    }
    let (mut angle, mut rate) = (0.7, 0.0);
    for _ in 0..20_000 {
        // Semi-implicit steps of 10 µs: 1e-5 s of a fall of 0.2 s is far below what is asked.
        rate += 1e-5 * acceleration(angle);
        angle += 1e-5 * rate;
    }
    for method in &offered.motions {
        let answer = answered(exchange, motion(method, 1e-3), blocks.clone(), &[("q", &[2, 3]), ("v", &[2, 3])]);
        let what = format!("a motion with loops by {method}");
        judge(exchange, &what, answer, |found| {
            let near = |found: &[f64], due: [f64; 3], by: f64| found.iter().zip(due).all(|(found, due)| (found - due).abs() <= by);
            near(&found[0][3..], spread(angle), ANGLE) && near(&found[1][3..], spread(rate), 10.0 * ANGLE)
        });
    }
}

/// The blocks of an answer that has its time and settings.
fn answered(exchange: &mut Exchange, question: Value, blocks: Vec<Block>, due: &[(&str, &[usize])]) -> Result<Vec<Vec<f64>>, String> {
    let answer = exchange.ask(question, blocks)?;
    let found =
        due.iter().map(|(name, shape)| shaped(&answer, name, shape)).collect::<Result<_, _>>().map_err(|refusal| refusal.to_string())?;
    loops::told(&answer).map_err(|refusal| refusal.to_string())?;
    Ok(found)
}

fn judge(exchange: &mut Exchange, what: &str, answer: Result<Vec<Vec<f64>>, String>, right: impl Fn(&[Vec<f64>]) -> bool) {
    match answer {
        Err(reason) => exchange.note(Standing::Wrong, what, &reason, &[]),
        Ok(found) if right(&found) => exchange.note(Standing::Right, what, "those that a parallelogram has by hand", &[]),
        Ok(found) => {
            let advice = ["`v` and the acceleration are neutral", "gravity acts", "a revolute loop turns about z of both frames"];
            exchange.note(Standing::Wrong, what, &format!("far from those that a parallelogram has by hand: {found:?}"), &advice);
        }
    }
}
