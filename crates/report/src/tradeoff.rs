//! Section: time against true error of forward dynamics: the cost of a digit.

use std::collections::BTreeMap;

use maud::{Markup, html};
use serde::Serialize;

use crate::accuracy::Accuracy;
use crate::accuracy_section::exact;
use crate::figures::TimeLine;
use crate::numbers::short;
use crate::overview::Overview;

/// The quantity whose time and error are compared.
const QUANTITY: &str = "fd";
/// The inputs of the times: another state at each call.
const INPUTS: &str = "stream";

/// One method on one model.
#[derive(Clone, Debug, Serialize)]
pub struct Tradeoff<'a> {
    /// Index of the model.
    pub model: usize,
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

/// Every method that has both a time and an error, by model, the fastest first.
pub fn tradeoffs<'a>(digits: &Accuracy<'a>, times: &[TimeLine<'a>]) -> Vec<Tradeoff<'a>> {
    let answers: BTreeMap<(usize, &str, &str), usize> = digits
        .answers
        .iter()
        .enumerate()
        .filter(|(_, answer)| answer.quantity == QUANTITY)
        .map(|(index, answer)| ((answer.engine, answer.method, answer.scalar), index))
        .collect();
    let mut found: Vec<Tradeoff> = Vec::new();
    for line in times.iter().filter(|line| line.algorithm == QUANTITY && line.cache == INPUTS) {
        let TimeLine { engine, method, scalar, .. } = *line;
        let Some(&answer) = answers.get(&(engine, method, scalar)) else { continue };
        // An invalid time is wrong by some percent; here decades matter.
        for point in &line.points {
            let Some(cell) = digits.cell(point.model, answer) else { continue };
            let Some(error) = cell.median else { continue };
            let (model, ns, p10, p90, q1, q3) = (point.model, point.ns, point.p10, point.p90, cell.q1, cell.q3);
            found.push(Tradeoff { model, engine, method, scalar, ns, p10, p90, error, q1, q3, front: false });
        }
    }
    found.sort_by(|a, b| a.model.cmp(&b.model).then(a.ns.total_cmp(&b.ns)).then(a.error.total_cmp(&b.error)));
    // In order of time, a point is on the front if it is more accurate than every faster one.
    let mut least = (usize::MAX, f64::INFINITY);
    for point in &mut found {
        if point.model != least.0 {
            least = (point.model, f64::INFINITY);
        }
        point.front = point.error < least.1;
        least.1 = least.1.min(point.error);
    }
    found
}

/// Writes the section; nothing if no method has both.
pub fn section(overview: &Overview, points: &[Tradeoff]) -> Markup {
    let mut models: Vec<(usize, usize)> = Vec::new();
    for point in points {
        match models.last_mut().filter(|(model, _)| *model == point.model) {
            Some((_, methods)) => *methods += 1,
            None => models.push((point.model, 1)),
        }
    }
    // The largest of the models with the most methods: there they differ most.
    let opening = models.iter().max_by_key(|&&(model, methods)| (methods, overview.models[model].nv)).map(|&(model, _)| model);
    html! {
        @if !points.is_empty() {
            section #tradeoff {
                h2 { "Work–precision" }
                p.lead {
                    "What a digit costs: time of one forward dynamics against its true error. Below and to the left is better; the line joins the methods that nothing beats in both. "
                    "Only methods whose time was measured are here."
                }
                div.controls {
                    label { "Model " select #tradeoff-model {
                        @for &(model, _) in &models { option value=(model) selected[Some(model) == opening] { (overview.models[model].name) } }
                    } }
                }
                div #tradeoff-plot.plot role="group" aria-label="Plot of true error against time" {}
                details {
                    summary { "As a table" }
                    div.scroll.tall {
                        table.compact.sortable {
                            thead {
                                tr {
                                    th scope="col" { "model" } th scope="col" { "engine" } th scope="col" { "method" } th.number scope="col" { "ns per call" }
                                    th.number scope="col" { "median error" } th scope="col" { "front" }
                                }
                            }
                            tbody {
                                @for point in points {
                                    tr {
                                        th scope="row" { (overview.models[point.model].name) }
                                        td { (overview.engines[point.engine]) }
                                        td { (point.method) @if point.scalar != "f64" { " " (point.scalar) } }
                                        td.number { (short(point.ns)) }
                                        td.number { (exact(point.error)) }
                                        td { @if point.front { "● unbeaten" } }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}
