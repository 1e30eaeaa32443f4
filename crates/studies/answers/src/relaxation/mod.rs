//! Relaxation: does another solver find the velocities that our `Convex` finds?
//!
//! The convex relaxation of a contact problem, minimise ½ λᵀG λ + bᵀλ over the friction cones, has one velocity c = G λ + b, whatever its
//! impulses are. An engine that offers the relaxation (`contact_relaxations` of the protocol) solves every problem of the crate that our
//! solver takes, and those of robots that land and stand. Velocities are compared, each in the size of the largest |b|.
//!
//! A problem is given free of units and of μ: with D = diag(1, μ₁, μ₂) of each contact, x = D⁻¹λ has the cone x_n ≥ |x_t|, G' = D G D and
//! b' = D b. Rows that a contact does not have are zero.

pub(crate) mod words;

use crate::contact::standing::Stand;
use featherbench_bench::{Asked, Cell, ContactProblems, Context, Finished, NoAnswer, OWN, Outcome, Study};
use featherbench_contact::{Convex, Friction, Problem, Solver, systems};
use featherbench_results::{Row, Verdict};
use featherbench_study::known::{failed, largest};
use featherbench_study::{Entry, case_row, no_section, unanswered};
use nalgebra::{DMatrix, DVector};
use serde::Deserialize;
use serde_json::json;

/// The study's name in rows.
const STUDY: &str = "relaxation";
const QUANTITY: &str = "relaxed_velocity";
/// The tolerance that an engine is asked for: of its duality gap.
const TOLERANCE: f64 = 1e-10;
const ITERATIONS: usize = 200;

/// The table `[relaxation]` of a suite.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Settings {
    /// The engines that are asked if they are installed.
    engines: Vec<String>,
}

/// The study.
struct Relaxation {
    settings: Settings,
}

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "relaxation",
    make: |setup| setup.made(STUDY, |settings| Relaxation { settings }),
    sections: no_section,
    words: words::WORDS,
};

/// The names of all sets of problems: of the crate, and of standing robots.
fn names() -> Vec<String> {
    let problems = systems::all().unwrap_or_default();
    problems.iter().map(|problem| problem.name().to_owned()).chain(Stand::ALL.iter().map(|stand| stand.name())).collect()
}

/// The problems of a name, all of one size.
fn problems(name: &str, seed: u64) -> Result<Vec<Problem>, NoAnswer> {
    if let Some(stand) = Stand::ALL.into_iter().find(|stand| stand.name() == name) {
        let mut problems: Vec<Problem> = stand.make()?.run(seed)?.into_iter().map(|taken| taken.problem).collect();
        problems.retain(|problem| problem.contacts().len() == stand.contacts());
        return Ok(problems);
    }
    Ok(systems::all().map_err(failed)?.into_iter().filter(|problem| problem.name() == name).collect())
}

/// A problem free of units, and the velocities that our solver finds.
struct Relaxed {
    /// G', b' and the friction of each contact: one, or zero.
    delassus: DMatrix<f64>,
    free: DVector<f64>,
    friction: Vec<f64>,
    /// c' of ours.
    velocities: DVector<f64>,
}

impl Relaxed {
    fn of(problem: &Problem) -> Result<Self, NoAnswer> {
        let solution = Convex::default().solve(problem).map_err(|error| NoAnswer::NotOffered(error.to_string()))?;
        let lost = || NoAnswer::Failed(format!("our solver of {} ends as {}", problem.name(), solution.status()));
        let point = solution.point().ok_or_else(lost)?;
        let rows = 3 * problem.contacts().len();
        let mut factors = DMatrix::zeros(rows, problem.rows());
        let mut friction = Vec::new();
        for (index, contact) in problem.contacts().iter().enumerate() {
            let first = problem.range(index).start;
            factors[(3 * index, first)] = 1.0;
            let coefficients: &[f64] = if let Friction::Coulomb { coefficients } = &contact.friction { coefficients } else { &[] };
            for (k, mu) in coefficients.iter().enumerate() {
                factors[(3 * index + 1 + k, first + 1 + k)] = *mu;
            }
            friction.push(f64::from(u8::from(coefficients.iter().any(|mu| *mu > 0.0))));
        }
        let delassus = &factors * problem.delassus() * factors.transpose();
        let shift = problem.restitution_shift();
        let free = &factors * (problem.free() + &shift);
        let velocities = &factors * (&point.velocities + shift);
        let (of_g, of_b) = (nonzero(delassus.amax()), nonzero(free.amax()));
        Ok(Self { delassus: delassus / of_g, free: free / of_b, friction, velocities: velocities / of_b })
    }

    /// How far the velocities of these impulses are from ours.
    fn apart(&self, impulses: &[f64]) -> f64 {
        let found = &self.delassus * DVector::from_column_slice(impulses) + &self.free;
        largest((found - &self.velocities).iter().copied())
    }
}

fn nonzero(scale: f64) -> f64 {
    if scale == 0.0 { 1.0 } else { scale }
}

