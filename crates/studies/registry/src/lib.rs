//! The registry: every study, in the order of a run and of its report, and what all of them say together.
//!
//! A study is added by its folder in `comparison`, `answers` or `speed`, and by one line in [`STUDIES`].

mod dictionary;
mod figures;
mod ranking;

pub use dictionary::dictionary;
pub use featherbench_study::Setup;
pub use figures::FIGURES;
pub use ranking::ranking;

use featherbench_answers as answers;
use featherbench_bench::{HarnessError, Study};
use featherbench_comparison as comparison;
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo};
use featherbench_speed as speed;
use featherbench_study::Entry;

/// Every study, in the order of a run and of its report. Those that run alone come after all others; timing is the last, as it needs a quiet
/// machine.
const STUDIES: &[&Entry] = &[
    &comparison::agreement::ENTRY,
    &comparison::import::ENTRY,
    &comparison::accuracy::ENTRY,
    &comparison::sweep::ENTRY,
    &comparison::conditioning::ENTRY,
    &comparison::derivatives::ENTRY,
    &comparison::single::ENTRY,
    &comparison::invariance::ENTRY,
    &answers::contact::ENTRY,
    &answers::continuum::ENTRY,
    &answers::scenes::ENTRY,
    &answers::relaxation::ENTRY,
    &answers::identification::ENTRY,
    &answers::residuals::ENTRY,
    &answers::lesson::ENTRY,
    &answers::uncertainty::ENTRY,
    &comparison::steps::ENTRY,
    &speed::operations::ENTRY,
    &speed::scaling::ENTRY,
    &comparison::reproductions::ENTRY,
    &comparison::repeatability::ENTRY,
    &speed::growth::ENTRY,
    &answers::loops::ENTRY,
    &speed::contact_timing::ENTRY,
    &speed::timing::ENTRY,
];

/// The names of all studies.
pub fn names() -> Vec<&'static str> {
    STUDIES.iter().map(|study| study.name).collect()
}

/// The studies of a suite.
///
/// # Errors
/// [`HarnessError`], naming file, line and key, when a table of the suite has an error or belongs to no study.
pub fn of_suite(setup: &Setup) -> Result<Vec<Box<dyn Study>>, HarnessError> {
    setup.suite.check_studies(&names())?;
    STUDIES.iter().filter_map(|study| (study.make)(setup).transpose()).collect()
}

/// The sections of the report of a run: the ranking of its engines, then study by study those of each that has rows, and of those that say
/// that they have none.
pub fn sections(run: &RunInfo, rows: &[Row]) -> Vec<Section> {
    let overview = Overview::of(run, rows);
    let mut all = Vec::from_iter(ranking::section(run, rows, &overview));
    for study in STUDIES {
        let sections = (study.sections)(run, rows, &overview).into_iter();
        all.extend(sections.map(|section| Section { study: study.name, ..section }));
    }
    all
}
