//! The section's drawings: the gap of singular values by which ranks are told, and estimates with their intervals.

use super::Figures;
use featherbench_report::figure::{Axis, Line, Point, Series, Style};
use featherbench_study::figures::{drawing, errors, point, scattered, told};
use maud::Markup;

/// Of each way to a rank two series of one colour: the last singular value that is kept, and the first that is dropped.
pub(super) fn gaps(figures: &Figures) -> Markup {
    let mut series = Vec::new();
    for (index, (way, robots)) in figures.gaps.iter().filter(|(_, robots)| !robots.is_empty()).enumerate() {
        for (words, dropped) in [("kept", false), ("dropped", true)] {
            let robot = |&(robot, unknowns, last, first): &(&str, f64, f64, f64)| {
                let value = if dropped { first } else { last };
                Point { hollow: dropped, ..point(robot, unknowns, value, [format!("{words}: {} of the largest", told(value))]) }
            };
            series.push(scattered(index, format!("{way}, {words}"), robots.iter().map(robot).collect()));
        }
    }
    let (x, y) = (Axis::log("unknowns"), errors("singular value / largest"));
    drawing("identification-gaps", "Smallest kept and largest dropped singular value of each robot", x, y, series)
}

/// Errors in units of half an interval: within ±1 the interval holds the truth.
pub(super) fn intervals(figures: &Figures) -> Markup {
    let one = |(index, &(name, estimate, truth, half)): (usize, &(&str, f64, f64, f64))| {
        let over = |value: f64| (value - truth) / half;
        let about = [format!("estimate {} ± {}", told(estimate), told(half)), format!("truth {}", told(truth))];
        let upwards = [estimate - half, estimate + half].map(|end| Some(over(end)));
        Point { upwards, ..point(name, index as f64 + 1.0, over(estimate), about) }
    };
    let points = figures.intervals.iter().enumerate().map(one).collect();
    let estimates = Series { line: Line::Marks, ..Series::new("estimate with its 95 % interval", Style::nth(0), points) };
    let (x, y) = (Axis::linear("base parameter"), Axis::linear("(estimate − truth) / half-width"));
    drawing(
        "identification-intervals",
        "Error of each base parameter with its interval",
        x,
        y,
        vec![estimates, Series::level("truth", 0.0)],
    )
}
