//! Uncertainty: what do uncertain parameters do to the dynamics, where the answer is known?
//!
//! The cases belong to no robot of the suite, and every run evaluates all of them:
//!
//! - `ratios.rs`: v̇ = u/m, whose moments and distribution have closed forms, by every method;
//! - `arms.rs`: accelerations of arms with uncertain masses: derivatives, variances, indices, threads;
//! - `rates.rs`: how errors of means fall with the number of samples;
//! - `falls.rs`: a drop that may or may not meet the ground: a mixture of two contact modes;
//! - `torques.rs`: six torques that one uncertain mass makes.

mod arms;
mod falls;
mod rates;
mod ratios;
pub(crate) mod section;
#[cfg(test)]
mod tests;
mod torques;
pub(crate) mod words;

use featherbench_bench::NoSettings;
use featherbench_study::Entry;
use featherbench_study::known::{Case, KnownAnswers, count, error, failed, largest, told};

/// The study's name in rows.
const STUDY: &str = "uncertainty";

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "uncertainty",
    make: |setup| setup.made(STUDY, |_: NoSettings| KnownAnswers::new(STUDY, cases())),
    sections: section::sections,
    words: words::WORDS,
};

/// Every case.
fn cases() -> Vec<Case> {
    [ratios::cases(), arms::cases(), rates::cases(), falls::cases(), torques::cases()].into_iter().flatten().collect()
}
