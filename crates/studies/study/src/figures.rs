//! What the studies' figures share: curves of the largest value at each place, and words of drawings on the page.

use featherbench_report::figure::{Axis, Line, Plot, Point, Series, Style, style};
use featherbench_report::fit::Fit;
use featherbench_report::numbers::larger;
use maud::Markup;
use std::collections::BTreeMap;

/// What stands on the lower edge of an axis of errors, for all that is smaller: far below the spacing of doubles at one.
pub const ZERO: f64 = 1e-18;

/// A logarithmic axis of errors, which may be zero.
pub fn errors(title: impl Into<String>) -> Axis {
    Axis::log(title).down_to(ZERO)
}

/// The parts of a name that are not empty.
pub fn joined(parts: &[&str]) -> String {
    parts.iter().copied().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" · ")
}

/// A name with the exponent of a fit.
pub fn with_exponent(name: String, slope: Option<f64>, digits: usize) -> String {
    match slope {
        Some(slope) => format!("{name}, p = {slope:.digits$}").replace("= -", "= −"),
        None => name,
    }
}

/// A number as a mark tells it: four digits.
pub fn told(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".into()
    } else if !(1e-3..1e6).contains(&size) {
        format!("{value:.2e}")
    } else {
        let decimals = larger(0.0, 3.0 - size.log10().floor()) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    }
}

/// The point of a power law at a size.
pub fn fitted(fit: Fit, size: f64) -> [f64; 2] {
    [size, 10.0_f64.powf(fit.intercept + fit.slope * size.log10())]
}

/// A point with lines that the page tells below its name.
pub fn point(name: &str, x: f64, y: f64, about: impl IntoIterator<Item = String>) -> Point {
    Point { about: about.into_iter().filter(|line| !line.is_empty()).collect(), ..Point::new(name, x, y) }
}

/// A series of a list whose members are no engines.
pub fn nth(index: usize, name: impl Into<String>, points: Vec<Point>) -> Series {
    Series::new(name, Style::nth(index), points)
}

/// The same without a line.
pub fn scattered(index: usize, name: impl Into<String>, points: Vec<Point>) -> Series {
    Series { line: Line::Marks, ..nth(index, name, points) }
}

/// A drawing of the page.
pub fn drawing(name: &str, title: &str, x: Axis, y: Axis, series: Vec<Series>) -> Markup {
    Plot::new(title, x, y, series).drawing(name, "no values to draw")
}

/// A value of an engine on a robot.
pub struct Measured<'a> {
    /// The robot's name.
    pub robot: &'a str,
    /// Where it stands.
    pub x: f64,
    /// The value.
    pub y: f64,
}

/// The series of an engine with the largest value at each place: a curve has one point there, and nothing larger is hidden.
pub fn largest(engine: &str, name: String, values: &[Measured]) -> Series {
    let mut places: BTreeMap<u64, &Measured> = BTreeMap::new();
    for value in values {
        // Positive numbers are in the order of their bits.
        let known = places.entry(value.x.to_bits()).or_insert(value);
        if value.y > known.y {
            *known = value;
        }
    }
    let points = places.into_values().map(|value| Point::new(value.robot, value.x, value.y)).collect();
    Series::new(name, style(engine), points)
}

/// The share of values up to each value, as steps.
pub fn shares(engine: &str, name: String, mut values: Vec<(f64, String)>, all: usize) -> Series {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let share = |(index, (x, name)): (usize, (f64, String))| Point::new(name, x, (index + 1) as f64 / all as f64);
    Series { line: Line::Stairs, ..Series::new(name, style(engine), values.into_iter().enumerate().map(share).collect()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_tell_four_digits() {
        assert_eq!(
            [0.0, 1.0, -0.25, 1234.56, 0.12345, 3.2e-14, 1e6].map(told),
            ["0", "1", "-0.25", "1235", "0.1235", "3.20e-14", "1.00e6"]
        );
        assert_eq!(with_exponent(joined(&["drake", "", "aba"]), Some(-0.5), 2), "drake · aba, p = −0.50");
    }

    #[test]
    fn a_curve_has_the_largest_value_at_each_place() {
        let values = [("a", 7.0, 2.0), ("b", 7.0, 5.0), ("c", 3.0, 1.0)].map(|(robot, x, y)| Measured { robot, x, y });
        let points: Vec<(String, f64, f64)> = largest("e", "e".into(), &values).points.into_iter().map(|p| (p.name, p.x, p.y)).collect();
        assert_eq!(points, [("c".to_owned(), 3.0, 1.0), ("b".to_owned(), 7.0, 5.0)]);
    }

    #[test]
    fn shares_count_what_has_no_value_too() {
        let values = vec![(2.0, "a".to_owned()), (1.0, "b".to_owned())];
        let points: Vec<(f64, f64)> = shares("e", "e".into(), values, 4).points.into_iter().map(|p| (p.x, p.y)).collect();
        assert_eq!(points, [(1.0, 0.25), (2.0, 0.5)], "two of four have no value: the curve ends at a half");
    }
}
