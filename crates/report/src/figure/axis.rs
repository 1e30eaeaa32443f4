//! Axes: ranges, places and ticks.

use super::at;
use crate::numbers::{larger, smaller};

/// An axis of a plot.
#[derive(Clone, Debug)]
pub struct Axis {
    /// What it shows, with its unit.
    pub title: String,
    /// Whether it is logarithmic; otherwise it is linear.
    pub log: bool,
}

impl Axis {
    /// A logarithmic axis.
    pub fn log(title: impl Into<String>) -> Self {
        Self { title: title.into(), log: true }
    }

    /// A linear one.
    pub fn linear(title: impl Into<String>) -> Self {
        Self { title: title.into(), log: false }
    }

    /// Whether a value has a place on it.
    pub(super) fn fits(&self, value: f64) -> bool {
        value.is_finite() && (!self.log || value > 0.0)
    }
}

/// An axis with its range, from one place on the paper to another.
pub(super) struct Scale {
    log: bool,
    range: [f64; 2],
    paper: [f64; 2],
}

impl Scale {
    /// Spans the values; `None` if none has a place.
    pub(super) fn of(axis: &Axis, values: impl Iterator<Item = f64>, paper: [f64; 2]) -> Option<Self> {
        let inner = values.filter(|&value| axis.fits(value)).map(|value| if axis.log { value.log10() } else { value });
        let (low, high) = inner.fold(None, |range: Option<(f64, f64)>, value| {
            let (low, high) = range.unwrap_or((value, value));
            Some((smaller(low, value), larger(high, value)))
        })?;
        // A single value gets room on both sides, others some air.
        let air = if high - low > 1e-9 * larger(low.abs(), high.abs()) { 0.04 * (high - low) } else { 0.5 };
        Some(Self { log: axis.log, range: [low - air, high + air], paper })
    }

    /// The place of a value.
    pub(super) fn place(&self, value: f64) -> f64 {
        let ([low, high], [from, to]) = (self.range, self.paper);
        let inner = if self.log { value.log10() } else { value };
        from + (inner - low) / (high - low) * (to - from)
    }

    /// Ticks with their labels; an empty label is a tick between.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.range;
        if !self.log {
            let step = nice((high - low) / 6.0);
            let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
            let decimals = larger(0.0, -step.log10().floor()) as usize;
            return (first..=last).map(|k| k as f64 * step).map(|value| (value, format!("{value:.decimals$}"))).collect();
        }
        let (first, last) = (low.floor() as i32, high.ceil() as i32);
        let decades = high - low;
        // At most eight labels; between them the other decades, or within a few decades 2 to 9.
        let every = (decades / 8.0).ceil() as i32;
        let mut ticks = Vec::new();
        for decade in first..=last {
            let digits = if decades <= 4.0 { 9 } else { 1 };
            for digit in 1..=digits {
                let value = f64::from(digit) * 10.0_f64.powi(decade);
                let labelled = if digit == 1 { decade.rem_euclid(every.max(1)) == 0 } else { decades < 1.5 && [2, 5].contains(&digit) };
                if (low..=high).contains(&value.log10()) {
                    ticks.push((value, if labelled { power(digit, decade) } else { String::new() }));
                }
            }
        }
        ticks
    }
}

/// 1, 2 or 5 times a power of ten, not below the least.
fn nice(least: f64) -> f64 {
    let ten = 10.0_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|digit| digit * ten).find(|&step| step >= least).unwrap_or(10.0 * ten)
}

/// `200`, `0.05` or `10⁻¹⁴`.
fn power(digit: i32, decade: i32) -> String {
    if (-2..=3).contains(&decade) {
        return at_most_two(f64::from(digit) * 10.0_f64.powi(decade));
    }
    let raised = |c: char| match c {
        '-' => '⁻',
        c => c.to_digit(10).and_then(|digit| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit as usize)).unwrap_or(c),
    };
    let exponent: String = decade.to_string().chars().map(raised).collect();
    if digit == 1 { format!("10{exponent}") } else { format!("{digit}·10{exponent}") }
}

fn at_most_two(value: f64) -> String {
    if value < 0.1 { format!("{value:.2}") } else { at(value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |axis: Axis, values: &[f64]| -> Vec<String> {
            let ticks = Scale::of(&axis, values.iter().copied(), [0.0, 100.0]).unwrap().ticks();
            ticks.into_iter().map(|(_, label)| label).filter(|label| !label.is_empty()).collect()
        };
        assert_eq!(labels(Axis::log("x"), &[1.0, 100.0]), ["1", "10", "100"]);
        assert_eq!(labels(Axis::log("x"), &[1e-16, 1e-4]), ["10⁻¹⁶", "10⁻¹⁴", "10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴"]);
        assert_eq!(labels(Axis::log("x"), &[1.0, 6.0]), ["1", "2", "5"]);
        assert_eq!(labels(Axis::linear("x"), &[0.0, 1.0]), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert!(Scale::of(&Axis::log("x"), [0.0, f64::NAN].into_iter(), [0.0, 1.0]).is_none(), "zero has no logarithm");
    }

    #[test]
    fn places_are_between_the_ends() {
        let scale = Scale::of(&Axis::log("x"), [1.0, 100.0].into_iter(), [0.0, 108.0]).unwrap();
        for (value, place) in [(1.0, 4.0), (10.0, 54.0), (100.0, 104.0)] {
            assert!(
                (scale.place(value) - place).abs() < 1e-9,
                "a range of two decades with 4 % of air at each end: {}",
                scale.place(value)
            );
        }
    }
}
