//! The run in a few lines for a terminal: the verdict, the gravest findings, how many there are, how many rows, and what the sections add.

use featherbench_results::{Expectation, Row, RunInfo};

use crate::findings::{Findings, Status};
use crate::section::Section;

/// The number of findings.
const TOLD: usize = 3;

/// The lines at the end of a run, in this order:
/// 1. whether it passed, and what that means in numbers;
/// 2. the lead of a section: who is right, by how much, and how fast. Of a run that failed it comes behind the findings;
/// 3. the findings that weigh most, each marked as known or new. Of a run that failed, those that turned the gate red come first;
/// 4. how many findings of each level there are, among how many rows;
/// 5. the gates that are not met;
/// 6. the lines of the sections, among them how fast we are.
///
/// ```
/// use featherbench_report::summary;
/// use featherbench_results::{Row, RunInfo, Verdict};
///
/// let row = Row { verdict: Verdict::Pass, value: Some(1e-16), bound: Some(1e-14), ..Row::default() };
/// let lines = summary(&RunInfo::default(), &[row], &[]);
/// assert_eq!(lines, ["passed: no deviations, 1 row passed, 0 failed", "no findings among 1 row: 1 passed"]);
/// ```
pub fn summary(run: &RunInfo, rows: &[Row], sections: &[Section]) -> Vec<String> {
    let findings = Findings::of(run, rows);
    let mut lines = vec![findings.verdict()];
    let lead = || sections.iter().filter_map(|section| section.lead.as_ref()).flat_map(|lead| lead.lines.iter().cloned());
    let failed = findings.status == Status::Failed;
    if !failed {
        lines.extend(lead());
    }
    for (index, found) in findings.found.iter().take(TOLD).enumerate() {
        lines.push(format!("  {}. {}", index + 1, found.marked()));
        if !found.again.is_empty() {
            lines.push(format!("     again: {}", found.again));
        }
    }
    if failed {
        lines.extend(lead());
    }
    lines.push(format!("{} among {}", findings.levels(), findings.extent()));
    lines.extend(unmet(run));
    lines.extend(sections.iter().flat_map(|section| section.lines.iter().cloned()));
    lines
}

