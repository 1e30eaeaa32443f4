//! The section's drawings: errors over refinements and over cost, and shapes.

use super::Line;
use featherbench_report::figure::{Axis, Series, style};
use featherbench_study::figures::{drawing, errors, nth, point, told};
use maud::Markup;
use std::collections::BTreeMap;

/// Engines have their colours, and their elements are told apart by mark and dash; cases have colours of a list.
fn series(lines: &[Line], about: impl Fn(f64, f64) -> [String; 2]) -> Vec<Series> {
    let mut elements: BTreeMap<&str, usize> = BTreeMap::new();
    let mut series = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let points = line.points.iter().map(|&[x, y]| point(&line.name, x, y, about(x, y))).collect();
        let Some(engine) = line.engine else {
            series.push(nth(index, &line.name, points));
            continue;
        };
        let element = *elements.entry(engine).and_modify(|count| *count += 1).or_insert(0);
        series.push(Series { dash: element, ..Series::new(&line.name, style(engine).method(element), points) });
    }
    series
}

/// Errors against the number of elements.
pub(super) fn refined(name: &str, lines: &[Line], what: &str) -> Markup {
    let series = series(lines, |x, error| [format!("{} elements", told(x)), told(error)]);
    drawing(name, &format!("{what} against the number of elements"), Axis::log("elements"), errors(what), series)
}

/// Errors of the first frequency against the time of a forward dynamics.
pub(super) fn cost(lines: &[Line]) -> Markup {
    let series = series(lines, |x, error| [format!("{} ns", told(x)), told(error)]);
    let (x, y) = (Axis::log("forward dynamics, ns"), errors("error of the first frequency"));
    drawing("continuum-cost", "Error of the first frequency against the time of a forward dynamics", x, y, series)
}

/// Shapes, a line for each case. The axes have scales of their own.
pub(super) fn shapes(name: &str, title: &str, lines: &[Line], [x, y]: [&str; 2]) -> Markup {
    let series = series(lines, |x, y| [told(x), told(y)]);
    drawing(name, title, Axis::linear(x), Axis::linear(y), series)
}
