//! Sweep: the errors of engines and methods over robots that the suite draws, at a drawn level of every axis.
//!
//! The question, the measures and the truth are those of the study `accuracy` ([`Accuracy::SWEEP`](crate::Accuracy::SWEEP)). A drawn robot has
//! one state: more robots say more than more states of one. So a cell has one error, and what a level of an axis costs is a
//! quantile over the robots at that level. The section takes these quantiles from the rows, and needs no outcome in memory.

pub(crate) mod section;

use crate::Accuracy;
use featherbench_bench::NoSettings;
use featherbench_study::Entry;

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "sweep",
    make: |setup| setup.made("sweep", |_: NoSettings| Accuracy::SWEEP),
    sections: section::sections,
    words: crate::accuracy::words::WORDS,
};
