//! The contact problems of `featherbench_contact::systems` by every solver: what it says of existence, and the residuals of its answers.
//!
//! Direct solvers of Coulomb's law must obey it. What the others miss by their model or their cap is told.

use super::{Case, Number, count, error, failed, larger, largest, told};
use featherbench_bench::{NoAnswer, hash};
use featherbench_contact::systems::{self, Answers, PainleveRod};
use featherbench_contact::{Friction, Point, Problem, Solver, file, solver};
use serde_json::json;

const QUANTITY: &str = "contact_solution";

/// The residuals, by the names of their metrics.
const RESIDUALS: [&str; 5] = ["signorini", "cone", "dissipation", "natural_map", "energy_created"];

pub(super) fn cases() -> Vec<Case> {
    // The crate's own numbers make no malformed problem; a test counts the cases.
    let problems = systems::all().unwrap_or_default();
    let solvers = 0..solver::all().len();
    problems.iter().flat_map(|problem| solvers.clone().map(|which| case(problem, which))).collect()
}

fn case(problem: &Problem, which: usize) -> Case {
    let name = solver::all()[which].name();
    let answers = answers(problem.name(), name).map_or(told("answers", "1"), |known| count("answers", known, "theory"));
    let laws = |metric: &'static str| Number { reference: "laws", ..told(metric, "1") };
    let judged = if is_exact(name, problem) { error("residual", "laws") } else { laws("residual") };
    let numbers = [answers, told("iterations", "1"), judged].into_iter().chain(RESIDUALS.map(laws)).collect();
    let params = json!({"problem": hash::of(file::to_text(problem).as_bytes())});
    let problem = problem.clone();
    Case {
        name: problem.name().to_owned(),
        quantity: QUANTITY,
        method: name.into(),
        params,
        numbers,
        evaluate: Box::new(move |_| solved(solver::all()[which].as_ref(), &problem)),
    }
}

/// Whether a solver's equations are the problem's own, so that its answers must obey them.
pub(super) fn is_exact(solver: &str, problem: &Problem) -> bool {
    let round = |friction: &Friction| matches!(friction, Friction::Coulomb { coefficients } if coefficients.len() == 2);
    match solver {
        // It has pyramids for round cones.
        "lemke" => !problem.contacts().iter().any(|contact| round(&contact.friction)),
        name => name == "newton" || name == "enumeration",
    }
}

/// How many answers a solver must find.
///
/// - The rod's forces by the signs of p and b.
/// - A table's forces are a line, which ends where a leg is unloaded: two ends.
/// - G of a stack, a cradle and a single contact is positive definite; without friction, or in a block that does not slip, the answer is unique.
/// - Where there is none, no solver may give a number.
fn answers(problem: &str, solver: &str) -> Option<f64> {
    let rod = PainleveRod::default();
    let paradox = PainleveRod { friction: 1.5, ..rod };
    let of_rod = |rod: PainleveRod| match rod.answers() {
        Answers::Contact | Answers::LiftOff => 1.0,
        Answers::None => 0.0,
        Answers::Two => 2.0,
    };
    let all = match problem {
        "painleve_contact" => of_rod(rod),
        "painleve_lift_off" => of_rod(PainleveRod { rate: 4.0, ..rod }),
        "painleve_none" => of_rod(paradox),
        "painleve_two" => of_rod(PainleveRod { rate: 4.0, ..paradox }),
        "table" => 2.0,
        "stack_two" | "stack_equal" | "cradle" | "incline_round" | "incline_elliptic" | "sliding_sphere" => 1.0,
        _ => return None,
    };
    (solver == "enumeration" || all == 0.0).then_some(all)
}

/// The number of answers and of iterations, and the residuals of the worst answer, if there is one.
fn solved(solver: &dyn Solver, problem: &Problem) -> Result<Vec<f64>, NoAnswer> {
    let solution = solver.solve(problem).map_err(|unsupported| NoAnswer::NotOffered(unsupported.to_string()))?;
    let points = solution.points();
    let mut numbers = vec![points.len() as f64, solution.iterations as f64];
    if let Some(worst) = points.iter().map(residuals).reduce(|a, b| std::array::from_fn(|k| larger(a[k], b[k]))) {
        numbers.push(largest(worst));
        numbers.extend(worst);
    }
    Ok(numbers)
}

fn residuals(point: &Point) -> [f64; 5] {
    let of = &point.residuals;
    [of.signorini, of.cone, of.dissipation, of.natural_map, of.energy]
}

/// A solver's single answer.
pub(super) fn answer(solver: &dyn Solver, problem: &Problem) -> Result<Point, NoAnswer> {
    let solution = solver.solve(problem).map_err(failed)?;
    solution.point().cloned().ok_or_else(|| NoAnswer::Failed(format!("{} of {}: {}", solver.name(), problem.name(), solution.status())))
}
