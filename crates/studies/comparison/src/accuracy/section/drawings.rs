//! The section's drawings: the median error against the truth along one axis of one family, with the table of fitted exponents.

use std::collections::BTreeMap;

use featherbench_report::choices::{Choices, List};
use featherbench_report::figure::{Axis as Paper, Point, Rows, Series, Style};
use featherbench_report::numbers::short;
use featherbench_report::{Overview, Part, Shown, labels, robot_chunk};
use maud::{Markup, html};

use super::STUDY;
use super::axes::Axis;
use super::data::{Accuracy, Cell, Curve, ULP, lost};
use featherbench_study::figures::{ZERO, drawing, errors, joined, point, told, with_exponent};

/// All drawings, by quantity, axis and family. A quantity without a curve can be chosen too: the table of medians has it.
pub(super) fn drawings(overview: &Overview, accuracy: &Accuracy) -> (Markup, Vec<Part>) {
    let quantity = |curve: &Curve| accuracy.answers[curve.answer].quantity;
    let mut points: BTreeMap<&str, usize> = BTreeMap::new();
    for curve in &accuracy.curves {
        *points.entry(curve.family).or_default() += curve.points.len();
    }
    // The family with the most to show comes first.
    let mut families: Vec<&str> = points.keys().copied().collect();
    families.sort_by_key(|family| std::cmp::Reverse(points[family]));
    let mut drawings = Vec::new();
    let mut lacking = false;
    for name in accuracy.quantities() {
        let before = drawings.len();
        for axis in Axis::ALL {
            for family in &families {
                let of = |curve: &&Curve| quantity(curve) == name && curve.axis == axis && curve.family == *family;
                let curves: Vec<&Curve> = accuracy.curves.iter().filter(of).collect();
                if !curves.is_empty() {
                    let drawn = html! {
                        (drawn(overview, accuracy, &curves, name, axis, family))
                        (growth(overview, accuracy, &curves))
                    };
                    drawings.push(([name, axis.name(), family].map(str::to_owned).into(), drawn));
                }
            }
        }
        if drawings.len() == before {
            lacking = true;
            let nothing = html! { p.empty { "No family of robots has errors of " (labels::quantity(name)) " along an axis." } };
            drawings.push(([name, "", ""].map(str::to_owned).into(), nothing));
        }
    }
    let entry = |value: &str, words: &str| (value.to_owned(), words.to_owned());
    let none = || lacking.then(|| entry("", "–"));
    let used = Axis::ALL.into_iter().filter(|axis| accuracy.curves.iter().any(|curve| curve.axis == *axis));
    let quantities = accuracy.quantities().into_iter().map(|quantity| entry(quantity, labels::quantity(quantity))).collect();
    let lists = vec![
        List { id: "accuracy-quantity", label: "Quantity", options: quantities },
        List { id: "accuracy-axis", label: "Against", options: used.map(|axis| entry(axis.name(), axis.title())).chain(none()).collect() },
        List {
            id: "accuracy-family",
            label: "Family",
            options: families.iter().map(|family| entry(family, family)).chain(none()).collect(),
        },
    ];
    let opening = drawings.first().map(|(values, _): &(Vec<String>, Markup)| values.clone()).unwrap_or_default();
    Choices { name: "accuracy-choices", title: "Accuracy", lists, opening, drawings }.made()
}

/// The rows that the drawings show: those of quantities with a curve.
pub(super) fn shown(accuracy: &Accuracy) -> Vec<Shown> {
    let has_curve = |quantity: &&str| accuracy.curves.iter().any(|curve| accuracy.answers[curve.answer].quantity == *quantity);
    let of = |quantity: &str| Shown { quantity: quantity.to_owned(), metric: None, choice: ("accuracy-quantity", quantity.to_owned()) };
    accuracy.quantities().into_iter().filter(has_curve).map(of).collect()
}

