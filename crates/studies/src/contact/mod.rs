//! Contact: what do solvers, laws and integrators answer where the answer is known?
//!
//! The cases are those of the libraries `contact`, `constrained` and `hybrid`. Each has a closed form, or a second route in other
//! arithmetic. They belong to no robot of the suite, and every run evaluates all of them:
//!
//! - `problems.rs`: contact problems by every solver: what it says of existence, and the residuals of its answers;
//! - `known.rs`: quantities of these problems with closed forms;
//! - `painleve.rs`: how many forces a sliding rod has, and where that changes;
//! - `draws.rs`: each problem with random numbers against enumeration in double-double arithmetic;
//! - `impacts.rs`: impact laws, and sequences of simultaneous impacts;
//! - `rates.rs`: how fast first-order solvers converge;
//! - `standing.rs`: problems of robots that land and stand, by every solver;
//! - `delassus.rs`: the Delassus matrix by three routes;
//! - `loops.rs`: mobility, constrained dynamics, drift;
//! - `events.rs`: event times, saltation matrices, derivatives of runs, the penalty law.

mod delassus;
mod draws;
mod events;
mod impacts;
mod known;
mod loops;
mod painleve;
mod problems;
mod rates;
pub(crate) mod section;
pub(crate) mod standing;
#[cfg(test)]
mod tests;

use crate::{Made, Setup};
use featherbench_bench::{Cell, Context, Finished, NoAnswer, NoSettings, Outcome, Robot, Study, hash};
use featherbench_results::{Relation, Row, Verdict, canonical_json};
use serde_json::{Value, json};

/// The study of contact, loops and events.
pub struct Contact;

/// The study, if the suite asks for it.
pub(crate) fn of_suite(setup: &Setup) -> Made {
    Ok(setup.suite.settings::<NoSettings>("contact")?.map(|_| Box::new(Contact) as _))
}

/// The study's name in rows.
const STUDY: &str = "contact";

/// A question with a known answer.
struct Case {
    /// Its name, in the column `family`.
    name: String,
    /// What is judged: the column `quantity`.
    quantity: &'static str,
    /// The solver, law or route.
    method: String,
    /// The numbers that define it.
    params: Value,
    /// What `evaluate` returns, in this order. Where there is no answer to judge it may return the first of them alone.
    numbers: Vec<Number>,
    evaluate: Evaluate,
}

/// Answers a case for a seed.
type Evaluate = Box<dyn Fn(u64) -> Result<Vec<f64>, NoAnswer> + Send + Sync>;

/// A number that a case gives.
#[derive(Clone, Copy)]
struct Number {
    metric: &'static str,
    unit: &'static str,
    /// What it is compared with.
    reference: &'static str,
    judged: Judged,
}

/// How a number is judged.
#[derive(Clone, Copy)]
enum Judged {
    /// By the gate of its metric.
    Gate,
    /// It must be this one.
    Equals(f64),
    /// Not at all.
    No,
}

/// An error without unit, judged by the gate of its metric.
fn error(metric: &'static str, reference: &'static str) -> Number {
    Number { metric, unit: "1", reference, judged: Judged::Gate }
}

/// A count that is known.
fn count(metric: &'static str, known: f64, reference: &'static str) -> Number {
    Number { metric, unit: "1", reference, judged: Judged::Equals(known) }
}

/// A number that informs.
fn told(metric: &'static str, unit: &'static str) -> Number {
    Number { metric, unit, reference: "", judged: Judged::No }
}

/// A library refused what it should answer.
fn failed(error: impl std::fmt::Display) -> NoAnswer {
    NoAnswer::Failed(error.to_string())
}

/// The larger magnitude; NaN if either is.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a.abs() > b { a.abs() } else { b }
}

/// The largest magnitude; NaN if any is.
fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, |most, x| larger(x, most))
}

/// Every case.
fn cases() -> Vec<Case> {
    [
        problems::cases(),
        known::cases(),
        painleve::cases(),
        draws::cases(),
        impacts::cases(),
        rates::cases(),
        standing::cases(),
        delassus::cases(),
        loops::cases(),
        events::cases(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

impl Case {
    fn cell(&self, context: &Context) -> Option<Cell> {
        let identity = context.engine("featherbench")?.identity();
        let params = json!({"case": self.params, "seed": context.seed});
        Some(Cell {
            study: STUDY.into(),
            robot: self.name.clone(),
            robot_hash: hash::of(canonical_json(&params).as_bytes()),
            params,
            engine: identity.name.clone(),
            version: identity.version.clone(),
            method: self.method.clone(),
            quantity: self.quantity.into(),
            scalar: "f64".into(),
        })
    }

    fn is_of(&self, cell: &Cell) -> bool {
        self.name == cell.robot && self.quantity == cell.quantity && self.method == cell.method
    }

    fn rows(&self, context: &Context, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
        let blank = Row {
            cell: cell.id(),
            study: STUDY.into(),
            family: self.name.clone(),
            params: canonical_json(&cell.params),
            engine: cell.engine.clone(),
            engine_version: cell.version.clone(),
            method: self.method.clone(),
            precision: cell.scalar.clone(),
            quantity: self.quantity.into(),
            ..Row::default()
        };
        let values = match outcome.answer() {
            Ok(values) => values,
            // A solver that is not for such a problem says so, and nothing is due.
            Err(NoAnswer::NotOffered(reason)) => return vec![blank.without_value(Verdict::Info, reason)],
            Err(no_answer) => return vec![blank.without_value(Verdict::Error, no_answer.to_string())],
        };
        if values.is_empty() || values.len() > self.numbers.len() {
            return vec![blank.without_value(Verdict::Error, format!("{} numbers came, {} are due", values.len(), self.numbers.len()))];
        }
        let row = |(number, &value): (&Number, &f64)| {
            let row = Row { metric: number.metric.into(), unit: number.unit.into(), reference: number.reference.into(), ..blank.clone() };
            match number.judged {
                Judged::Gate => context.gates.judge(row, value, 1.0),
                Judged::Equals(known) => context.gates.explain(row.gated(value, Relation::Eq, known)),
                Judged::No => row.informed(value),
            }
        };
        self.numbers.iter().zip(values).map(row).collect()
    }
}

impl Study for Contact {
    fn name(&self) -> &'static str {
        STUDY
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        cases().iter().filter_map(|case| case.cell(context)).collect()
    }

    fn evaluate(&self, context: &Context, cell: &Cell) -> Outcome {
        match cases().iter().find(|case| case.is_of(cell)) {
            Some(case) => (case.evaluate)(context.seed).into(),
            None => Outcome::NoAnswer(NoAnswer::Failed("there is no case of this cell".into())),
        }
    }

    fn compare(&self, _: &Context, _: &Robot, _: &[Finished]) -> Vec<Row> {
        Vec::new()
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        let cases = cases();
        let of = |(cell, outcome): &Finished| Some(cases.iter().find(|case| case.is_of(cell))?.rows(context, cell, outcome));
        finished.iter().filter_map(of).flatten().collect()
    }
}
