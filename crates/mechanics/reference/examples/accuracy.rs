//! The accuracy table: errors of forward and inverse dynamics and of M against the truth, medians and quartiles over twenty draws.
//!
//!     cargo run --release -p featherbench-reference --features examples --example accuracy [-- CASE…]
//!
//! Asks our kernels, and Pinocchio, MuJoCo and Drake where they are installed. Errors are relative 2-norms; of M also the worst entry, over
//! √(M_ii M_jj). The extra cases move the base away from the origin.

#[path = "../tests/support/mod.rs"]
mod support;

use featherbench_dynamics::Ltdl;
use featherbench_model::{Description, Model};
use featherbench_reference::{Error, Precision, Robot, nearest_doubles};
use std::collections::BTreeMap;
use support::oracle::{Oracle, python};
use support::{CASES, Case, Draw, State};

const DRAWS: usize = 20;
const SEED: u64 = 20;

/// What the table has beyond the golden cases.
const MORE: [Case; 3] = [
    Case { name: "offset_1e2", family: "chain:n=20,layout=spatial,base_offset=1e2", draw: Draw::Wide },
    Case { name: "offset_1e4", family: "chain:n=20,layout=spatial,base_offset=1e4", draw: Draw::Wide },
    Case { name: "offset_1e6", family: "chain:n=20,layout=spatial,base_offset=1e6", draw: Draw::Wide },
];

/// Errors over the draws, by engine and method.
type Errors = BTreeMap<String, Vec<f64>>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let python = python("numpy");
    let start = |engine| python.as_ref().map(|python| (engine, Oracle::start(python, engine)));
    let mut oracles: Vec<(&str, Oracle)> = ["pinocchio", "mujoco", "drake"].into_iter().filter_map(start).collect();
    for case in CASES.iter().chain(&MORE).filter(|case| wanted.is_empty() || wanted.iter().any(|name| name == case.name)) {
        let description = case.describe();
        let states: Vec<State> = (0..DRAWS).map(|k| case.state(SEED, k)).collect();
        oracles.iter_mut().for_each(|(_, oracle)| assert!(oracle.prepare(&description, &states), "an engine refuses {}", case.name));
        for quantity in ["fd", "id", "mass_matrix"] {
            let started = std::time::Instant::now();
            let truth = truth(&description, quantity, &states)?;
            println!("{} {quantity} (truth in {:.1?})", case.name, started.elapsed());
            let (norms, entries) = compare(&description, quantity, &states, &truth, &mut oracles);
            print("", norms);
            print("worst entry ", entries);
        }
    }
    Ok(())
}

fn truth(description: &Description, quantity: &str, states: &[State]) -> Result<Vec<Vec<f64>>, Error> {
    let robot = Robot::new(description, Precision::STANDARD)?;
    let answer = |State { q, v, a, tau }: &State| {
        Ok(nearest_doubles(&match quantity {
            "fd" => robot.forward_dynamics(q, v, tau)?,
            "id" => robot.inverse_dynamics(q, v, a)?,
            _ => robot.mass_matrix(q)?.entries().to_vec(),
        }))
    };
    states.iter().map(answer).collect()
}

/// Errors in norm, and those of the worst entry where there is a measure for it.
fn compare(
    description: &Description,
    quantity: &str,
    states: &[State],
    truth: &[Vec<f64>],
    oracles: &mut [(&str, Oracle)],
) -> (Errors, Errors) {
    let (mut norms, mut entries) = (Errors::new(), Errors::new());
    let mut add = |who: String, answer: &[f64], truth: &[f64]| {
        norms.entry(who.clone()).or_default().push(relative(answer, truth));
        if quantity == "mass_matrix" {
            entries.entry(who).or_default().push(worst_entry(answer, truth));
        }
    };
    let model = Model::<f64>::build(description).expect("a generated robot is sound");
    for (state, truth) in states.iter().zip(truth) {
        for (who, answer) in featherbench(&model, quantity, state) {
            add(format!("featherbench {who}"), &answer, truth);
        }
    }
    for (engine, oracle) in oracles {
        for method in oracle.methods(quantity) {
            let answers = oracle.evaluate(quantity, &method, states.len());
            for (answer, truth) in answers.chunks_exact(truth[0].len()).zip(truth) {
                add(format!("{engine} {method}"), answer, truth);
            }
        }
    }
    (norms, entries)
}

/// Our kernels' answers, by their names.
fn featherbench(model: &Model<f64>, quantity: &str, State { q, v, a, tau }: &State) -> Vec<(&'static str, Vec<f64>)> {
    const SOUND: &str = "a generated robot and its states fit each other";
    let n = v.len();
    let mass = featherbench_dynamics::mass_matrix(model, q).expect(SOUND);
    match quantity {
        "id" => vec![("rnea", featherbench_dynamics::inverse_dynamics(model, q, v, a).expect(SOUND))],
        "mass_matrix" => vec![("crba", (0..n * n).map(|k| mass.get(k / n, k % n)).collect())],
        _ => {
            let bias = featherbench_dynamics::bias_force(model, q, v).expect(SOUND);
            let mut x: Vec<f64> = tau.iter().zip(bias).map(|(tau, h)| tau - h).collect();
            let mut factors = Ltdl::new(&model.topology);
            factors.run(&mass).expect(SOUND);
            factors.solve(&mut x).expect(SOUND);
            vec![("aba", featherbench_dynamics::forward_dynamics(model, q, v, tau).expect(SOUND)), ("ltdl", x)]
        }
    }
}

fn print(what: &str, errors: Errors) {
    for (who, mut errors) in errors {
        errors.sort_by(f64::total_cmp);
        let at = |quantile: f64| errors[((errors.len() - 1) as f64 * quantile).round() as usize];
        println!("  {who:<26} {what}median {:.1e}  quartiles {:.1e} {:.1e}  worst {:.1e}", at(0.5), at(0.25), at(0.75), at(1.0));
    }
}

/// ‖x − y‖₂ / ‖y‖₂.
fn relative(answer: &[f64], truth: &[f64]) -> f64 {
    let norm = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>().sqrt();
    norm(&mut answer.iter().zip(truth).map(|(x, y)| x - y)) / norm(&mut truth.iter().copied())
}

/// max |ΔM_ij| / √(M_ii M_jj).
fn worst_entry(answer: &[f64], truth: &[f64]) -> f64 {
    let n = truth.len().isqrt();
    let gap = |i: usize, j: usize| (answer[i * n + j] - truth[i * n + j]).abs() / (truth[i * n + i] * truth[j * n + j]).sqrt();
    (0..n * n).map(|k| gap(k / n, k % n)).fold(0.0, |worst, x| if x > worst || x.is_nan() { x } else { worst })
}
