//! The section's drawings, by family and quantity: time, memory and error against size, and our methods over the serial ones.

use super::data::{Data, GROWTH, Point, SCALING, Series};
use super::quantities;
use featherbench_report::choices::{Choices, List};
use featherbench_report::figure::{self, Axis, Plot, Rows, Style};
use featherbench_report::{Overview, Part, labels, robot_chunk};
use featherbench_study::figures::{drawing, errors, joined, point, told, with_exponent};
use maud::{Markup, html};
use std::collections::BTreeMap;

/// The quantity whose errors are measured, and that the mass matrix serves, too.
const FORWARD: &str = "fd";
/// The axis across.
const SIZE: &str = "degrees of freedom n";

/// All drawings. The first line and quantity are shown first.
pub(super) fn drawings(overview: &Overview, data: &Data) -> (Markup, Vec<Part>) {
    let (lines, quantities) = (data.lines(), quantities(data));
    let mut drawings = Vec::new();
    for line in &lines {
        for quantity in &quantities {
            let of = |name: &str| data.series.iter().filter(|one| one.line == *line && one.quantity == name).collect::<Vec<_>>();
            let (own, forward) = (of(quantity), of(FORWARD));
            if !own.is_empty() {
                drawings.push(([*line, *quantity].map(str::to_owned).into(), four(overview, data, line, quantity, &own, &forward)));
            }
        }
    }
    let options = quantities.iter().map(|name| ((*name).to_owned(), labels::quantity(name).to_owned())).collect();
    let lists =
        vec![List::of("scaling-line", "Family", lines.iter().copied()), List { id: "scaling-quantity", label: "Quantity", options }];
    let opening = lines.first().into_iter().chain(quantities.first()).map(|word| (*word).to_owned()).collect();
    Choices { name: "scaling-choices", title: "Scaling", lists, opening, drawings }.made()
}

fn four(overview: &Overview, data: &Data, line: &str, quantity: &str, own: &[&Series], forward: &[&Series]) -> Markup {
    let title = |what: &str, quantity: &str| format!("{what} of {} against size, {line}", labels::quantity(quantity));
    let drawn = |name: &str, what: &str, quantity: &str, y: Axis, series| drawing(name, &title(what, quantity), Axis::log(SIZE), y, series);
    html! {
        div.pair {
            (drawn("scaling-time", "Time", quantity, Axis::log("seconds per call"), times(overview, own)))
            (drawn("scaling-memory", "Memory", quantity, Axis::log("resident memory, B"), values(overview, own, "resident", |at| at.resident)))
        }
        div.pair {
            (drawn("scaling-error", "Error", FORWARD, errors("relative error of forward dynamics"), values(overview, forward, "error", |at| at.error)))
            (ratios(overview, data, line, quantity))
        }
    }
}

/// Engines by colour, their methods by mark and dash.
fn styled<'a>(overview: &Overview, series: &[&'a Series<'a>]) -> Vec<(&'a Series<'a>, Style, usize)> {
    let mut methods: BTreeMap<usize, usize> = BTreeMap::new();
    let style = |one: &&'a Series<'a>| {
        let index = *methods.entry(one.engine).and_modify(|count| *count += 1).or_insert(0);
        (*one, overview.styles[one.engine].method(index), index)
    };
    series.iter().map(style).collect()
}

fn rows(overview: &Overview, one: &Series, robot: usize) -> Option<Rows> {
    let filters = [("study", GROWTH), ("engine", overview.engines[one.engine]), ("method", one.method), ("quantity", one.quantity)];
    Some(Rows::of(robot_chunk(robot), overview.robots[robot].name, &filters))
}

fn times(overview: &Overview, series: &[&Series]) -> Vec<figure::Series> {
    let of = |(one, style, dash): (&Series, Style, usize)| {
        let points = one.points.iter().filter_map(|at| {
            let seconds = at.seconds?;
            let counts = if at.estimated {
                "estimate"
            } else if at.valid {
                ""
            } else {
                "does not count"
            };
            Some(figure::Point {
                upwards: [at.low, at.high],
                hollow: !at.valid,
                estimated: at.estimated,
                rows: rows(overview, one, at.robot),
                ..point(overview.robots[at.robot].name, at.size as f64, seconds, [format!("{} s", told(seconds)), counts.to_owned()])
            })
        });
        let name = joined(&[overview.engines[one.engine], labels::method(one.method)]);
        let exponent = one.exponent.map(|[exponent, ..]| exponent);
        figure::Series { dash, ..figure::Series::new(with_exponent(name, exponent, 2), style, points.collect()) }
    };
    styled(overview, series).into_iter().map(of).collect()
}

fn values(overview: &Overview, series: &[&Series], words: &str, value: fn(&Point) -> Option<f64>) -> Vec<figure::Series> {
    let of = |(one, style, dash): (&Series, Style, usize)| {
        let points = one.points.iter().filter_map(|at| {
            let value = value(at)?;
            let words = [format!("{words} {}", told(value))];
            Some(figure::Point {
                rows: rows(overview, one, at.robot),
                ..point(overview.robots[at.robot].name, at.size as f64, value, words)
            })
        });
        let name = joined(&[overview.engines[one.engine], labels::method(one.method)]);
        figure::Series { dash, ..figure::Series::new(name, style, points.collect()) }
    };
    styled(overview, series).into_iter().map(of).collect()
}

/// Our methods over the serial ones, with the line where both are equal: the mass matrix in operations and in time, others in time, on the
/// most threads.
fn ratios(overview: &Overview, data: &Data, line: &str, quantity: &str) -> Markup {
    let drawn = |name: &str, style: Style, dash: usize, ratios: &[(usize, u64, f64)], filters: &[(&str, &str)]| {
        let points = ratios.iter().map(|&(robot, size, ratio)| {
            let about = overview.robots[robot].name;
            figure::Point {
                rows: Some(Rows::of(robot_chunk(robot), about, filters)),
                ..point(about, size as f64, ratio, [format!("{name}: {}", told(ratio))])
            }
        });
        figure::Series { dash, ..figure::Series::new(name, style, points.collect()) }
    };
    let mut series = Vec::new();
    for one in data.ratios.iter().filter(|one| quantity == FORWARD && one.line == line) {
        let [work, time] = [(SCALING, "work_ratio"), (GROWTH, "time_ratio")].map(|(study, metric)| [("study", study), ("metric", metric)]);
        series.push(drawn("ltdl / aba, operations", Style { mark: 0, ..Style::NEUTRAL }, 1, &one.work, &work));
        series.push(drawn("ltdl / aba", Style::nth(1).coloured(0), 0, &one.time, &time));
    }
    let beside: Vec<_> = data.beside.iter().filter(|one| one.line == line && one.quantity == quantity).collect();
    let most = beside.iter().filter_map(|one| one.threads).max().unwrap_or(1);
    for (place, one) in beside.into_iter().filter(|one| one.threads.unwrap_or(most) == most).enumerate() {
        let filters = [("study", GROWTH), ("metric", "time_ratio"), ("method", one.method), ("quantity", one.quantity)];
        series.push(drawn(&format!("{} / {}", one.method, one.over), Style::nth(place + 2).coloured(0), place + 1, &one.time, &filters));
    }
    series.retain(|one| !one.points.is_empty());
    let title = format!("Our methods over the serial ones, {}, {line}", labels::quantity(quantity));
    let plot = Plot { bands: vec![[1.0, 1.0]], ..Plot::new(title, Axis::log(SIZE), Axis::log("method / serial method"), series) };
    plot.drawing("scaling-ratio", "No method of ours is compared with a serial one here.")
}
