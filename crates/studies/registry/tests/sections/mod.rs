//! The report with the sections of all studies.

mod imports;
mod joints;
mod made_up;
mod page;
mod ranking;
mod speed;
mod truth;
// The same access to a written report as in the tests of its crate.
#[path = "../../../../harness/report/tests/written/mod.rs"]
mod written;

use featherbench_results::{Row, RunInfo};
use written::Written;

/// The report of a run.
fn report(run: &RunInfo, rows: &[Row]) -> Written {
    Written::of(run, rows, &featherbench_registry::sections(run, rows))
}
