//! Section: robots with loops, in engines.

mod drawings;

use super::STUDY;
use super::ask::Params;
use super::systems::{NEAR, PLANS};
use featherbench_bench::{OWN, params};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Section, labels, opener};
use featherbench_results::{Row, RunInfo, Verdict};
use featherbench_study::known::{beside, passed};
use featherbench_study::rows_of;
use maud::{Markup, html};

/// A motion by steps of one length.
struct Point<'a> {
    name: &'a str,
    engine: &'a str,
    method: &'a str,
    dt: f64,
    error: f64,
    drift: Option<f64>,
    open: Option<f64>,
    /// Of all its steps, s, by the engine's own clock.
    seconds: f64,
}

/// The error at an angle beside the flat parallelogram.
struct Near<'a> {
    engine: &'a str,
    method: &'a str,
    beside: f64,
    error: f64,
}

/// What the section draws.
struct Figures<'a> {
    /// The motions that have several lengths of steps, by name.
    motions: Vec<&'a str>,
    points: Vec<Point<'a>>,
    near: Vec<Near<'a>>,
}

/// Makes the section, if the run has rows of the study.
pub(crate) fn sections<'a>(_: &RunInfo, rows: &'a [Row], overview: &Overview<'a>) -> Vec<Section> {
    let Some((rows, chunk)) = rows_of(rows, STUDY, overview) else { return Vec::new() };
    let figures = Figures {
        motions: PLANS.iter().filter(|plan| plan.steps.len() > 1).map(|plan| plan.name).collect(),
        points: points(&rows),
        near: near(&rows),
    };
    vec![Section::new("loops", "Loops in engines", body(&rows, &figures, &chunk))]
}

fn points<'a>(rows: &[&'a Row]) -> Vec<Point<'a>> {
    let of = |row: &&'a Row| {
        (row.quantity == "loop_motion" && row.metric == "error").then_some(())?;
        let asked: Params = params::of_row(row)?;
        let dt = asked.dt?;
        let steps = (asked.seconds? / dt).round();
        Some(Point {
            name: &row.family,
            engine: &row.engine,
            method: &row.method,
            dt,
            error: row.value?,
            drift: beside(rows, row, "energy_drift"),
            open: beside(rows, row, "open"),
            seconds: beside(rows, row, "ns_per_step")? * steps * 1e-9,
        })
    };
    rows.iter().filter_map(of).collect()
}

fn near<'a>(rows: &[&'a Row]) -> Vec<Near<'a>> {
    let of = |row: &&'a Row| {
        (row.quantity == "loop_singular" && row.metric == "error").then_some(())?;
        let asked: Params = params::of_row(row)?;
        Some(Near { engine: &row.engine, method: &row.method, beside: asked.beside?, error: row.value? })
    };
    rows.iter().filter_map(of).collect()
}

/// The largest error of accelerations of each engine's method, over all robots, and how many robots it answers.
fn accelerations<'a>(rows: &[&'a Row]) -> Vec<(&'a Row, Vec<Option<f64>>)> {
    let mut lines: Vec<(&Row, Vec<Option<f64>>)> = Vec::new();
    let names = robots(rows);
    for row in rows.iter().filter(|row| row.quantity == "loop_acceleration" && row.metric == "error") {
        let column = names.iter().position(|name| *name == row.family);
        let known = lines.iter().position(|(line, _)| line.engine == row.engine && line.method == row.method);
        let line = known.unwrap_or_else(|| {
            lines.push((row, vec![None; names.len()]));
            lines.len() - 1
        });
        if let Some(column) = column {
            lines[line].1[column] = row.value;
        }
    }
    lines
}

/// The robots whose accelerations were asked for, in the order of the rows.
fn robots<'a>(rows: &[&'a Row]) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for row in rows.iter().filter(|row| row.quantity == "loop_acceleration") {
        if !names.contains(&row.family.as_str()) {
            names.push(&row.family);
        }
    }
    names
}

/// The best of a motion's points among engines, ours or others: the least error at the shortest step.
fn best<'a>(points: &'a [Point<'a>], name: &str, own: bool) -> Option<&'a Point<'a>> {
    let of = points.iter().filter(|point| point.name == name && (point.engine == OWN) == own);
    of.min_by(|a, b| a.error.total_cmp(&b.error))
}

