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
pub mod standing;
#[cfg(test)]
mod tests;
pub(crate) mod words;

use featherbench_bench::NoSettings;
use featherbench_study::Entry;
use featherbench_study::known::{Case, KnownAnswers, Number, count, error, failed, larger, largest, told};

/// The study's name in rows.
const STUDY: &str = "contact";

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "contact",
    make: |setup| setup.made(STUDY, |_: NoSettings| KnownAnswers::new(STUDY, cases())),
    sections: section::sections,
    words: words::WORDS,
};

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