fn drawn(overview: &Overview, accuracy: &Accuracy, curves: &[&Curve], quantity: &str, axis: Axis, family: &str) -> Markup {
    let mut methods: BTreeMap<usize, usize> = BTreeMap::new();
    let mut floors: Vec<[f64; 2]> = Vec::new();
    let mut series = Vec::new();
    for curve in curves {
        let answer = &accuracy.answers[curve.answer];
        let index = *methods.entry(answer.engine).and_modify(|count| *count += 1).or_insert(0);
        let cells = || curve.points.iter().map(|&(x, cell)| (x, &accuracy.cells[cell]));
        for (x, floor) in cells().filter_map(|(x, cell)| Some((x, cell.floor?))) {
            if floors.iter().all(|known| known[0] != x) {
                floors.push([x, floor]);
            }
        }
        let engine = overview.engines[answer.engine];
        let name = joined(&[engine, labels::method(answer.method), if answer.scalar == "f64" { "" } else { answer.scalar }]);
        let broad = curve.fit.zip(curve.span).map(|(fit, span)| span.map(|x| featherbench_study::figures::fitted(fit, x)).into());
        series.push(Series {
            dash: index,
            broad: broad.unwrap_or_default(),
            ..Series::new(
                with_exponent(name, curve.fit.map(|fit| fit.slope), 2),
                overview.styles[answer.engine].method(index),
                cells().filter_map(|(x, cell)| mark(overview, accuracy, x, cell)).collect(),
            )
        });
    }
    if !floors.is_empty() {
        floors.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let points = floors.into_iter().map(|[x, floor]| point("conditioning bound", x, floor, [told(floor)]));
        series.push(Series { dash: 1, ..Series::new("conditioning bound", Style::NEUTRAL, points.collect()) });
    }
    series.push(Series::level("2⁻⁵²", ULP));
    let words = match axis {
        Axis::Depth => "depth: joints from the base to the farthest leaf",
        Axis::Tip => "mass at the tip, over the usual",
        Axis::Offset => "distance of the base from the world's origin, m",
    };
    // Ticks at the robots themselves: between them there is nothing.
    let places = curves.iter().flat_map(|curve| curve.points.iter().map(|&(x, _)| x)).collect();
    let title = format!("Median error of {} along {}, {family}", labels::quantity(quantity), axis.title());
    let upwards = errors(format!("median relative error: {}", labels::quantity(quantity)));
    drawing("accuracy-plot", &title, Paper::log(words).at(places), upwards, series)
}

fn mark(overview: &Overview, accuracy: &Accuracy, x: f64, cell: &Cell) -> Option<Point> {
    let answer = &accuracy.answers[cell.answer];
    let (robot, median) = (overview.robots[cell.robot].name, cell.median?);
    let number = |value: Option<f64>| value.map_or_else(|| "–".into(), told);
    let digits = lost(median);
    let about = [
        format!("{} by {}", labels::quantity(answer.quantity), accuracy.name(overview, cell.answer)),
        if cell.quantity == answer.quantity { String::new() } else { "seen through products".into() },
        format!("median {}, quartiles {} to {}, largest {}", told(median), number(cell.q1), number(cell.q3), number(cell.worst)),
        if digits < 0.05 { "no digit lost".into() } else { format!("{digits:.1} digits lost") },
        cell.floor
            .filter(|_| median > 0.0)
            .map(|floor| format!("conditioning bound {}: the median is {} of it", told(floor), short(median / floor)))
            .unwrap_or_default(),
        cell.verdict.map(|verdict| format!("{} {verdict}", labels::glyph(verdict))).unwrap_or_default(),
    ];
    let filters = [("study", STUDY), ("engine", overview.engines[answer.engine]), ("method", answer.method), ("quantity", cell.quantity)];
    Some(Point {
        upwards: [cell.q1, cell.q3],
        hollow: median < ZERO || cell.quantity != answer.quantity,
        rows: Some(Rows::of(robot_chunk(cell.robot), robot, &filters)),
        ..point(robot, x, median, about)
    })
}

/// The fitted exponents of the curves of a drawing.
fn growth(overview: &Overview, accuracy: &Accuracy, curves: &[&Curve]) -> Markup {
    html! {
        details open {
            summary { "Growth: fitted exponents" }
            p.note { "Error ∝ xᵖ by least squares on logarithms, with the standard error of p; beside it the exponent between the last two robots, where what grows has left the rest behind." }
            div.scroll.tall {
                table.accuracy-growth.compact.sortable {
                    thead {
                        tr {
                            th scope="col" { "engine and method" } th scope="col" { "quantity" } th scope="col" { "against" } th scope="col" { "family" }
                            th.number scope="col" { "robots" } th.number scope="col" { "p" } th.number scope="col" { "p at the end" } th.number scope="col" { "error at the end" }
                        }
                    }
                    tbody {
                        @for curve in curves {
                            @let end = curve.points.last().and_then(|&(_, cell)| accuracy.cells[cell].median);
                            tr {
                                th scope="row" { (accuracy.linked(overview, curve.answer)) }
                                td { (labels::quantity(accuracy.answers[curve.answer].quantity)) }
                                td { (curve.axis.title()) }
                                td { (curve.family) }
                                td.number { (curve.points.len()) }
                                td.number { @if let Some(fit) = curve.fit { (format!("{:.2} ± {:.2}", fit.slope, fit.error)) } @else { "too few" } }
                                td.number { @if let Some(last) = curve.last { (format!("{last:.2}")) } }
                                td.number { @if let Some(end) = end { (short(end)) } }
                            }
                        }
                    }
                }
            }
        }
    }
}
