//! Identification: what do logs tell of a robot's parameters, and do estimators find them?
//!
//! Robots whose ranks follow a law, and robots whose true parameters are known:
//!
//! - `ranks.rs`: ranks of the torque regressor by three ways, against the laws;
//! - `estimates.rs`: estimators without noise, the spread of repeats, intervals, held-out error;
//! - `bodies.rs`: which parameters a body can have, log-Cholesky numbers, exciting trajectories;
//! - `witness.rs`: the same samples through the regressors of other engines, in live runs.

mod bodies;
mod estimates;
mod ranks;
pub(crate) mod section;
#[cfg(test)]
mod tests;
mod witness;
pub(crate) mod words;

use featherbench_bench::{Asked, Cell, Context, Engine, Finished, NoSettings, Outcome, Study};
use featherbench_results::Row;
use featherbench_study::Entry;
use featherbench_study::known::{Case, KnownAnswers, Number, count, error, failed, largest, told};

/// The study's name in rows.
const STUDY: &str = "identification";

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "identification",
    make: |setup| setup.made(STUDY, |_: NoSettings| Identification::new(setup.live)),
    sections: section::sections,
    words: words::WORDS,
};

/// Every case.
fn cases() -> Vec<Case> {
    [ranks::cases(), estimates::cases(), bodies::cases()].into_iter().flatten().collect()
}

/// Known answers, and in live runs the witnesses.
struct Identification {
    known: KnownAnswers,
    /// The engines that are asked if they are installed.
    witnesses: Vec<String>,
}

impl Identification {
    fn new(live: bool) -> Self {
        let witnesses = if live { vec!["pinocchio".to_owned(), "drake".to_owned()] } else { Vec::new() };
        Self { known: KnownAnswers::new(STUDY, cases()), witnesses }
    }
}

impl Study for Identification {
    fn name(&self) -> &'static str {
        STUDY
    }

    fn engines(&self) -> &[String] {
        &self.witnesses
    }

    /// With witnesses, every engine of the run is one.
    fn asks(&self, _: &dyn Engine) -> bool {
        !self.witnesses.is_empty()
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let witnesses = if self.witnesses.is_empty() { Vec::new() } else { witness::plan(context) };
        self.known.plan(context).into_iter().chain(witnesses).collect()
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        if witness::is_of(asked.cell) { witness::evaluate(asked).into() } else { self.known.evaluate(asked) }
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        let mut rows = self.known.compare_all(context, finished);
        rows.extend(
            finished.iter().filter(|(cell, _)| witness::is_of(cell)).flat_map(|(cell, outcome)| witness::rows(context, cell, outcome)),
        );
        rows
    }
}
