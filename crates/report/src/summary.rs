//! The run in a few lines for a terminal: the gravest findings, how many there are, how many rows, and what the sections add.

use featherbench_results::{Row, RunInfo};

use crate::findings::{Findings, Status};
use crate::section::Section;

/// The number of findings.
const TOLD: usize = 3;

/// The lines at the end of a run: the gravest finding and whether the run passed, the first findings, how many of each level there are, how
/// many rows, and the lines of the sections. Of a run that failed, the findings that turned the gate red come first.
///
/// ```
/// use featherbench_report::summary;
/// use featherbench_results::{Row, RunInfo, Verdict};
///
/// let row = Row { verdict: Verdict::Pass, value: Some(1e-16), bound: Some(1e-14), ..Row::default() };
/// assert_eq!(summary(&RunInfo::default(), &[row], &[]), ["passed: No engine misses a gate", "no findings among 1 row: 1 passed"]);
/// ```
pub fn summary(run: &RunInfo, rows: &[Row], sections: &[Section]) -> Vec<String> {
    let findings = Findings::of(run, rows);
    let verdict = match findings.status {
        Status::Passed => "passed",
        Status::Failed => "FAILED",
        Status::Empty => "nothing judged",
    };
    let mut lines = vec![format!("{verdict}: {}", findings.headline())];
    let (new, known): (Vec<_>, Vec<_>) = findings.found.iter().partition(|found| found.new);
    for (index, found) in new.into_iter().chain(known).take(TOLD).enumerate() {
        lines.push(format!("  {}. {}{}: {}", index + 1, found.level(), if found.new { ", new" } else { "" }, found.sentence()));
        if !found.again.is_empty() {
            lines.push(format!("     again: {}", found.again));
        }
    }
    lines.push(format!("{} among {}", findings.levels(), findings.extent()));
    lines.extend(sections.iter().flat_map(|section| section.lines.iter().cloned()));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_results::Verdict;

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
                "FAILED: drake, bias force h: 2 times its gate of 1e-14 against truth",
                "  1. rounding, new: drake, bias force h: 2 times its gate of 1e-14 against truth (panda, fast, aba); 1 row on 1 robot; far (too) from it",
                "  2. physics differs: dart, kinetic energy: off by 78 % against truth (panda, fast, aba); 2 rows on 1 robot; known: far (too) from it",
                "  3. method loses digits: mujoco, inverse dynamics: 5.0 digits lost beyond rounding against truth (1e-9 where 1e-14 is allowed) \
                 (panda, fast, aba); 1 row on 1 robot; known: far (too) from it",
                "3 findings: 1 physics differs, 1 method loses digits, 1 rounding; 1 new among 5 rows: 1 failed, 3 known deviations, 1 passed",
                "and more",
            ]
        );
        assert_eq!(lines.iter().filter(|line| line.contains("--filter '^of engines/panda/'")).count(), 3, "{lines:?}");
    }
}