/// A line for each condition that is not met: what it counts, and by how much it fell short.
pub fn unmet(run: &RunInfo) -> impl Iterator<Item = String> {
    let unmet = run.expected.iter().filter(|condition| !condition.is_met());
    unmet.map(|Expectation { kind, what, reason, .. }| format!("  gate not met, {kind}: {what}: {reason}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_results::{GateKind, Verdict};

    fn row(engine: &str, quantity: &str, verdict: Verdict, value: f64) -> Row {
        let (engine, quantity) = (engine.to_owned(), quantity.to_owned());
        let (robot, states, method, metric) = ("panda".into(), "fast".into(), "aba".into(), "scaled".into());
        let (study, reference, reason, unit) = ("of engines".into(), "truth".into(), "far (too) from it".into(), "1".into());
        let (value, bound, margin) = (Some(value), Some(1e-14), Some((1e-14 / value).log10()));
        let relation = Some(featherbench_results::Relation::Le);
        Row {
            engine,
            quantity,
            robot,
            states,
            method,
            metric,
            study,
            reference,
            reason,
            unit,
            relation,
            verdict,
            value,
            bound,
            margin,
            ..Row::default()
        }
    }

    #[test]
    fn what_is_new_comes_first_and_then_the_gravest() {
        let rows = [
            row("drake", "id", Verdict::Pass, 1e-16),
            row("dart", "kinetic_energy", Verdict::Deviation, 1e-9),
            row("dart", "kinetic_energy", Verdict::Deviation, 0.78),
            row("mujoco", "id", Verdict::Deviation, 1e-9),
            row("drake", "bias", Verdict::Fail, 2e-14),
        ];
        let section = Section { lines: vec!["and more".into()], ..Section::new("more", "More", maud::html! {}) };
        let lines = summary(&RunInfo::default(), &rows, &[section]);
        let told: Vec<&str> = lines.iter().map(String::as_str).filter(|line| !line.contains("again:")).collect();
        assert_eq!(
            told,
            [
                "failed: drake, bias force h: 2 times its gate of 1e-14 against truth, in 1 row on 1 robot",
                "  1. rounding, new: drake, bias force h: 2 times its gate of 1e-14 against truth (panda, fast, aba); 1 row on 1 robot; far (too) from it",
                "  2. physics differs, known: dart, kinetic energy: off by 78 % against truth (panda, fast, aba); 2 rows on 1 robot; far (too) from it",
                "  3. method loses digits, known: mujoco, inverse dynamics: 5.0 digits lost beyond rounding against truth (1e-9 where 1e-14 is allowed) \
                 (panda, fast, aba); 1 row on 1 robot; far (too) from it",
                "3 findings: 1 physics differs, 1 method loses digits, 1 rounding; 1 new among 5 rows: 1 failed, 3 known deviations, 1 passed",
                "and more",
            ]
        );
        assert_eq!(lines.iter().filter(|line| line.contains("--filter '^of engines/panda/'")).count(), 3, "{lines:?}");
    }

    /// The first line says whether the run passed. A known deviation beside it would read as a contradiction.
    #[test]
    fn the_first_line_of_a_passed_run_names_no_engine() {
        let of = |rows: &[Row]| summary(&RunInfo::default(), rows, &[]).remove(0);
        let good = row("drake", "id", Verdict::Pass, 1e-16);
        let known = [
            row("pinocchio", "kinetic_energy", Verdict::Deviation, 0.024),
            row("dart", "id", Verdict::Deviation, 0.78),
            Row { reason: "no such joint".into(), ..row("mujoco", "fd", Verdict::Skip, 0.0) },
        ];
        assert_eq!(of(&[good.clone(), good.clone()]), "passed: no deviations, 2 rows passed, 0 failed");
        assert_eq!(of(&[good.clone(), known[0].clone()]), "passed: the only deviation found is known, 1 row passed, 0 failed");
        let first = of(&[&known[..], &vec![good; 1200]].concat());
        assert_eq!(first, "passed: all 2 deviations found are known, 1\u{202f}200 rows passed, 0 failed");
        assert!(["pinocchio", "dart", "mujoco", "drake", "off by"].iter().all(|words| !first.contains(words)), "{first}");
        // Nothing that has a bound: neither passed nor failed.
        assert_eq!(of(&known[2..]), "nothing judged: 1 row, none with a bound");
    }

    /// The first line of a failed run says what failed; then come the culprits, and the gates that are not met before the lines of the sections.
    #[test]
    fn the_first_line_of_a_failed_run_says_what_failed() {
        let condition = |kind, what: &str| Expectation::new(kind, what.into(), 1, 0).because("there is none".into());
        let expected = vec![condition(GateKind::Engine, "engine drake answers"), condition(GateKind::Counts, "cells of id")];
        let run = RunInfo { expected, ..RunInfo::default() };
        let silent = Row { value: None, bound: None, margin: None, relation: None, ..row("dart", "fd", Verdict::Error, 1.0) };
        let rows = [row("drake", "bias", Verdict::Fail, 2e-14), row("drake", "bias", Verdict::Fail, 3e-14), silent];
        let section = Section { lines: vec!["how fast".into()], ..Section::new("more", "More", maud::html! {}) };
        let lines = summary(&run, &rows, &[section]);
        assert_eq!(lines[0], "failed: not met: engine drake answers: there is none; and 3 more new findings");
        let end = &lines[lines.len() - 3..];
        let unmet = ["  gate not met, engine: engine drake answers: there is none", "  gate not met, counts: cells of id: there is none"];
        assert_eq!(end, [unmet[0], unmet[1], "how fast"]);
    }
}
