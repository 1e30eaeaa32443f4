//! A case: a question with a known answer, and how its numbers are judged.

use crate::{case_row, unanswered};
use featherbench_bench::{Cell, Context, NoAnswer, OWN, Outcome, params};
use featherbench_results::{Relation, Row, Verdict};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A question with a known answer.
pub struct Case {
    /// Its name, in the column `family`.
    pub name: String,
    /// What is judged: the column `quantity`.
    pub quantity: &'static str,
    /// The solver, law or route.
    pub method: String,
    /// The numbers that define it.
    pub params: Value,
    /// What `evaluate` returns, in this order. Where there is no answer to judge it may return the first of them alone.
    pub numbers: Vec<Number>,
    /// Answers it.
    pub evaluate: Evaluate,
}

/// Answers a case for a seed.
pub type Evaluate = Box<dyn Fn(u64) -> Result<Vec<f64>, NoAnswer> + Send + Sync>;

/// A number that a case gives.
#[derive(Clone, Copy)]
pub struct Number {
    /// Its name in the column `metric`.
    pub metric: &'static str,
    /// Its unit, 1 if it has none.
    pub unit: &'static str,
    /// What it is compared with.
    pub reference: &'static str,
    /// How it is judged.
    pub judged: Judged,
}

/// How a number is judged.
#[derive(Clone, Copy)]
pub enum Judged {
    /// By the gate of its metric.
    Gate,
    /// It must be this one.
    Equals(f64),
    /// Not at all.
    No,
}

/// An error without unit, judged by the gate of its metric.
pub fn error(metric: &'static str, reference: &'static str) -> Number {
    Number { metric, unit: "1", reference, judged: Judged::Gate }
}

/// A count that is known.
pub fn count(metric: &'static str, known: f64, reference: &'static str) -> Number {
    Number { metric, unit: "1", reference, judged: Judged::Equals(known) }
}

/// A number that informs.
pub fn told(metric: &'static str, unit: &'static str) -> Number {
    Number { metric, unit, reference: "", judged: Judged::No }
}

/// A library refused what it should answer.
pub fn failed(error: impl std::fmt::Display) -> NoAnswer {
    NoAnswer::Failed(error.to_string())
}

/// The parameters of a cell.
#[derive(Serialize, Deserialize)]
struct Params<C> {
    case: C,
    seed: u64,
}

/// What defines the case of a row; `None` if that is something else.
pub fn defined_by<C: DeserializeOwned>(row: &Row) -> Option<C> {
    params::of_row(row).map(|params: Params<C>| params.case)
}

impl Case {
    pub(super) fn cell(&self, study: &str, context: &Context) -> Option<Cell> {
        let identity = context.engine(OWN)?.identity();
        let params = Params { case: &self.params, seed: context.seed };
        Some(Cell::of_case(study, &self.name, (&identity.name, &identity.version), self.quantity, &self.method, params))
    }

    pub(super) fn is_of(&self, cell: &Cell) -> bool {
        self.name == cell.robot && self.quantity == cell.quantity && self.method == cell.method
    }

    /// Its rows, judged: one for each number, or one that says why there are none.
    pub fn rows(&self, context: &Context, cell: &Cell, outcome: &Outcome) -> Vec<Row> {
        let blank = case_row(cell);
        let values = match outcome.answer() {
            Ok(values) => values,
            // A solver that is not for such a problem says so, and nothing is due.
            Err(no_answer) => return vec![unanswered(blank, &no_answer, Verdict::Info)],
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
