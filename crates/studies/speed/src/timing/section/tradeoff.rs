//! Section: time against true error of forward dynamics: the cost of a digit.

use featherbench_report::numbers::{scientific, short};
use featherbench_report::{Overview, Part};
use featherbench_results::Row;
use maud::{Markup, html};

use super::drawings;
use super::time::TimeLine;
use featherbench_comparison::accuracy;

/// The quantity whose time and error are compared.
const QUANTITY: &str = "fd";
/// The inputs of the times: another state at each call.
const INPUTS: &str = "stream";

/// One method on one robot.
#[derive(Clone, Debug)]
pub struct Tradeoff<'a> {
    /// Index of the robot.
    pub robot: usize,
    /// Index of the engine.
    pub engine: usize,
    /// Its method.
    pub method: &'a str,
    /// Its arithmetic.
    pub scalar: &'a str,
    /// Nanoseconds per call.
    pub ns: f64,
    /// First decile, if the run has it.
    pub p10: Option<f64>,
    /// Last decile.
    pub p90: Option<f64>,
    /// Median error.
    pub error: f64,
    /// Its first quartile.
    pub q1: Option<f64>,
    /// Its third quartile.
    pub q3: Option<f64>,
    /// Whether no other method is both faster and more accurate.
    pub front: bool,
}

/// Every method that has both a time and an error, by robot, the fastest first.
pub fn points<'a>(overview: &Overview<'a>, rows: &'a [Row], times: &[TimeLine<'a>]) -> Vec<Tradeoff<'a>> {
    let errors = accuracy::section::errors(overview, rows, QUANTITY);
    let mut found: Vec<Tradeoff> = Vec::new();
    for line in times.iter().filter(|line| line.algorithm == QUANTITY && line.cache == INPUTS) {
        let TimeLine { engine, method, scalar, .. } = *line;
        // An invalid time is wrong by some percent; here decades matter.
        for point in &line.points {
            let Some(errors) = errors.get(&(point.robot, engine, method, scalar)) else { continue };
            found.push(Tradeoff {
                robot: point.robot,
                engine,
                method,
                scalar,
                ns: point.ns,
                p10: point.p10,
                p90: point.p90,
                error: errors.median,
                q1: errors.q1,
                q3: errors.q3,
                front: false,
            });
        }
    }
    found.sort_by(|a, b| a.robot.cmp(&b.robot).then(a.ns.total_cmp(&b.ns)).then(a.error.total_cmp(&b.error)));
    // In order of time, a point is on the front if it is more accurate than every faster one.
    let mut least = (usize::MAX, f64::INFINITY);
    for point in &mut found {
        if point.robot != least.0 {
            least = (point.robot, f64::INFINITY);
        }
        point.front = point.error < least.1;
        least.1 = least.1.min(point.error);
    }
    found
}

/// The robots with their numbers of methods.
fn robots(points: &[Tradeoff]) -> Vec<(usize, usize)> {
    let mut robots: Vec<(usize, usize)> = Vec::new();
    for point in points {
        match robots.last_mut().filter(|(robot, _)| *robot == point.robot) {
            Some((_, methods)) => *methods += 1,
            None => robots.push((point.robot, 1)),
        }
    }
    robots
}

/// The largest of the robots with the most methods: there they differ most.
pub fn richest(overview: &Overview, points: &[Tradeoff]) -> Option<usize> {
    robots(points).into_iter().max_by_key(|&(robot, methods)| (methods, overview.robots[robot].nv)).map(|(robot, _)| robot)
}

/// Writes the section, and the drawings that it does not show at first.
pub fn markup(overview: &Overview, points: &[Tradeoff]) -> (Markup, Vec<Part>) {
    let (drawn, parts) = drawings::tradeoffs(overview, points, &robots(points), richest(overview, points));
    let body = html! {
        section #tradeoff {
            h2 { "Work–precision" }
            p.lead {
                "What a digit costs: time of one forward dynamics against its true error. Below and to the left is better; the line joins the methods that nothing beats in both. "
                "Only methods whose time was measured are here."
            }
            (drawn)
            details {
                summary { "As a table" }
                div.scroll.tall {
                    table.compact.sortable {
                        thead {
                            tr {
                                th scope="col" { "robot" } th scope="col" { "engine" } th scope="col" { "method" } th.number scope="col" { "ns per call" }
                                th.number scope="col" { "median error" } th scope="col" { "front" }
                            }
                        }
                        tbody {
                            @for point in points {
                                tr {
                                    th scope="row" { (overview.robots[point.robot].name) }
                                    td { (overview.engines[point.engine]) }
                                    td { (point.method) @if point.scalar != "f64" { " " (point.scalar) } }
                                    td.number { (short(point.ns)) }
                                    td.number { (scientific(point.error)) }
                                    td { @if point.front { "● unbeaten" } }
                                }
                            }
                        }
                    }
                }
            }
        }
    };
    (body, parts)
}
