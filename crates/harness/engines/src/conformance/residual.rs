//! A residual, if an oracle has one: shapes, repetition, ranges, requests without an answer, finite numbers, and what it says of accelerations.
//!
//! Which residual it is only its author knows. So values are not compared; what the harness does with them must hold.
//! - Without `"acceleration": true`, r is the same to the bit whatever the acceleration is.
//! - With it, the harness takes ∂r/∂a from accelerations that differ by one. So r must be affine in a: r(a) − 2 r(a + d) + r(a + 2 d) = 0.

use super::answers::{numbers, repeated};
use super::exchange::Exchange;
use super::values::{Scene, same_bits};
use super::{Standing, robots};
use crate::oracle::residual::Offered;
use crate::request::states;
use featherbench_bench::measure::worst;
use featherbench_robots::StateBatch;
use serde_json::{Value, json};

/// The largest second difference, in the largest of its terms. Three terms of some hundred roundings each are below it, and an r that is quadratic
/// in a has one of order one.
const AFFINE: f64 = 1e-10;

/// What was found of all robots: how many answered, and the largest second difference.
#[derive(Default)]
struct Found {
    robots: usize,
    bent: Vec<(&'static str, f64)>,
}

/// Asks for the residual of each robot.
pub(super) fn ask(exchange: &mut Exchange, scenes: &[Scene], offered: Offered) {
    exchange.expect("a residual before states is an error", question(0, 1), Vec::new(), &["error", "unsupported"]);
    let mut found = Found::default();
    for scene in scenes {
        of_robot(exchange, scene, offered, &mut found);
    }
    if found.robots == 0 {
        return exchange.note(
            Standing::Wrong,
            "residual",
            "it has a residual in its `hello`, and answers it for none of the test's robots",
            &[],
        );
    }
    let largest = found.bent.iter().map(|(_, bent)| *bent).fold(0.0, worst);
    // A NaN is not small.
    let first = found.bent.iter().find(|(_, bent)| !matches!(bent.partial_cmp(&AFFINE), Some(order) if order.is_le()));
    match first {
        Some((shows, bent)) => {
            let reason =
                format!("the second difference of r by the acceleration is {bent:.1e} of its terms for {shows} (at most {AFFINE:.0e})");
            let advice = ["r must be affine in the acceleration: the harness takes ∂r/∂a from accelerations that differ by one"];
            exchange.note(Standing::Wrong, "residual", &reason, &advice);
        }
        None if offered.acceleration => {
            exchange.note(Standing::Right, "residual", &format!("{} robots, affine in a to {largest:.1e}", found.robots), &[]);
        }
        None => exchange.note(Standing::Right, "residual", &format!("{} robots, the same for any acceleration", found.robots), &[]),
    }
}

fn question(first: usize, count: usize) -> Value {
    json!({"op": "residual", "first": first, "count": count})
}

/// The residual of one robot.
fn of_robot(exchange: &mut Exchange, scene: &Scene, offered: Offered, found: &mut Found) {
    let robot = &scene.robot;
    match exchange.prepare(robot) {
        Ok(built) if built.text("status") == "ok" => {}
        Ok(built) => return exchange.note(Standing::Lacks, scene.shows, built.text("reason"), &[]),
        Err(reason) => return exchange.note(Standing::Wrong, scene.shows, &reason, &[]),
    }
    exchange.expect("a residual of a robot without states is an error", question(0, 1), Vec::new(), &["error"]);
    let Some(value) = at(exchange, scene, &robot.states) else { return };
    exchange.expect("a residual beyond the states is an error", question(robots::STATES, 1), Vec::new(), &["error"]);
    if let Some(k) = value.iter().position(|x| !x.is_finite()) {
        let (state, nv) = (k / robot.states.nv, robot.states.nv);
        let reason = format!("{}: number {} of state {state} is {}", scene.shows, k % nv, value[k]);
        return exchange.note(Standing::Wrong, "residual", &reason, &["an r that is not finite is an `error` with its reason"]);
    }
    found.robots += 1;
    let moved = |steps: f64| {
        let mut moved = robot.states.clone();
        moved.a.iter_mut().for_each(|a| *a += steps);
        moved
    };
    let Some(once) = at(exchange, scene, &moved(1.0)) else { return };
    if !offered.acceleration {
        if !same_bits(&once, &value) {
            let advice = ["say \"residual\": {\"acceleration\": true} in `hello`, or let r depend on q, v and tau alone"];
            let reason = format!("{}: r changes with the acceleration, and `hello` says that it does not", scene.shows);
            exchange.note(Standing::Wrong, "residual", &reason, &advice);
        }
        return;
    }
    let Some(twice) = at(exchange, scene, &moved(2.0)) else { return };
    let terms =
        value.iter().zip(&once).zip(&twice).map(|((r, once), twice)| (r - 2.0 * once + twice, r.abs().max(once.abs()).max(twice.abs())));
    let (mut bent, mut size) = (0.0, 0.0);
    for (difference, term) in terms {
        (bent, size) = (worst(bent, difference.abs()), worst(size, term));
    }
    found.bent.push((scene.shows, if size == 0.0 { bent } else { bent / size }));
}

/// r at states, asked for in several ways.
fn at(exchange: &mut Exchange, scene: &Scene, batch: &StateBatch) -> Option<Vec<f64>> {
    let (header, blocks) = states(&scene.robot, batch);
    exchange.expect("states are taken", header, blocks, &["ok"])?;
    let nv = scene.robot.states.nv;
    repeated(exchange, "residual", nv, |exchange, first, count| numbers(exchange, scene, "residual", question(first, count), &[count, nv]))
}
