//! The study's figure for papers: memory against size.

use super::data::{Data, Series};
use featherbench_report::figure::{Axis, Figure, Plot};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, labels};
use featherbench_study::figures::{Measured, largest};
use std::collections::{BTreeMap, BTreeSet};

/// The memory of each engine's process, for the line and the quantity that most engines answer.
pub(super) fn memory(overview: &Overview, data: &Data) -> Option<Figure> {
    let mut answers: BTreeMap<(&str, &str), BTreeSet<usize>> = BTreeMap::new();
    let measured = |series: &&Series| series.points.iter().filter(|point| point.resident.is_some()).count() > 1;
    for series in data.series.iter().filter(measured) {
        answers.entry((series.line, series.quantity)).or_default().insert(series.engine);
    }
    let most = answers.values().map(BTreeSet::len).max()?;
    // Forward dynamics, if it is among them: it is what simulation waits for. Then the line with the largest tree.
    let size = |line: &str, quantity: &str| {
        let same = data.series.iter().filter(measured).filter(|series| (series.line, series.quantity) == (line, quantity));
        same.flat_map(|series| &series.points).map(|point| point.size).max()
    };
    let best = answers.iter().filter(|(_, engines)| engines.len() == most).map(|(key, _)| *key);
    let (line, quantity) = best.max_by_key(|(line, quantity)| (*quantity == "fd", size(line, quantity)))?;
    let mut engines: BTreeMap<usize, Vec<Measured>> = BTreeMap::new();
    for series in data.series.iter().filter(measured).filter(|series| (series.line, series.quantity) == (line, quantity)) {
        let points = series.points.iter().filter_map(|point| {
            let resident = point.resident?;
            Some(Measured { robot: overview.robots[point.robot].name, x: point.size as f64, y: resident / 1e6 })
        });
        engines.entry(series.engine).or_default().extend(points);
    }
    let end = |(&engine, values): (&usize, &Vec<Measured>)| {
        let last = values.iter().max_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)))?;
        Some(format!("{} {} MB at {} degrees of freedom", overview.engines[engine], short(last.y), short(last.x)))
    };
    let words: Vec<String> = engines.iter().filter_map(end).collect();
    let caption = format!(
        "Memory that is resident after {} of a {line}: {}. It is that of a process of its own, program and libraries included; of an engine's \
         methods the largest is shown.",
        labels::quantity(quantity),
        words.join(", ")
    );
    let plot = Plot {
        title: format!("Memory of {} against size", labels::quantity(quantity)),
        x: Axis::log("degrees of freedom"),
        y: Axis::log("resident memory, MB"),
        series: engines
            .iter()
            .map(|(&engine, values)| largest(overview.engines[engine], overview.engines[engine].to_owned(), values))
            .collect(),
        ..Plot::default()
    };
    plot.figure("memory-size", caption)
}
