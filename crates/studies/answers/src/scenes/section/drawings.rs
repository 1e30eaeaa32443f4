//! The section's drawings: the rose of felt friction, errors against the step, and the error of the derivative of a bounce.

use super::{Errors, Line};
use featherbench_report::Part;
use featherbench_report::choices::{Choices, List};
use featherbench_report::figure::{Axis, Point, Series};
use featherbench_study::figures::{drawing, errors, joined, nth, point, told};
use maud::Markup;

fn series(lines: &[Line], place: impl Fn(&str, (f64, f64)) -> Point) -> Vec<Series> {
    let line = |(index, line): (usize, &Line)| {
        let name = joined(&[line.engine, &line.method]);
        let points = line.points.iter().map(|&at| place(&name, at)).collect();
        nth(index, name, points)
    };
    lines.iter().enumerate().map(line).collect()
}

/// The friction that a sled feels, over its heading.
pub(super) fn rose(lines: &[Line]) -> Markup {
    let place = |name: &str, (heading, felt): (f64, f64)| {
        let (sin, cos) = heading.to_radians().sin_cos();
        point(name, felt * cos, felt * sin, [format!("heading {}°", told(heading)), format!("{} μ", told(felt))])
    };
    let (x, y) = (Axis::linear("felt friction along x / μ"), Axis::linear("felt friction along y / μ"));
    drawing("scenes-rose", "Friction that a sled feels, over its heading", x, y, series(lines, place))
}

fn stepped(lines: &[Line]) -> Vec<Series> {
    series(lines, |name, (dt, error)| point(name, dt, error, [format!("dt = {} s", told(dt)), format!("error {}", told(error))]))
}

/// Errors against the step, question by question.
pub(super) fn questions(all: &[Errors]) -> (Markup, Vec<Part>) {
    let drawn = |one: &Errors| {
        let title = format!("{}: error against the step", one.question);
        (vec![one.question.clone()], drawing("scenes-errors", &title, Axis::log("step dt, s"), errors("error"), stepped(&one.lines)))
    };
    let lists = vec![List::of("scenes-question", "Error of", all.iter().map(|one| one.question.as_str()))];
    let opening = all.first().map(|one| one.question.clone()).into_iter().collect();
    let drawings = all.iter().map(drawn).collect();
    Choices { name: "scenes-choices", title: "Scenes, errors against the step", lists, opening, drawings }.made()
}

/// The error of the derivative of a bounce against the step.
pub(super) fn bounce(lines: &[Line]) -> Markup {
    let (x, y) = (Axis::log("step dt, s"), Axis::log("error of ∂(z, ż)/∂(z₀, ż₀)"));
    drawing("scenes-bounce", "Error of the derivative of a bounce against the step", x, y, stepped(lines))
}
