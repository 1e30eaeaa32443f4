//! Section: time against size. Its drawings are in `drawings`.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_bench::params;
use featherbench_report::fit::{Fit, power_law};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Part, labels};
use featherbench_results::Row;
use maud::{Markup, html};

use super::{STUDY, drawings};
use crate::timing::rows::RowParams;

/// Times of one algorithm on one family.
#[derive(Debug)]
pub struct TimeLine<'a> {
    /// Index of the engine.
    pub engine: usize,
    /// The algorithm's name.
    pub algorithm: &'a str,
    /// The engine's method.
    pub method: &'a str,
    /// Its arithmetic.
    pub scalar: &'a str,
    /// The family of robots.
    pub family: &'a str,
    /// `stream` or `hot`.
    pub cache: &'a str,
    /// One per robot, by size.
    pub points: Vec<TimePoint>,
    /// Growth of the time of a call with the number of degrees of freedom.
    pub per_call: Option<Fit>,
    /// The same of the time per joint.
    pub per_joint: Option<Fit>,
}

/// The time of one robot.
#[derive(Clone, Copy, Debug)]
pub struct TimePoint {
    /// Index of the robot.
    pub robot: usize,
    /// Degrees of freedom.
    pub size: u64,
    /// Joints: as many as bodies.
    pub joints: u64,
    /// Nanoseconds per call.
    pub ns: f64,
    /// Its first decile, if the run has it.
    pub p10: Option<f64>,
    /// Its last decile.
    pub p90: Option<f64>,
    /// Lower end of the interval, if the run has it.
    pub low: Option<f64>,
    /// Its upper end.
    pub high: Option<f64>,
    /// Whether the time counts.
    pub valid: bool,
    /// Whether it is an estimate.
    pub estimated: bool,
}

/// Collects a run's rows.
pub fn lines<'a>(overview: &Overview<'a>, rows: &'a [Row]) -> Vec<TimeLine<'a>> {
    let mut lines: BTreeMap<[&str; 6], Vec<TimePoint>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.study == STUDY && row.metric == "ns_per_call") {
        let (Some(robot), Some(ns)) = (overview.robot(&row.robot), row.value) else { continue };
        let Some(size) = overview.robots[robot].nv.filter(|&size| size > 0) else { continue };
        let joints = overview.robots[robot].bodies.filter(|&bodies| bodies > 0).unwrap_or(size);
        let params: RowParams = params::of_row(row).unwrap_or_default();
        let (valid, estimated, low, high) = (row.valid, row.estimated, row.ci_low, row.ci_high);
        let point = TimePoint { robot, size, joints, ns, p10: params.p10, p90: params.p90, low, high, valid, estimated };
        lines.entry([&row.engine, &row.quantity, &row.method, &row.precision, &row.family, &row.cache]).or_default().push(point);
    }
    lines
        .into_iter()
        .filter_map(|([engine, algorithm, method, scalar, family, cache], mut points)| {
            points.sort_by_key(|point| (point.size, point.robot));
            // Invalid times too: they are wrong by some percent, and a fit spans decades.
            let per_call = power_law(points.iter().map(|point| (point.size as f64, point.ns)));
            let per_joint = power_law(points.iter().map(|point| (point.size as f64, point.ns / point.joints as f64)));
            let engine = overview.engine(engine)?;
            Some(TimeLine { engine, algorithm, method, scalar, family, cache, points, per_call, per_joint })
        })
        .collect()
}

/// Writes the section, and the drawings that it does not show at first; `first` tells the times of one robot before anything else.
pub fn markup(disturbed: Option<&str>, overview: &Overview, times: &[TimeLine], first: Option<Markup>) -> (Markup, Vec<Part>) {
    let families: BTreeSet<&str> = times.iter().map(|line| line.family).collect();
    // All families at once are hard to read: the plot first shows the one with the most points.
    let points = |family: &&&str| times.iter().filter(|line| line.family == **family).map(|line| line.points.len()).sum::<usize>();
    let opening = families.iter().max_by_key(points).copied().unwrap_or_default();
    let (drawn, parts) = drawings::times(overview, times, opening);
    let body = html! {
        section #time {
            h2 { "Time against size" }
            @if let Some(first) = first { (first) }
            @if let Some(disturbed) = disturbed { p.warning { (disturbed) } }
            p.lead { "Time of one call on one pinned core, against the degrees of freedom. Bars are 95 % intervals, hollow marks times that do not count, crosses estimates, broad lines fits." }
            @if times.is_empty() {
                p.empty { "This run holds no times." }
            } @else {
                (drawn)
                details {
                    summary { "Growth: fitted exponents" }
                    p.note { "Time ∝ nvᵖ by least squares on logarithms, with the standard error of p. Small robots, where fixed costs rule, flatten a fit over all sizes." }
                    div.scroll { (growth(overview, times)) }
                }
            }
        }
    };
    (body, parts)
}

/// What the inputs of a time are.
pub fn case_words(case: &str) -> String {
    match case {
        "stream" => "stream: another state each call".into(),
        "hot" => "hot: one state again and again".into(),
        other => other.to_owned(),
    }
}

fn growth(overview: &Overview, lines: &[TimeLine]) -> Markup {
    let exponent = |fit: Option<Fit>| match fit {
        Some(fit) => html! { (format!("{:.2} ± {:.2}", fit.slope, fit.error)) },
        None => html! { "too few" },
    };
    html! {
        table.compact.sortable {
            thead {
                tr {
                    th scope="col" { "engine" } th scope="col" { "algorithm" } th scope="col" { "family" } th scope="col" { "inputs" }
                    th.number scope="col" { "robots" } th.number scope="col" { "p, per call" } th.number scope="col" { "p, per joint" }
                    th.number scope="col" { "largest nv" } th.number scope="col" { "ns per call there" } th.number scope="col" { "ns per joint there" }
                }
            }
            tbody {
                @for line in lines {
                    tr {
                        th scope="row" { (overview.engines[line.engine]) }
                        td { (labels::quantity(line.algorithm)) @if line.method != line.algorithm { " " small { (line.method) } } }
                        td { (line.family) }
                        td { (line.cache) }
                        td.number { (line.points.len()) }
                        td.number { (exponent(line.per_call)) }
                        td.number { (exponent(line.per_joint)) }
                        @if let Some(last) = line.points.last() {
                            td.number { (last.size) }
                            td.number { (short(last.ns)) }
                            td.number { (short(last.ns / last.joints as f64)) }
                        }
                    }
                }
            }
        }
    }
}
