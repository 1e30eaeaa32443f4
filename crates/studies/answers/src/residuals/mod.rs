//! Residuals: what a nominal model lacks. Are they what their formulas say, does any engine take them, and what is structure worth in learning?
//!
//! `true = nominal + r`: τ = ID(q, v, a) + r(q, v, a). Cases with known answers belong to no robot of the suite:
//!
//! - `forces.rs`: the sign, payload, drives with an inner state, well-posedness;
//! - `dry.rs`: set-valued friction against enumeration;
//! - `power.rs`: the balance of power along a motion, and its order;
//! - `passive.rs`: projections onto passive residuals;
//! - `learning.rs`: three learned models on motions that they have not seen, and the energy of a long motion.
//!
//! `engines.rs` asks each engine about each robot of the suite, corrected by a residual.

mod dry;
mod engines;
mod forces;
mod learning;
mod passive;
mod power;
pub(crate) mod section;
#[cfg(test)]
mod tests;
pub(crate) mod words;

use featherbench_bench::{Asked, Cell, Context, Engine, Finished, NoSettings, Outcome, Robot, Study};
use featherbench_learning::Arm;
use featherbench_results::Row;
use featherbench_study::Entry;
use featherbench_study::known::{Case, KnownAnswers, Number, count, error, failed, largest, told};

/// The study's name in rows.
const STUDY: &str = "residuals";

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "residuals",
    make: |setup| setup.made(STUDY, |_: NoSettings| Residuals { known: KnownAnswers::new(STUDY, cases()) }),
    sections: section::sections,
    words: words::WORDS,
};

/// Every case with a known answer.
fn cases() -> Vec<Case> {
    [forces::cases(), dry::cases(), power::cases(), passive::cases(), learning::cases()].into_iter().flatten().collect()
}

/// The arm of these cases: two uniform rods that hang down at q = 0.
fn arm(second_mass: f64) -> Arm {
    Arm { masses: vec![2.0, second_mass], lengths: vec![1.0, 0.5], gravity: 9.81 }
}

/// Known answers, and engines.
struct Residuals {
    known: KnownAnswers,
}

impl Study for Residuals {
    fn name(&self) -> &'static str {
        STUDY
    }

    fn asks(&self, _: &dyn Engine) -> bool {
        true
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        self.known.plan(context).into_iter().chain(engines::plan(context)).collect()
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        match asked.robot() {
            Ok(robot) => engines::evaluate(asked, robot).into(),
            Err(_) => self.known.evaluate(asked),
        }
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        engines::rows(context, robot, finished)
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        self.known.compare_all(context, finished)
    }
}
