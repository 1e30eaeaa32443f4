//! Scenes, if an oracle moves them: requests without an answer, repetition, a ball in flight and a ball at rest, whose motions are known.

use super::Standing;
use super::exchange::Exchange;
use crate::oracle::scenes::{motion, question};
use featherbench_scenes::{Body, Motion, Scene, Variant};
use serde_json::Value;

/// The step, s, and how many.
const DT: f64 = 1e-3;
const STEPS: usize = 500;
const MASS: f64 = 2.0;
const GRAVITY: f64 = 10.0;
const RADIUS: f64 = 0.1;
/// The flight: along x, and about z.
const SPEED: f64 = 0.5;
const RATE: f64 = 2.0;
/// The largest error of the flight, in m, m/s and of the turn: a step of order one over half a second is off by half of `g T dt`, 2.5e-3.
const NEAR: f64 = 5e-3;
/// The largest share of the weight by which a resting ball's force is off. Soft contacts have settled after half a second.
const HELD: f64 = 1e-2;

fn scene(body: Body) -> Scene {
    Scene { name: "ball".into(), gravity: [0.0, 0.0, -GRAVITY], friction: 0.5, restitution: 0.0, bodies: vec![body] }
}

fn flying() -> Scene {
    let mut ball = Body::ball("ball", MASS, RADIUS, [0.0, 0.0, 5.0]);
    (ball.linear, ball.angular) = ([SPEED, 0.0, 0.0], [0.0, 0.0, RATE]);
    scene(ball)
}

fn resting() -> Scene {
    scene(Body::ball("ball", MASS, RADIUS, [0.0, 0.0, RADIUS]))
}

/// A change of a question.
type Change = fn(&mut Value);

/// Asks for everything.
pub(super) fn ask(exchange: &mut Exchange, variants: &[Variant]) {
    let Some(first) = variants.first() else { return };
    let asked = || question(&flying(), &first.name, DT, STEPS, STEPS);
    let changed = |change: Change| {
        let mut question = asked();
        change(&mut question);
        question
    };
    let wrong: [(&str, Change); 4] = [
        ("a scene with a step of zero is an error", |question| question["dt"] = 0.0.into()),
        ("a scene without samples is an error", |question| question["every"] = 0.into()),
        ("a scene without bodies is an error", |question| question["scene"]["bodies"] = Value::Array(Vec::new())),
        ("a scene with a negative mass is an error", |question| question["scene"]["bodies"][0]["mass"] = (-1.0).into()),
    ];
    for (what, change) in wrong {
        exchange.expect(what, changed(change), Vec::new(), &["error"]);
    }
    let nobody = changed(|question| question["variant"] = "no such variant".into());
    exchange.expect("a scene by a variant that it does not have is unsupported", nobody, Vec::new(), &["unsupported"]);
    for variant in variants {
        moved(exchange, &variant.name);
    }
}

fn moved(exchange: &mut Exchange, variant: &str) {
    let what = format!("scenes by {variant}");
    let mut answer = |scene: &Scene| -> Result<Motion, String> {
        let answer = exchange.ask(question(scene, variant, DT, STEPS, STEPS), Vec::new())?;
        motion(&answer, 1, 1).map_err(|refusal| refusal.to_string())
    };
    let answers = answer(&flying()).and_then(|flight| Ok((flight, answer(&resting())?, answer(&resting())?)));
    let (flight, rest, again) = match answers {
        Ok(answers) => answers,
        Err(reason) => return exchange.note(Standing::Wrong, &what, &reason, &[]),
    };
    if rest != again {
        return exchange.note(Standing::Wrong, &what, "the same scene has another motion when it is asked again", &[]);
    }
    let (time, place, turn) = (DT * STEPS as f64, flight.position(0, 0), flight.orientation(0, 0));
    let turned = nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::z() * (RATE * time));
    let errors = [
        place.x - SPEED * time,
        place.z - (5.0 - GRAVITY * time * time / 2.0),
        flight.linear(0, 0).z + GRAVITY * time,
        flight.angular(0, 0).z - RATE,
        turn.angle_to(&turned),
    ];
    let force: f64 = rest.pushes.iter().map(|push| push.force.z).sum();
    // A NaN is not near.
    let flies = errors.iter().all(|error| error.abs() <= NEAR);
    if flies && (force / (MASS * GRAVITY) - 1.0).abs() <= HELD {
        return exchange.note(Standing::Right, &what, "a ball flies and rests as it should", &[]);
    }
    let advice = [
        "velocities are in world axes at the centre of mass; quaternions are (x, y, z, w), body to world",
        "a contact's force is that on the first body of its row, in world axes; -1 is the ground",
    ];
    exchange.note(
        Standing::Wrong,
        &what,
        &format!("errors of a flight are {errors:?}, a weight of {} is held by {force}", MASS * GRAVITY),
        &advice,
    );
}