fn body(rows: &[&Row], figures: &Figures, chunk: &str) -> Markup {
    let (passed, judged) = passed(rows);
    let lines = accelerations(rows);
    let lost: Vec<&&Row> = rows.iter().filter(|row| row.value.is_none() && row.verdict == Verdict::Info).collect();
    let longest = figures.points.iter().rfind(|point| point.engine == OWN && point.name.starts_with("A02"));
    html! {
        section #loops {
            h2 { "Robots with loops, in engines" }
            p.lead { b { (passed) " of " (judged) " gated numbers of ours are within their bounds." } }
            ul {
                @if let Some(point) = longest {
                    li {
                        "Ours runs " (point.name) " for 10 s through its singular configurations: the loops stay closed to "
                        (point.open.map(short).unwrap_or_default()) ", and the energy to " (point.drift.map(short).unwrap_or_default()) " J."
                    }
                }
                @for name in &figures.motions {
                    @if let (Some(own), Some(other)) = (best(&figures.points, name, true), best(&figures.points, name, false)) {
                        li {
                            (name) ": the least error at the end is " (short(own.error)) " by ours, and " (short(other.error)) " by "
                            (other.engine) " " (other.method) "."
                        }
                    }
                }
                @if !lost.is_empty() { li { (lost.len()) " questions have no finite answer of an engine, or it gave up; rows say why." } }
                li { "Positions and velocities that come back are judged here alone. Steps of MuJoCo's Euler, Drake and DART are of first order." }
                li { "Times are of the engine's own clock, with the overhead of calling it through Python. They count on a quiet machine only." }
            }
            div.pair {
                @for (index, name) in figures.motions.iter().enumerate() { (drawings::work(figures, index, name)) }
            }
            (drawings::near(figures))
            (acceleration_table(rows, &lines, chunk))
            (drift_table(figures, chunk))
        }
    }
}

/// The errors of accelerations: methods by robots.
fn acceleration_table(rows: &[&Row], lines: &[(&Row, Vec<Option<f64>>)], chunk: &str) -> Markup {
    html! {
        h3 { "Errors of accelerations" }
        div.scroll {
            table.compact.sortable {
                thead { tr { th scope="col" { "method" } @for name in robots(rows) { th.number scope="col" { (name) } } } }
                tbody {
                    @for (row, values) in lines {
                        tr {
                            th scope="row" {
                                (opener(chunk, &[("study", STUDY), ("engine", &row.engine), ("method", &row.method)], &format!("{} {}", row.engine, row.method)))
                            }
                            @for value in values { td.number { @if let Some(value) = value { (short(*value)) } @else { (labels::glyph(Verdict::Skip)) } } }
                        }
                    }
                }
            }
        }
    }
}

/// Every motion at its shortest step.
fn drift_table(figures: &Figures, chunk: &str) -> Markup {
    let shortest = |point: &&Point| !figures.points.iter().any(|other| other.name == point.name && other.dt < point.dt);
    html! {
        h3 { "Motions at their shortest step" }
        div.scroll {
            table.compact.sortable {
                thead {
                    tr {
                        th scope="col" { "motion" } th scope="col" { "method" } th.number scope="col" { "dt, s" } th.number scope="col" { "error at the end" }
                        th.number scope="col" { "energy drift, J" } th.number scope="col" { "loops open" } th.number scope="col" { "time, s" }
                    }
                }
                tbody {
                    @for point in figures.points.iter().filter(shortest) {
                        tr {
                            th scope="row" {
                                (opener(chunk, &[("study", STUDY), ("family", point.name), ("engine", point.engine), ("method", point.method)], point.name))
                            }
                            td { (point.engine) " " (point.method) }
                            td.number { (short(point.dt)) }
                            td.number { (short(point.error)) }
                            td.number { @if let Some(drift) = point.drift { (short(drift)) } }
                            td.number { @if let Some(open) = point.open { (short(open)) } }
                            td.number { (short(point.seconds)) }
                        }
                    }
                }
            }
        }
        p { "Angles beside the singularity: 10" sup { "−" (NEAR.start()) } " to 10" sup { "−" (NEAR.end()) } " rad." }
    }
}
