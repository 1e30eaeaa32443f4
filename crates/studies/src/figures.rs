//! What the studies' figures for papers share: the list of them, and curves of the largest value at each place.

use featherbench_report::figure::{Line, Point, Series, style};
use std::collections::BTreeMap;

/// Every figure that a run can have, and the rows that it needs. A figure without its rows is absent.
pub const FIGURES: [(&str, &str); 11] = [
    ("error-depth-id", "errors of inverse dynamics against the truth (study accuracy)"),
    ("error-depth-fd", "errors of forward dynamics against the truth (study accuracy)"),
    ("error-size-id", "errors of inverse dynamics against the truth (study accuracy)"),
    ("error-size-fd", "errors of forward dynamics against the truth (study accuracy)"),
    ("error-distribution", "errors against the truth (study accuracy)"),
    ("speed-ratios", "ratios of another engine's times to ours that count (study timing, live)"),
    ("time-size", "times of forward dynamics that count, on robots of two sizes (study timing)"),
    ("peak-share", "times of inverse or forward dynamics that count, and a peak of the machine that does (study timing)"),
    ("work-precision", "times and errors of forward dynamics of one robot (studies timing and accuracy)"),
    ("memory-size", "memory of two sizes of one family (study growth)"),
    ("speed-profile", "times of two engines on one robot that count and are no estimates (study timing, live)"),
];

/// A value of an engine on a robot.
pub(crate) struct Measured<'a> {
    pub robot: &'a str,
    pub x: f64,
    pub y: f64,
}

/// The series of an engine with the largest value at each place: a curve has one point there, and nothing larger is hidden.
pub(crate) fn largest(engine: &str, name: String, values: &[Measured]) -> Series {
    let mut places: BTreeMap<u64, &Measured> = BTreeMap::new();
    for value in values {
        // Positive numbers are in the order of their bits.
        let known = places.entry(value.x.to_bits()).or_insert(value);
        if value.y > known.y {
            *known = value;
        }
    }
    let points = places.into_values().map(|value| Point { name: value.robot.to_owned(), x: value.x, y: value.y }).collect();
    Series { name, style: style(engine), line: Line::Straight, points }
}

/// The share of values up to each value, as steps.
pub(crate) fn shares(engine: &str, name: String, mut values: Vec<(f64, String)>, all: usize) -> Series {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let share = |(index, (x, name)): (usize, (f64, String))| Point { name, x, y: (index + 1) as f64 / all as f64 };
    Series { name, style: style(engine), line: Line::Stairs, points: values.into_iter().enumerate().map(share).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

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
