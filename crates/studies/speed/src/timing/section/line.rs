//! The line on speed at the end of a run.

use std::collections::BTreeMap;

use featherbench_bench::{BATCH, OWN};
use featherbench_report::numbers::{larger, short, smaller};
use featherbench_report::{Overview, labels};
use featherbench_results::Row;

use super::STUDY;
use super::ratios::Speed;

/// Quantities that the line names.
const TIMED: [&str; 3] = ["id", "fd", "mass_matrix_sparse"];

/// Times of our kernels per body, one state at a time, and of the fastest other engine over ours; nothing if no time counts.
pub fn line(overview: &Overview, rows: &[Row], speed: &Speed) -> Option<String> {
    let timed =
        |row: &&Row| row.study == STUDY && row.metric == "ns_per_call" && row.cache == "stream" && row.engine == OWN && row.method != BATCH;
    // The fastest method of each robot.
    let mut fastest: BTreeMap<(&str, &str), f64> = BTreeMap::new();
    for row in rows.iter().filter(timed).filter(|row| row.valid) {
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
    use featherbench_results::RunInfo;

    fn time(robot: &str, method: &str, ns: f64) -> Row {
        let (study, metric, cache, engine) = (STUDY.into(), "ns_per_call".into(), "stream".into(), OWN.into());
        let (robot, method, quantity) = (robot.into(), method.into(), "fd".into());
        Row { study, metric, cache, engine, robot, method, quantity, bodies: Some(10), ..Row::default() }.informed(ns)
    }

    #[test]
    fn a_time_is_that_of_the_fastest_method_and_invalid_ones_do_not_count() {
        let rows = [
            time("a", "aba", 500.0),
            time("a", "refined", 9000.0),
            time("a", BATCH, 100.0),
            time("b", "aba", 800.0),
            time("c", "aba", 1.0).invalid("the machine was not quiet"),
        ];
        let run = RunInfo::default();
        let line = |rows: &[Row]| {
            let overview = Overview::of(&run, rows);
            super::line(&overview, rows, &Speed::of(&overview, rows))
        };
        assert_eq!(line(&rows).as_deref(), Some("speed, per body of a robot: forward dynamics 50 to 80 ns"));
        assert_eq!(line(&rows[4..]), None, "no time that counts, no line");
    }
}
