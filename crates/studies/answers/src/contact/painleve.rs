//! Painlevé's rod: how many normal forces obey the laws, at each angle and rate.

use super::{Case, Number, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_contact::systems::{Answers, PainleveRod};
use featherbench_contact::{Enumeration, Solver};
use serde_json::json;
use std::f64::consts::FRAC_PI_2;

/// μ, above the critical 4/3.
const FRICTION: f64 = 1.5;
/// Angles and rates of the map, each.
const MAP: usize = 25;
/// The largest rate of the map, rad/s.
const FASTEST: f64 = 5.0;
/// The angles at which the change is located.
const ANGLES: usize = 60;
/// A rate at which every rod of these angles would leave the ground, rad/s.
const BEYOND: f64 = 100.0;

/// Every case.
pub(super) fn cases() -> Vec<Case> {
    (0..ANGLES).map(change).chain([paradox(), map()]).collect()
}

/// The rod at the middle of interval `k` of so many between 0 and 90°.
fn at(k: usize, of: usize) -> PainleveRod {
    PainleveRod { friction: FRICTION, angle: FRAC_PI_2 * (k as f64 + 0.5) / of as f64, ..PainleveRod::default() }
}

/// How many forces obey the laws, by enumeration.
fn forces(rod: &PainleveRod) -> Result<usize, NoAnswer> {
    Ok(Enumeration::default().solve(&rod.problem().map_err(failed)?).map_err(failed)?.points().len())
}

/// The same by the signs of p and b.
fn known(rod: &PainleveRod) -> usize {
    match rod.answers() {
        Answers::None => 0,
        Answers::Two => 2,
        Answers::Contact | Answers::LiftOff => 1,
    }
}

/// p = 0 at the ends of the paradox, which vanishes at the critical friction.
fn paradox() -> Case {
    Case {
        name: "painleve_rod, paradox".into(),
        quantity: "contact_quantity",
        method: "closed form".into(),
        params: json!({"friction": FRICTION}),
        numbers: vec![error("error", "closed form"), told("lower_angle", "rad"), told("upper_angle", "rad")],
        evaluate: Box::new(|_| {
            let rod = PainleveRod { friction: FRICTION, ..PainleveRod::default() };
            let (lower, upper) = rod.paradox().ok_or_else(|| NoAnswer::Failed("there is no paradox at μ = 1.5".into()))?;
            let p = |angle: f64| PainleveRod { angle, ..rod }.effective().0;
            // At the critical friction the least p over all angles, at tan θ = 2, is zero.
            let critical = PainleveRod { friction: rod.critical_friction(), ..rod }.effective().0;
            Ok(vec![largest([p(lower), p(upper), critical]), lower, upper])
        }),
    }
}

/// The number of forces over a grid of angles and rates.
fn map() -> Case {
    Case {
        name: "painleve_rod, map".into(),
        quantity: "existence",
        method: "enumeration".into(),
        params: json!({"friction": FRICTION, "angles": MAP, "rates": MAP}),
        numbers: vec![count("disagreements", 0.0, "closed form"), told("none", "1"), told("two", "1"), told("one", "1")],
        evaluate: Box::new(|_| {
            let mut counts = [0.0; 4];
            for cell in 0..MAP * MAP {
                let rod = PainleveRod { rate: FASTEST * ((cell % MAP) as f64 + 0.5) / MAP as f64, ..at(cell / MAP, MAP) };
                let (found, known) = (forces(&rod)?, known(&rod));
                counts[0] += f64::from(u8::from(found != known));
                counts[[1, 3, 2][known]] += 1.0;
            }
            Ok(counts.to_vec())
        }),
    }
}

/// The rate at which b changes its sign, located by bisection over what enumeration or its forces say, against θ̇² = g/(l sin θ).
///
/// Where p > 0 the one force vanishes there. Where p < 0 there is none below and there are two above.
fn change(k: usize) -> Case {
    let rod = at(k, ANGLES);
    let numbers: Vec<Number> = vec![
        error("critical_rate_error", "closed form"),
        told("critical_rate", "rad/s"),
        count("forces_below", known(&rod) as f64, "closed form"),
        {
            let beyond = PainleveRod { rate: BEYOND, ..rod };
            count("forces_above", known(&beyond) as f64, "closed form")
        },
    ];
    Case {
        name: format!("painleve_rod, angle {:.2}°", rod.angle.to_degrees()),
        quantity: "existence",
        method: "enumeration".into(),
        params: json!({"friction": FRICTION, "angle": rod.angle}),
        numbers,
        evaluate: Box::new(move |_| {
            let (mut lower, mut upper) = (0.0, BEYOND);
            let [below, above] = [lower, upper].map(|rate| kind(&PainleveRod { rate, ..rod }));
            let (below, above) = (below?, above?);
            // Halves until the ends are neighbours.
            loop {
                let rate = f64::midpoint(lower, upper);
                if rate <= lower || rate >= upper {
                    break;
                }
                if kind(&PainleveRod { rate, ..rod })? == below { lower = rate } else { upper = rate }
            }
            let exact = (rod.gravity / (rod.half_length * rod.angle.sin())).sqrt();
            Ok(vec![(lower / exact - 1.0).abs(), lower, below.0 as f64, above.0 as f64])
        }),
    }
}

/// The number of forces, and whether the first of them presses.
fn kind(rod: &PainleveRod) -> Result<(usize, bool), NoAnswer> {
    let solution = Enumeration::default().solve(&rod.problem().map_err(failed)?).map_err(failed)?;
    let points = solution.points();
    Ok((points.len(), points.first().is_some_and(|point| point.impulses.amax() > 0.0)))
}
