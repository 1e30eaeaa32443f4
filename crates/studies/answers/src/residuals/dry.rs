//! Set-valued friction: forward dynamics at rest by principal pivoting, against the enumeration of all 3ⁿ cases.

use super::forces::{apart, draw};
use super::{Case, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_dynamics::inverse_dynamics;
use featherbench_model::Model;
use featherbench_residuals::{DryFriction, Nominal, Rigid};
use featherbench_robots::{Family, Random, StateBatch};
use nalgebra::{DMatrix, DVector};
use serde_json::json;

/// Draws per robot.
const DRAWS: usize = 20;

pub(super) fn cases() -> Vec<Case> {
    let enumerated = ["chain:n=3", "chain:n=6"].map(|robot| case(robot, true));
    let large = ["quadruped", "humanoid", "chain:n=30"].map(|robot| case(robot, false));
    enumerated.into_iter().chain(large).collect()
}

/// A robot at rest under drawn forces and frictions. Up to six dofs the acceleration is that of enumeration; the laws must hold for any.
fn case(robot: &'static str, small: bool) -> Case {
    let mut numbers = vec![error("law_error", "laws"), count("unanswered", 0.0, "theory"), told("stuck", "1"), told("set_off", "1")];
    if small {
        numbers.push(error("acceleration_error", "enumeration"));
    }
    Case {
        name: format!("dry friction on {robot}"),
        quantity: "dry_friction",
        method: "principal pivoting".into(),
        params: json!({"robot": robot, "draws": DRAWS}),
        numbers,
        evaluate: Box::new(move |seed| {
            let description = Family::parse(robot).map_err(failed)?.generate().map_err(failed)?;
            let model = Model::<f64>::build(&description).map_err(failed)?;
            let nv = model.topology.nv();
            let states = StateBatch::random(&model, DRAWS, seed);
            let mut random = Random::named(seed, "dry friction");
            let mut rigid = Rigid::new(&model);
            let still = vec![0.0; nv];
            let (mut laws, mut accelerations, mut tally) = (Vec::new(), Vec::new(), [0, 0, 0]);
            for k in 0..DRAWS {
                let q = states.q(k);
                let held = inverse_dynamics(&model, q, &still, &still).map_err(failed)?;
                let size = largest(held.iter().copied()).max(1.0);
                let push: Vec<f64> = draw(&mut random, nv).iter().map(|x| size * x).collect();
                let limits: Vec<f64> = (0..nv).map(|_| size * random.uniform(0.0, 1.5)).collect();
                let tau: Vec<f64> = held.iter().zip(&push).map(|(held, push)| held + push).collect();
                let Ok(found) = DryFriction::new(limits.clone()).and_then(|dry| dry.forward(&mut rigid, q, &still, &tau)) else {
                    tally[2] += 1;
                    continue;
                };
                tally[0] += found.stuck.len();
                tally[1] += nv - found.stuck.len();
                // What the friction must be, given the acceleration: between its limits at rest, at one of them elsewhere.
                let known = inverse_dynamics(&model, q, &still, &found.a).map_err(failed)?;
                laws.push(largest((0..nv).map(|k| {
                    let r = tau[k] - known[k];
                    let due = if found.a[k] == 0.0 { r.clamp(-limits[k], limits[k]) } else { limits[k] * found.a[k].signum() };
                    (r - due) / size
                })));
                if small {
                    let mass = rigid.mass_matrix(q).map_err(failed)?;
                    let due = enumerated(&mass, &DVector::from_vec(push), &limits)
                        .ok_or_else(|| NoAnswer::Failed("no case obeys the laws".into()))?;
                    accelerations.push(apart(&found.a, due.as_slice()));
                }
            }
            let [stuck, free, unanswered] = tally.map(|n| n as f64);
            let numbers = vec![largest(laws), unanswered, stuck, free];
            Ok(if small { [numbers, vec![largest(accelerations)]].concat() } else { numbers })
        }),
    }
}

/// All 3ⁿ cases of sticking and setting off either way, each solved: the one that contradicts no law.
fn enumerated(mass: &DMatrix<f64>, forces: &DVector<f64>, limits: &[f64]) -> Option<DVector<f64>> {
    let n = limits.len();
    (0..3_usize.pow(n as u32)).find_map(|number| {
        let sign = |k: usize| [0.0, 1.0, -1.0][number / 3_usize.pow(k as u32) % 3];
        let moving: Vec<usize> = (0..n).filter(|&k| sign(k) != 0.0).collect();
        let block = DMatrix::from_fn(moving.len(), moving.len(), |i, j| mass[(moving[i], moving[j])]);
        let right = DVector::from_fn(moving.len(), |i, _| forces[moving[i]] - sign(moving[i]) * limits[moving[i]]);
        let some = block.cholesky()?.solve(&right);
        let mut a = DVector::zeros(n);
        moving.iter().zip(&some).for_each(|(&k, &x)| a[k] = x);
        let r = forces - mass * &a;
        let holds = (0..n).all(|k| if sign(k) == 0.0 { r[k].abs() <= limits[k] } else { a[k] * sign(k) > 0.0 });
        holds.then_some(a)
    })
}