/// Of an engine's method: how many problems it was asked, and the largest difference.
fn compared(asked: &Asked) -> Result<Vec<f64>, NoAnswer> {
    let solver = asked.offered(|engine| engine.contact_solver())?;
    let relaxed = problems(&asked.cell.robot, asked.context.seed)?.iter().map(Relaxed::of).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = relaxed.first() else { return Err(NoAnswer::Failed("there is no problem of this name".into())) };
    let mut given = ContactProblems { count: relaxed.len(), contacts: first.friction.len(), ..ContactProblems::default() };
    for one in &relaxed {
        // G' is symmetric: its columns are its rows.
        given.delassus.extend(one.delassus.iter());
        given.free.extend(one.free.iter());
        given.friction.extend(&one.friction);
    }
    let mut prepared = solver.prepare_contacts(&given, &asked.cell.method, TOLERANCE, ITERATIONS)?;
    prepared.run(0..given.count)?;
    let answers = prepared.read().chunks_exact(3 * given.contacts);
    if answers.len() != given.count {
        return Err(NoAnswer::Failed("there is not an answer to each problem".into()));
    }
    Ok(vec![given.count as f64, largest(relaxed.iter().zip(answers).map(|(one, impulses)| one.apart(impulses)))])
}

impl Study for Relaxation {
    fn name(&self) -> &'static str {
        STUDY
    }

    fn engines(&self) -> &[String] {
        &self.settings.engines
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        for engine in self.settings.engines.iter().filter_map(|name| context.engine(name)) {
            let identity = engine.identity();
            let methods = engine.contact_solver().map(|solver| solver.contact_relaxations()).unwrap_or_default();
            for (method, name) in methods.iter().flat_map(|method| names().into_iter().map(move |name| (method, name))) {
                let params = json!({"tolerance": TOLERANCE, "seed": context.seed});
                cells.push(Cell::of_case(STUDY, &name, (&identity.name, &identity.version), QUANTITY, method, params));
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        compared(asked).into()
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        finished.iter().flat_map(|(cell, outcome)| rows(context, cell, outcome)).collect()
    }
}

fn rows(context: &Context, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
    let blank = Row { metric: "difference".into(), unit: "1".into(), reference: OWN.into(), ..case_row(cell) };
    match outcome.answer() {
        Ok(&[count, apart]) => {
            let told = Row { metric: "problems".into(), reference: String::new(), ..blank.clone() };
            vec![context.gates.judge(blank, apart, 1.0), told.informed(count)]
        }
        Ok(_) => vec![blank.without_value(Verdict::Error, "two numbers are due")],
        // A contact that the relaxation does not have: nothing is due.
        Err(no_answer) => vec![unanswered(blank, &no_answer, Verdict::Info)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::gates;

    /// What is given has the same problem in it: our own impulses, converted, have our velocities.
    #[test]
    fn problems_keep_their_velocities() {
        let (mut taken, mut refused) = (0, 0);
        for problem in systems::all().unwrap() {
            let Ok(relaxed) = Relaxed::of(&problem) else {
                refused += 1;
                continue;
            };
            let solution = Convex::default().solve(&problem).unwrap();
            let impulses = &solution.point().unwrap().impulses;
            let factor = |row: usize, contact: usize| match &problem.contacts()[contact].friction {
                Friction::Coulomb { coefficients } if row > 0 => coefficients[row - 1],
                _ => 1.0,
            };
            let mut x = Vec::new();
            let scale = nonzero(relaxed.free.amax());
            for contact in 0..problem.contacts().len() {
                let range = problem.range(contact);
                x.extend((0..3).map(|row| {
                    if row < range.len() && factor(row, contact) > 0.0 { impulses[range.start + row] / factor(row, contact) } else { 0.0 }
                }));
            }
            // Units: c' = D c / |D b|, so x is in units of |D b| / |D G D|.
            let own = &relaxed.delassus * DVector::from_vec(x);
            let moved = &relaxed.velocities - &relaxed.free;
            let ratio = if own.amax() > 0.0 { moved.amax() / own.amax() } else { 1.0 };
            let missed = (own * ratio - moved).amax();
            assert!(missed < 1e-9 * scale, "{}: {missed:e}", problem.name());
            taken += 1;
        }
        assert!(taken > 8 && refused > 0, "{taken} {refused}");
    }

    #[test]
    fn wrong_velocities_fail() {
        let gates = gates();
        let context = Context { robots: &[], engines: &[], gates: &gates, seed: 1 };
        let cell = Cell::of_case(STUDY, "stack_two", ("clarabel", ""), QUANTITY, "impulses", json!({}));
        let verdict = |values: Vec<f64>| rows(&context, &cell, &Outcome::Values(values))[0].verdict;
        assert_eq!(verdict(vec![1.0, 1e-7]), Verdict::Pass);
        assert_eq!(verdict(vec![1.0, 1e-3]), Verdict::Fail);
        assert_eq!(verdict(vec![1.0, f64::NAN]), Verdict::Error);
        assert_eq!(verdict(vec![1.0]), Verdict::Error);
    }
}
