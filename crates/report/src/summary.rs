//! The run in a few lines for a terminal: passed or failed, the worst findings, the speed.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_results::{Row, RunInfo, Verdict};

use crate::findings::{Findings, Status};
use crate::labels;
use crate::numbers::{larger, short, smaller};
use crate::overview::{Overview, TIMING};
use crate::speed::Speed;

/// The number of findings.
const TOLD: usize = 3;
/// Our kernels' name in rows.
const OWN: &str = "featherbench";
/// Quantities with a line about their times.
const TIMED: [&str; 3] = ["id", "fd", "mass_matrix_sparse"];

/// The lines at the end of a run: the verdict, the three worst findings, and the speed if it was measured.
///
/// A finding is the worst row of an engine on a quantity: failures first, then known deviations, each by its decades beyond the bound.
///
/// ```
/// use featherbench_report::summary;
/// use featherbench_results::{Row, RunInfo, Verdict};
///
/// let row = Row { verdict: Verdict::Pass, value: Some(1e-16), bound: Some(1e-14), ..Row::default() };
/// assert_eq!(summary(&RunInfo::default(), &[row]), ["passed: The one judged row is inside its gate"]);
/// ```
pub fn summary(run: &RunInfo, records: &[Row]) -> Vec<String> {
    let overview = Overview::of(run, records);
    let findings = Findings::of(run, &overview, records);
    let verdict = match findings.status {
        Status::Passed => "passed",
        Status::Failed => "FAILED",
        Status::Empty => "nothing judged",
    };
    let mut lines = vec![format!("{verdict}: {}", findings.headline())];
    lines.extend(worst(records).into_iter().enumerate().map(|(index, row)| format!("  {}. {}", index + 1, sentence(row))));
    lines.extend(speed(&overview, records));
    lines
}

/// The worst rows, one of each engine and quantity.
fn worst(records: &[Row]) -> Vec<&Row> {
    let counts = |row: &&Row| matches!(row.verdict, Verdict::Fail | Verdict::Error | Verdict::Deviation);
    let mut rows: Vec<&Row> = records.iter().filter(counts).collect();
    rows.sort_by_key(|row| crate::overview::severity(row));
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

/// Times of our kernels per body, and of the fastest other engine over ours; nothing if no time counts.
fn speed(overview: &Overview, records: &[Row]) -> Option<String> {
    let timed = |row: &&Row| row.study == TIMING && row.metric == "ns_per_call" && row.cache == "stream" && row.engine == OWN;
    // The fastest method of each robot.
    let mut fastest: BTreeMap<(&str, &str), f64> = BTreeMap::new();
    for row in records.iter().filter(timed).filter(|row| row.valid) {
        if let Some((ns, bodies)) = row.value.zip(row.bodies.filter(|&bodies| bodies > 0)) {
            let each = fastest.entry((&row.quantity, &row.robot)).or_insert(f64::INFINITY);
            *each = smaller(*each, ns / bodies as f64);
        }
    }
    let range = |name: &str| {
        let mut times = fastest.iter().filter(|((quantity, _), _)| *quantity == name).map(|(_, ns)| *ns);
        let first = times.next()?;
        Some(times.fold((first, first), |(least, most), ns| (smaller(least, ns), larger(most, ns))))
    };
    let times = TIMED.iter().filter_map(|name| range(name).map(|(least, most)| (name, short(least), short(most))));
    let span = |least: String, most: String| if least == most { least } else { format!("{least} to {most}") };
    let times: Vec<String> = times.map(|(name, least, most)| format!("{} {} ns", labels::quantity(name), span(least, most))).collect();
    if times.is_empty() {
        return None;
    }
    let speed = Speed::of(overview, records);
    let summaries = speed.summaries();
    let others = TIMED.iter().filter_map(|name| {
        let others = summaries.iter().filter(|summary| overview.engines[summary.of.engine] != OWN);
        let timed = others.filter(|summary| summary.of.quantity == *name && summary.of.cache == "stream" && !summary.of.estimated);
        let fastest = timed.min_by(|a, b| a.mean.total_cmp(&b.mean))?;
        Some(format!("{} {} ({})", labels::quantity(name), short(fastest.mean), overview.engines[fastest.of.engine]))
    });
    let others: Vec<String> = others.collect();
    let beside = if others.is_empty() { String::new() } else { format!("; the fastest other engine over ours: {}", others.join(", ")) };
    Some(format!("speed, per body of a robot: {}{beside}", times.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(engine: &str, quantity: &str, verdict: Verdict, value: f64) -> Row {
        let (engine, quantity) = (engine.to_owned(), quantity.to_owned());
        let (model, case, method, metric) = ("panda".into(), "fast".into(), "aba".into(), "scaled".into());
        let (study, reference, reason) = ("agreement".into(), "featherbench".into(), "far (too) from it (1 is not at most 2)".into());
        let (value, bound, margin) = (Some(value), Some(1e-14), Some((1e-14 / value).log10()));
        Row {
            engine,
            quantity,
            robot: model,
            states: case,
            method,
            metric,
            study,
            reference,
            reason,
            verdict,
            value,
            bound,
            margin,
            ..Row::default()
        }
    }

    fn time(robot: &str, method: &str, ns: f64) -> Row {
        let (study, metric, cache, engine) = (TIMING.into(), "ns_per_call".into(), "stream".into(), OWN.into());
        let (robot, method, quantity) = (robot.into(), method.into(), "fd".into());
        Row { study, metric, cache, engine, robot, method, quantity, bodies: Some(10), ..Row::default() }.informed(ns)
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
        let lines = summary(&RunInfo::default(), &rows);
        assert_eq!(lines.len(), 4, "{lines:?}");
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
    }

    #[test]
    fn a_time_is_that_of_the_fastest_method_and_invalid_ones_do_not_count() {
        let rows = [
            time("a", "aba", 500.0),
            time("a", "refined", 9000.0),
            time("b", "aba", 800.0),
            time("c", "aba", 1.0).invalid("the machine was not quiet"),
        ];
        let lines = summary(&RunInfo::default(), &rows);
        assert_eq!(lines[1..], ["speed, per body of a robot: forward dynamics 50 to 80 ns"]);
        assert_eq!(summary(&RunInfo::default(), &rows[3..]).len(), 1, "no time that counts, no line");
    }
}
