//! The run in a few lines for a terminal: passed or failed, the worst findings, and what the sections add.

use std::collections::BTreeSet;

use featherbench_results::{Row, RunInfo, Verdict};

use crate::findings::{Findings, Status};
use crate::labels;
use crate::numbers::short;
use crate::section::Section;
use crate::tally::severity;

/// The number of findings.
const TOLD: usize = 3;

/// The lines at the end of a run: the verdict, the three worst findings, and the lines of the sections.
///
/// A finding is the worst row of an engine on a quantity: failures first, then known deviations, each by its decades beyond the bound.
///
/// ```
/// use featherbench_report::summary;
/// use featherbench_results::{Row, RunInfo, Verdict};
///
/// let row = Row { verdict: Verdict::Pass, value: Some(1e-16), bound: Some(1e-14), ..Row::default() };
/// assert_eq!(summary(&RunInfo::default(), &[row], &[]), ["passed: The one judged row is inside its gate"]);
/// ```
pub fn summary(run: &RunInfo, rows: &[Row], sections: &[Section]) -> Vec<String> {
    let findings = Findings::of(run, rows, sections);
    let verdict = match findings.status {
        Status::Passed => "passed",
        Status::Failed => "FAILED",
        Status::Empty => "nothing judged",
    };
    let mut lines = vec![format!("{verdict}: {}", findings.headline())];
    lines.extend(worst(rows).into_iter().enumerate().map(|(index, row)| format!("  {}. {}", index + 1, sentence(row))));
    lines.extend(sections.iter().flat_map(|section| section.lines.iter().cloned()));
    lines
}

/// The worst rows, one of each engine and quantity.
fn worst(all: &[Row]) -> Vec<&Row> {
    let counts = |row: &&Row| matches!(row.verdict, Verdict::Fail | Verdict::Error | Verdict::Deviation);
    let mut rows: Vec<&Row> = all.iter().filter(counts).collect();
    rows.sort_by_key(|row| severity(row));
    let mut told = BTreeSet::new();
    rows.retain(|row| told.insert((&row.engine, &row.quantity)));
    rows.truncate(TOLD);
    rows
}

/// `pinocchio, kinetic energy: 0.024 where 1e-14 is allowed (panda, random, crba): why`.
fn sentence(row: &Row) -> String {
    let place: Vec<&str> =
        [&row.robot, &row.body, &row.states, &row.method].into_iter().map(String::as_str).filter(|word| !word.is_empty()).collect();
    let who = format!("{}, {}", row.engine, labels::error(&row.quantity, &row.metric));
    let size = match (row.value, row.bound) {
        (Some(value), Some(bound)) => format!("{} where {} is allowed", short(value), short(bound)),
        _ => "no answer".to_owned(),
    };
    let known = if row.verdict == Verdict::Deviation { "known: " } else { "" };
    format!("{who}: {size} ({}); {known}{}", place.join(", "), row.reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(engine: &str, quantity: &str, verdict: Verdict, value: f64) -> Row {
        let (engine, quantity) = (engine.to_owned(), quantity.to_owned());
        let (robot, states, method, metric) = ("panda".into(), "fast".into(), "aba".into(), "scaled".into());
        let (study, reference, reason) = ("of engines".into(), "featherbench".into(), "far (too) from it (1 is not at most 2)".into());
        let (value, bound, margin) = (Some(value), Some(1e-14), Some((1e-14 / value).log10()));
        Row { engine, quantity, robot, states, method, metric, study, reference, reason, verdict, value, bound, margin, ..Row::default() }
    }

    #[test]
    fn failures_come_before_deviations_and_each_engine_and_quantity_once() {
        let rows = [
            row("drake", "id", Verdict::Pass, 1e-16),
            row("dart", "fd", Verdict::Deviation, 1e-9),
            row("dart", "fd", Verdict::Deviation, 1e-3),
            row("mujoco", "id", Verdict::Deviation, 1e-5),
            row("drake", "bias", Verdict::Fail, 2e-14),
            row("mujoco", "bias", Verdict::Deviation, 1e-13),
        ];
        let section = Section { lines: vec!["and more".into()], ..Section::new("more", "More", maud::html! {}) };
        let lines = summary(&RunInfo::default(), &rows, &[section]);
        assert_eq!(lines.len(), 5, "{lines:?}");
        assert!(lines[0].starts_with("FAILED: 1 row of 6 outside their gates"), "{lines:?}");
        assert_eq!(
            lines[1],
            "  1. drake, bias force h: 2e-14 where 1e-14 is allowed (panda, fast, aba); far (too) from it (1 is not at most 2)"
        );
        assert_eq!(
            lines[2],
            "  2. dart, forward dynamics: 0.0010 where 1e-14 is allowed (panda, fast, aba); known: far (too) from it (1 is not at most 2)"
        );
        assert!(lines[3].starts_with("  3. mujoco, "), "{lines:?}");
        assert_eq!(lines[4], "and more");
    }
}
