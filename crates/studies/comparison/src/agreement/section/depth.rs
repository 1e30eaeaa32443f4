//! Section: error against depth, by quantity. A list shows the marks of one family.

use std::collections::{BTreeMap, BTreeSet};

use featherbench_report::choices::{Choices, List};
use featherbench_report::figure::{Axis, Point, Rows, Series, Style};
use featherbench_report::numbers::smaller;
use featherbench_report::{Overview, Part, Shown, labels, robot_chunk};
use featherbench_results::Row;
use maud::{Markup, html};

use super::{ERROR_METRICS, STUDY, is_error_measure};
use featherbench_study::figures::{drawing, errors, joined, point, told};

/// Errors of one quantity under one measure.
#[derive(Debug)]
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
#[derive(Debug)]
pub struct ErrorTrace<'a> {
    engine: usize,
    method: &'a str,
    scalar: &'a str,
    points: Vec<ErrorPoint<'a>>,
}

/// One row's error: its robot's index, its states, value and bound.
#[derive(Debug)]
struct ErrorPoint<'a>(usize, &'a str, f64, Option<f64>);

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
            points.push(ErrorPoint(robot, &row.states, value.abs(), row.bound));
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

/// Writes the section, and the drawings that it does not show at first.
pub fn markup(overview: &Overview, plots: &[ErrorPlot]) -> (Markup, Vec<Part>) {
    let (drawn, parts) = drawings(overview, plots);
    let body = html! {
        section #depth {
            h2 { "Error against depth" }
            p.lead { "How error grows with the longest path from the base. Each mark is the worst row of a family's robots at a depth, over all states; click it to see the robot's rows of that kind of state." }
            @if plots.is_empty() {
                p.empty { "This run holds no errors of robots with a depth." }
            } @else {
                div.controls {
                    label { "Marks of family " select #depth-family { option value="" { "all" } @for family in families(overview, plots) { option value=(family) { (family) } } } }
                }
                (drawn)
                p.note {
                    "Dashed: the tightest gate at each depth. Dotted: half the spacing of doubles at 1, 2⁻⁵³. Hollow marks at the lower edge are errors of exactly zero. "
                    "Lines join the worst error at each depth, of all families."
                }
            }
        }
    };
    (body, parts)
}

/// The rows that the drawings show.
pub fn shown(plots: &[ErrorPlot]) -> Vec<Shown> {
    let of = |(index, plot): (usize, &ErrorPlot)| Shown {
        quantity: plot.quantity.to_owned(),
        metric: Some(plot.metric.to_owned()),
        choice: ("depth-quantity", index.to_string()),
    };
    plots.iter().enumerate().map(of).collect()
}

/// The families that have an error.
fn families<'a>(overview: &Overview<'a>, plots: &[ErrorPlot]) -> BTreeSet<&'a str> {
    let points = plots.iter().flat_map(|plot| &plot.traces).flat_map(|trace| &trace.points);
    points.map(|point| overview.robots[point.0].family).filter(|family| !family.is_empty()).collect()
}

/// The drawings, by quantity.
fn drawings(overview: &Overview, plots: &[ErrorPlot]) -> (Markup, Vec<Part>) {
    // Forward dynamics loses digits first; if a run has it, it is the first plot shown.
    let opening = plots.iter().position(|plot| plot.quantity == "fd").unwrap_or(0);
    let drawn = |(index, plot): (usize, &ErrorPlot)| {
        let x = Axis::log("depth: joints from the base to the farthest leaf");
        (vec![index.to_string()], drawing("depth-plot", &plot.title, x, errors(&plot.title), series(overview, plot)))
    };
    let drawings = plots.iter().enumerate().map(drawn).collect();
    let options = plots.iter().enumerate().map(|(index, plot)| (index.to_string(), plot.title.clone())).collect();
    let lists = vec![List { id: "depth-quantity", label: "Quantity", options }];
    Choices { name: "depth-choices", title: "Error against depth", lists, opening: vec![opening.to_string()], drawings }.made()
}

/// The traces of a plot, then its gates and a level.
fn series(overview: &Overview, plot: &ErrorPlot) -> Vec<Series> {
    let mut gates: BTreeMap<u64, f64> = BTreeMap::new();
    let mut methods: BTreeMap<usize, usize> = BTreeMap::new();
    let mut series = Vec::new();
    for trace in &plot.traces {
        let index = *methods.entry(trace.engine).and_modify(|count| *count += 1).or_insert(0);
        // The worst row of a family at a depth.
        let mut worst: BTreeMap<(&str, Option<u64>), &ErrorPoint> = BTreeMap::new();
        for point in &trace.points {
            if let (Some(bound), Some(depth)) = (point.3, overview.robots[point.0].depth) {
                gates.entry(depth).and_modify(|least| *least = smaller(*least, bound)).or_insert(bound);
            }
            let about = &overview.robots[point.0];
            let known = worst.entry((about.family, about.depth)).or_insert(point);
            if point.2 > known.2 {
                *known = point;
            }
        }
        let engine = overview.engines[trace.engine];
        let mut points: Vec<Point> = worst.into_values().map(|point| mark(overview, plot, trace, point)).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        let mut envelope: Vec<[f64; 2]> = Vec::new();
        for point in &points {
            match envelope.last_mut().filter(|last| last[0] == point.x) {
                Some(last) => last[1] = point.y,
                None => envelope.push([point.x, point.y]),
            }
        }
        let name = joined(&[engine, labels::method(trace.method), if trace.scalar == "f64" { "" } else { trace.scalar }]);
        series.push(Series { dash: index, path: Some(envelope), ..Series::new(name, overview.styles[trace.engine].method(index), points) });
    }
    if !gates.is_empty() {
        let gate =
            |(depth, bound): (u64, f64)| point("gate", depth as f64, bound, [format!("{}, the tightest at depth {depth}", told(bound))]);
        series.push(Series { dash: 1, ..Series::new("gate", Style::NEUTRAL, gates.into_iter().map(gate).collect()) });
    }
    series.push(Series::level("2⁻⁵³", 0.5 * f64::EPSILON));
    series
}

fn mark(overview: &Overview, plot: &ErrorPlot, trace: &ErrorTrace, of: &ErrorPoint) -> Point {
    let &ErrorPoint(robot, states, value, bound) = of;
    let about = &overview.robots[robot];
    let depth = about.depth.unwrap_or(0);
    let gate = bound.map(|bound| format!(", gate {}", told(bound))).unwrap_or_default();
    let filters = [
        ("study", STUDY),
        ("engine", overview.engines[trace.engine]),
        ("quantity", plot.quantity),
        ("metric", plot.metric),
        ("states", states),
        ("method", trace.method),
    ];
    Point {
        rows: Some(Rows::of(robot_chunk(robot), about.name, &filters)),
        ..point(about.name, depth as f64, value, [format!("depth {depth}"), format!("{}{gate}", told(value)), states.to_owned()])
    }
}
