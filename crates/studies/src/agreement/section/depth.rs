//! Section: error against depth. The script draws it; its frame and choices are made here.

use std::collections::BTreeMap;

use featherbench_report::{Overview, labels};
use featherbench_results::Row;
use maud::{Markup, html};
use serde::Serialize;

use super::{ERROR_METRICS, is_error_measure};

/// Errors of one quantity under one measure.
#[derive(Debug, Serialize)]
pub struct ErrorPlot<'a> {
    /// The quantity's name.
    pub quantity: &'a str,
    /// The measure's name.
    pub metric: &'a str,
    /// Both in words.
    pub title: String,
    /// One per engine, method and scalar.
    pub traces: Vec<ErrorTrace<'a>>,
}

/// Errors of one engine's method.
#[derive(Debug, Serialize)]
pub struct ErrorTrace<'a> {
    engine: usize,
    method: &'a str,
    scalar: &'a str,
    points: Vec<ErrorPoint<'a>>,
}

/// One row's error: its robot's index, its states, value, bound and conditioning bound.
#[derive(Debug, Serialize)]
struct ErrorPoint<'a>(usize, &'a str, f64, Option<f64>, Option<f64>);

/// Collects a run's rows.
pub fn plots<'a>(overview: &Overview<'a>, rows: &'a [Row]) -> Vec<ErrorPlot<'a>> {
    type Key<'a> = (usize, &'a str, &'a str);
    let mut plots: BTreeMap<(&str, &str), BTreeMap<Key, Vec<ErrorPoint>>> = BTreeMap::new();
    for row in rows.iter().filter(|row| is_error_measure(row)) {
        let (Some(robot), Some(engine), Some(value)) = (overview.robot(&row.robot), overview.engine(&row.engine), row.value) else {
            continue;
        };
        if overview.robots[robot].depth.is_some_and(|depth| depth > 0) {
            let traces = plots.entry((&row.quantity, &row.metric)).or_default();
            let points = traces.entry((engine, &row.method, &row.precision)).or_default();
            points.push(ErrorPoint(robot, &row.states, value.abs(), row.bound, row.floor));
        }
    }
    let mut plots: Vec<ErrorPlot> = plots
        .into_iter()
        .map(|((quantity, metric), traces)| ErrorPlot {
            quantity,
            metric,
            title: labels::error(quantity, metric),
            traces: traces.into_iter().map(|((engine, method, scalar), points)| ErrorTrace { engine, method, scalar, points }).collect(),
        })
        .collect();
    // Forward before backward error, and the rest by name.
    let metric_rank = |metric: &str| ERROR_METRICS.iter().position(|&known| known == metric).unwrap_or(ERROR_METRICS.len());
    plots.sort_by_key(|plot| (labels::quantity_rank(plot.quantity), metric_rank(plot.metric)));
    plots
}

/// Writes the section.
pub fn markup(plots: &[ErrorPlot]) -> Markup {
    // Forward dynamics loses digits first; if a run has it, it is the first plot shown.
    let opening = plots.iter().position(|plot| plot.quantity == "fd").unwrap_or(0);
    html! {
        section #depth {
            h2 { "Error against depth" }
            p.lead { "How error grows with the longest path from the base. Each mark is a robot's worst row under the choices made here; click it to see its rows." }
            @if plots.is_empty() {
                p.empty { "This run holds no errors of robots with a depth." }
            } @else {
                div.controls {
                    label { "Quantity " select #depth-quantity {
                        @for (index, plot) in plots.iter().enumerate() { option value=(index) selected[index == opening] { (plot.title) } }
                    } }
                    label { "Family " select #depth-family { option value="" { "all" } } }
                    label { "States " select #depth-case { option value="" { "all" } } }
                }
                div #depth-plot.plot role="group" aria-label="Plot of error against depth" {}
                p.note {
                    "Dashed: the tightest gate at each depth. Dotted: half the spacing of doubles at 1, 2⁻⁵³. Hollow marks at the lower edge are errors of exactly zero. "
                    "Lines join the worst error at each depth."
                }
            }
        }
    }
}
