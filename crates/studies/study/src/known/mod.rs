//! Known answers: what studies share whose cases belong to no robot of the suite.
//!
//! Such a study is a list of [`Case`]s. Each has a closed form, or a second route in other arithmetic. A run evaluates all of them.
//!
//! - `case.rs`: a case and its rows;
//! - `table.rs`: the table of its section: what was asked, and how many numbers are as known.

mod case;
mod table;

pub use case::{Case, Evaluate, Judged, Number, count, defined_by, error, failed, told};
pub use featherbench_spatial::{larger, largest};
pub use table::{beside, passed, table, value};

use featherbench_bench::{Asked, Cell, Context, Finished, NoAnswer, Outcome, Study};
use featherbench_results::Row;

/// A study of cases with known answers.
pub struct KnownAnswers {
    /// The study's name in rows.
    name: &'static str,
    cases: Vec<Case>,
}

impl KnownAnswers {
    /// The study of this name with these cases. No two may have the same name, quantity and method.
    pub fn new(name: &'static str, cases: Vec<Case>) -> KnownAnswers {
        KnownAnswers { name, cases }
    }

    fn case(&self, cell: &Cell) -> Option<&Case> {
        self.cases.iter().find(|case| case.is_of(cell))
    }
}

impl Study for KnownAnswers {
    fn name(&self) -> &'static str {
        self.name
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        self.cases.iter().filter_map(|case| case.cell(self.name, context)).collect()
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        let case = self.case(asked.cell).ok_or_else(|| NoAnswer::Failed("there is no case of this cell".into()));
        case.and_then(|case| (case.evaluate)(asked.context.seed)).into()
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        let of = |(cell, outcome): &Finished| Some(self.case(cell)?.rows(context, cell, outcome));
        finished.iter().filter_map(of).flatten().collect()
    }
}
