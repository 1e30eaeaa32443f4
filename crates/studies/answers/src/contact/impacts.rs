//! Impact laws, and sequences of simultaneous impacts.

use super::{Case, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_contact::impact::{Law, impact, orders, sequence};
use featherbench_contact::systems::{Cradle, Kane};
use featherbench_contact::{Contact, Level, Problem};
use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};

const QUANTITY: &str = "impact";

pub(super) fn cases() -> Vec<Case> {
    [kane(), frictionless(), cradles()].into_iter().flatten().collect()
}

fn case(
    name: String,
    law: Law,
    params: Value,
    numbers: Vec<super::Number>,
    evaluate: impl Fn() -> Result<Vec<f64>, NoAnswer> + Send + Sync + 'static,
) -> Case {
    Case { name, quantity: QUANTITY, method: law.name().into(), params, numbers, evaluate: Box::new(move |_| evaluate()) }
}

/// Kane's pendulum. By Newton's law it sticks or slides at the end: G λ = −b − e b_n e_n within the cone, by Cramer's rule. It gains energy. Poisson's
/// and Stronge's laws must not.
fn kane() -> Vec<Case> {
    let mut cases = Vec::new();
    for (restitution, friction) in [(0.5, 0.5), (0.7, 0.5), (0.9, 0.5), (0.0, 0.5), (1.0, 0.0)] {
        let kane = Kane { restitution, friction, ..Kane::default() };
        let params = json!({"restitution": restitution, "friction": friction});
        let name = format!("Kane, e = {restitution}, μ = {friction}");
        let numbers = vec![error("error", "closed form"), told("energy_change", "1")];
        cases.push(case(name.clone(), Law::Newton, params.clone(), numbers, move || {
            let problem = kane.problem().map_err(failed)?;
            let end = impact(&problem, Law::Newton).map_err(failed)?;
            let known = newton(&problem, restitution, friction);
            let missed = largest(end.impulses.iter().zip(known).map(|(a, b)| a - b)) / largest(known);
            Ok(vec![missed, change(&problem, end.energy)?])
        }));
        for law in [Law::Poisson, Law::Stronge] {
            let numbers = vec![error("energy_created", "laws"), told("energy_change", "1")];
            cases.push(case(name.clone(), law, params.clone(), numbers, move || {
                let problem = kane.problem().map_err(failed)?;
                let change = change(&problem, impact(&problem, law).map_err(failed)?.energy)?;
                Ok(vec![if change < 0.0 { 0.0 } else { change }, change])
            }));
        }
    }
    cases
}

/// λ of one planar contact by Newton's law: sticking, or sliding at the side of the cone that sticking leaves.
fn newton(problem: &Problem, restitution: f64, friction: f64) -> [f64; 2] {
    let (g, b) = (problem.delassus(), problem.free());
    let (rn, rt) = (-(1.0 + restitution) * b[0], -b[1]);
    let determinant = g[(0, 0)] * g[(1, 1)] - g[(0, 1)] * g[(0, 1)];
    let stuck = [(rn * g[(1, 1)] - rt * g[(0, 1)]) / determinant, (rt * g[(0, 0)] - rn * g[(0, 1)]) / determinant];
    if stuck[1].abs() <= friction * stuck[0] {
        return stuck;
    }
    let side = friction.copysign(stuck[1]);
    let normal = rn / (g[(0, 0)] + side * g[(0, 1)]);
    [normal, side * normal]
}

/// A change of energy over the energy before.
fn change(problem: &Problem, energy: f64) -> Result<f64, NoAnswer> {
    let before = problem.free_energy().ok_or_else(|| NoAnswer::Failed("the problem has no mass".into()))?;
    Ok(energy / before)
}

/// Without friction all laws are c_n⁺ = −e c_n⁻.
fn frictionless() -> Vec<Case> {
    let mut cases = Vec::new();
    for restitution in [0.0, 0.3, 1.0] {
        for law in [Law::Newton, Law::Poisson, Law::Stronge, Law::Moreau { tangential: 0.0 }] {
            let params = json!({"restitution": restitution});
            cases.push(case(format!("ball, e = {restitution}"), law, params, vec![error("error", "closed form")], move || {
                let contact = vec![Contact::frictionless("ball").with_restitution(restitution)];
                let (g, b) = (DMatrix::from_row_slice(1, 1, &[0.7]), DVector::from_vec(vec![-2.0]));
                let problem = Problem::from_delassus("ball", Level::Impulse, contact, g, b).map_err(failed)?;
                let end = impact(&problem, law).map_err(failed)?;
                Ok(vec![(end.velocities[0] - 2.0 * restitution).abs() / 2.0])
            }));
        }
    }
    cases
}

/// Balls in a row: at once (−1/3, 2/3, 2/3), one after another (0, 0, 1). And two orders that disagree.
fn cradles() -> Vec<Case> {
    let at_once = case("cradle, at once".into(), Law::Newton, json!({}), vec![error("error", "closed form")], || {
        let cradle = Cradle::default();
        let end = impact(&cradle.problem().map_err(failed)?, Law::Newton).map_err(failed)?;
        let found = cradle.velocities_after(end.impulses.as_slice());
        Ok(vec![largest(found.iter().zip([-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]).map(|(a, b)| a - b))])
    });
    let in_turn = case("cradle, in turn".into(), Law::Newton, json!({}), vec![error("error", "closed form")], || {
        let cradle = Cradle::default();
        let one = sequence(&cradle.problem().map_err(failed)?, Law::Newton, &[0, 1], 10).map_err(failed)?;
        if !one.complete {
            return Err(NoAnswer::Failed("ten impacts were not enough".into()));
        }
        let found = cradle.velocities_after(one.end.impulses.as_slice());
        Ok(vec![largest(found.iter().zip([0.0, 0.0, 1.0]).map(|(a, b)| a - b))])
    });
    // By hand: the distance of the two ends in the norm of the energy.
    let numbers = vec![error("error", "closed form"), told("disagreement", "√J")];
    let both = case("cradle from both sides, every order".into(), Law::Newton, json!({}), numbers, || {
        let cradle = Cradle { masses: vec![1.0, 3.0, 1.0], velocities: vec![1.0, 0.0, -1.0], restitution: 0.5 };
        let both = orders(&cradle.problem().map_err(failed)?, Law::Newton, 100).map_err(failed)?;
        let ends: Vec<Vec<f64>> = both.sequences.iter().map(|sequence| cradle.velocities_after(sequence.end.impulses.as_slice())).collect();
        let [first, second] = &ends[..] else { return Err(NoAnswer::Failed("there are not two orders".into())) };
        let square: f64 = first.iter().zip(second).zip(&cradle.masses).map(|((a, b), m)| m * (a - b) * (a - b)).sum();
        Ok(vec![(both.disagreement - square.sqrt()).abs(), both.disagreement])
    });
    vec![at_once, in_turn, both]
}
