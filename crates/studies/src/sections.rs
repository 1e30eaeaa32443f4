//! The sections of all studies, in the order of the page.

use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo};

use crate::{accuracy, agreement, conditioning, import, reproductions, steps, timing};

/// The order of the page, by anchors: results first, then what explains them. A section that is not named here follows these.
const ORDER: [&str; 11] =
    ["agreement", "import", "joints", "accuracy", "depth", "time", "speed", "tradeoff", "conditioning", "steps", "pairs"];

/// The sections of the report of a run: those of each study that has rows, and those that say that they have none.
pub fn sections(run: &RunInfo, rows: &[Row]) -> Vec<Section> {
    let overview = Overview::of(run, rows);
    let of_studies = [
        agreement::section::sections,
        accuracy::section::sections,
        conditioning::section::sections,
        import::section::sections,
        reproductions::section::sections,
        steps::section::sections,
        timing::section::sections,
    ];
    let mut sections: Vec<Section> = of_studies.iter().flat_map(|of_study| of_study(run, rows, &overview)).collect();
    sections.sort_by_key(|section| ORDER.iter().position(|&anchor| anchor == section.anchor).unwrap_or(ORDER.len()));
    sections
}
