//! Errors of finite differences against their step.

use super::super::{STUDY, step};
use featherbench_report::numbers::{larger, short};
use featherbench_report::{Overview, labels, opener, robot_chunk};
use featherbench_results::Row;
use maud::{Markup, html};
use std::collections::BTreeMap;

/// Errors of one engine's kind of method on one robot.
#[derive(Debug)]
pub(super) struct Line<'a> {
    /// Index of the robot.
    pub robot: usize,
    /// Index of the engine.
    pub engine: usize,
    /// The method without its step.
    pub method: &'a str,
    /// The quantity.
    pub quantity: &'a str,
    /// Its title.
    pub title: &'a str,
    /// Step and median error, the longest step first. One point without a step is a method that is no differences.
    pub points: Vec<(Option<f64>, f64)>,
}

/// The robot, the quantity with its rank, the engine and the kind of method of a line.
type Key<'a> = (usize, (usize, &'a str), usize, &'a str);

/// Collects a run's rows: the robots with finite differences, and what other methods have there.
pub(super) fn lines<'a>(overview: &Overview<'a>, rows: &[&'a Row]) -> Vec<Line<'a>> {
    let mut found: BTreeMap<Key, Line> = BTreeMap::new();
    for &row in rows.iter().filter(|row| matches!(row.metric.as_str(), "difference_median" | "error_median")) {
        let (Some(robot), Some(engine), Some(value)) = (overview.robot(&row.robot), overview.engine(&row.engine), row.value) else {
            continue;
        };
        let eps = step(&row.method);
        let method = eps.and_then(|_| row.method.rsplit_once('_')).map_or(row.method.as_str(), |(kind, _)| kind);
        let line = found.entry((robot, labels::quantity_rank(&row.quantity), engine, method)).or_insert_with(|| Line {
            robot,
            engine,
            method,
            quantity: &row.quantity,
            title: labels::quantity(&row.quantity),
            points: Vec::new(),
        });
        line.points.push((eps, value));
    }
    let swept: Vec<(usize, &str)> =
        found.values().filter(|line| line.points.iter().any(|(eps, _)| eps.is_some())).map(|line| (line.robot, line.quantity)).collect();
    let mut lines: Vec<Line> = found.into_values().filter(|line| swept.contains(&(line.robot, line.quantity))).collect();
    for line in &mut lines {
        line.points.sort_by(|a, b| b.0.unwrap_or(0.0).total_cmp(&a.0.unwrap_or(0.0)));
    }
    lines
}

/// For each engine's kind of differences the best step and its error, over all robots.
pub(super) fn table(overview: &Overview, lines: &[Line]) -> Markup {
    html! {
        table.compact.sortable {
            thead { tr {
                th scope="col" { "robot" } th scope="col" { "engine" } th scope="col" { "method" } th scope="col" { "quantity" }
                th.number scope="col" { "best step" } th.number scope="col" { "error there" } th.number scope="col" { "largest error" }
            } }
            tbody { @for line in lines.iter().filter(|line| line.points.iter().any(|(eps, _)| eps.is_some())) {
                @let best = line.points.iter().filter(|(_, error)| !error.is_nan()).min_by(|a, b| a.1.total_cmp(&b.1));
                tr {
                    th scope="row" { (opener(&robot_chunk(line.robot), &[("study", STUDY), ("quantity", line.quantity)], overview.robots[line.robot].name)) }
                    td { (overview.engines[line.engine]) } td { (line.method) } td { (line.title) }
                    td.number { @if let Some((Some(eps), _)) = best { (format!("{eps:e}")) } }
                    td.number { @if let Some((_, error)) = best { (short(*error)) } }
                    td.number { (short(line.points.iter().map(|(_, error)| *error).fold(0.0, larger))) }
                }
            } }
        }
    }
}
