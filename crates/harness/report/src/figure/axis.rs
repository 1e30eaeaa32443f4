//! Axes: ranges, places and ticks.

use super::paper::at;
use crate::numbers::{larger, smaller};

/// What an axis has at its places.
#[derive(Clone, Debug, Default)]
enum Places {
    /// Round numbers.
    #[default]
    Round,
    /// Its own numbers.
    Own(Vec<f64>),
    /// Names, at 0, 1, 2 and so on.
    Names(Vec<String>),
}

/// An axis of a plot.
///
/// ```
/// use featherbench_report::figure::Axis;
///
/// let error = Axis::log("relative error").down_to(1e-18);
/// assert!(error.log && error.title == "relative error");
/// ```
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// What it shows, with its unit.
    pub title: String,
    /// Whether it is logarithmic; otherwise it is linear.
    pub log: bool,
    /// What stands for all below it, zero included.
    least: Option<f64>,
    places: Places,
    /// The range that it has, whatever the values are.
    range: Option<[f64; 2]>,
}

impl Axis {
    /// A logarithmic axis.
    pub fn log(title: impl Into<String>) -> Self {
        Self { title: title.into(), log: true, ..Self::default() }
    }

    /// A linear one.
    pub fn linear(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// One with names instead of numbers: the first at 0, the next at 1.
    pub fn named(title: impl Into<String>, names: Vec<String>) -> Self {
        let range = Some([-0.6, names.len() as f64 - 0.4]);
        Self { title: title.into(), places: Places::Names(names), range, ..Self::default() }
    }

    /// The axis with a lower edge: what is smaller, zero included, stands there with a hollow mark.
    pub fn down_to(self, least: f64) -> Self {
        Self { least: Some(least), ..self }
    }

    /// The axis with ticks at these numbers.
    pub fn at(self, mut numbers: Vec<f64>) -> Self {
        numbers.sort_by(f64::total_cmp);
        numbers.dedup();
        Self { places: Places::Own(numbers), ..self }
    }

    /// The names along it, if it has names.
    pub(super) fn names(&self) -> Option<&[String]> {
        match &self.places {
            Places::Names(names) => Some(names),
            Places::Round | Places::Own(_) => None,
        }
    }

    /// Whether a value has a place on it.
    pub(super) fn fits(&self, value: f64) -> bool {
        value.is_finite() && (!self.log || value > 0.0 || (self.least.is_some() && value == 0.0))
    }

    /// Whether a value stands on the lower edge.
    pub(super) fn is_below(&self, value: f64) -> bool {
        self.least.is_some_and(|least| value < least)
    }

    /// Whether a tick is at the lower edge, up to rounding.
    pub(super) fn is_least(&self, value: f64) -> bool {
        self.least.is_some_and(|least| (value / least - 1.0).abs() < 0.01)
    }

    /// A value as it is placed: its logarithm, or itself.
    fn inner(&self, value: f64) -> f64 {
        let value = self.least.map_or(value, |least| larger(value, least));
        if self.log { value.log10() } else { value }
    }
}

/// A tick of an axis.
pub(super) struct Tick {
    /// Its number.
    pub(super) value: f64,
    /// Its label; a tick between others has none.
    pub(super) label: String,
}

impl Tick {
    fn of(value: f64) -> Self {
        Self { value, label: number(value) }
    }

    /// The number as a label, for a tick between others.
    pub(super) fn full(&self) -> String {
        number(self.value)
    }
}

/// An axis with its range, from one place on the paper to another.
pub(super) struct Scale {
    axis: Axis,
    range: [f64; 2],
    paper: [f64; 2],
}

impl Scale {
    /// Spans the values; `None` if none has a place.
    pub(super) fn of(axis: &Axis, values: impl Iterator<Item = f64>, paper: [f64; 2]) -> Option<Self> {
        if let Some(range) = axis.range {
            return Some(Self { axis: axis.clone(), range, paper });
        }
        let inner = values.filter(|&value| axis.fits(value)).map(|value| axis.inner(value));
        let (low, high) = inner.fold(None, |range: Option<(f64, f64)>, value| {
            let (low, high) = range.unwrap_or((value, value));
            Some((smaller(low, value), larger(high, value)))
        })?;
        // One value alone gets room on both sides, others some air.
        let air = if high - low > 1e-9 * larger(low.abs(), high.abs()) { 0.04 * (high - low) } else { 0.5 };
        Some(Self { axis: axis.clone(), range: [low - air, high + air], paper })
    }

    /// The place of a value.
    pub(super) fn place(&self, value: f64) -> f64 {
        let ([low, high], [from, to]) = (self.range, self.paper);
        from + (self.axis.inner(value) - low) / (high - low) * (to - from)
    }

    /// Its ticks, from the lower end.
    pub(super) fn ticks(&self) -> Vec<Tick> {
        let [low, high] = self.range;
        match &self.axis.places {
            Places::Names(names) => {
                return names.iter().enumerate().map(|(place, name)| Tick { value: place as f64, label: name.clone() }).collect();
            }
            Places::Own(numbers) => return numbers.iter().filter(|&&value| self.axis.fits(value)).map(|&value| Tick::of(value)).collect(),
            Places::Round => {}
        }
        if !self.axis.log {
            let step = nice((high - low) / 6.0);
            let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
            let decimals = larger(0.0, -step.log10().floor()) as usize;
            return (first..=last).map(|k| k as f64 * step).map(|value| Tick { value, label: format!("{value:.decimals$}") }).collect();
        }
        let decades = high - low;
        // Within so little of a decade equal distances of the number say more than its digits.
        if decades < 0.6 {
            let [low, high] = [low, high].map(|end| 10.0_f64.powf(end));
            let step = nice((high - low) / 6.0);
            let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
            return (first..=last).map(|k| Tick::of(k as f64 * step)).collect();
        }
        let (first, last) = (low.floor() as i32, high.ceil() as i32);
        // At most eight labels; between them the other decades, or within a few decades 2 to 9.
        let every = (decades / 8.0).ceil() as i32;
        let mut ticks = Vec::new();
        for decade in first..=last {
            let digits = if decades <= 4.0 { 9 } else { 1 };
            for digit in 1..=digits {
                let value = f64::from(digit) * 10.0_f64.powi(decade);
                let labelled = if digit == 1 { decade.rem_euclid(every.max(1)) == 0 } else { decades < 1.5 && [2, 5].contains(&digit) };
                if (low..=high).contains(&value.log10()) {
                    let edge = self.axis.is_least(value);
                    ticks.push(Tick { value, label: if labelled || edge { power(digit, decade) } else { String::new() } });
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

/// A number as a label: in full, or as a power of ten if it is far from one.
fn number(value: f64) -> String {
    let decade = value.abs().log10();
    if value == 0.0 || (-2.0..5.0).contains(&decade) {
        // Multiples of a distance between ticks have rounding errors.
        return ((value * 1e9).round() / 1e9).to_string();
    }
    let decade = (decade + 1e-9).floor();
    let digits = value / 10.0_f64.powi(decade as i32);
    if (digits - digits.round()).abs() < 1e-6 && digits > 0.0 {
        power(digits.round() as i32, decade as i32)
    } else {
        format!("{}·{}", crate::numbers::short(digits), power(1, decade as i32))
    }
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
            ticks.into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect()
        };
        assert_eq!(labels(Axis::log("x"), &[1.0, 100.0]), ["1", "10", "100"]);
        assert_eq!(labels(Axis::log("x"), &[1e-16, 1e-4]), ["10⁻¹⁶", "10⁻¹⁴", "10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴"]);
        assert_eq!(labels(Axis::log("x"), &[1.0, 6.0]), ["1", "2", "5"]);
        assert_eq!(labels(Axis::log("x"), &[1.0, 2.9]), ["1", "1.5", "2", "2.5", "3"]);
        assert_eq!(labels(Axis::log("x"), &[1e-15, 2.4e-15]), ["10⁻¹⁵", "1.5·10⁻¹⁵", "2·10⁻¹⁵"]);
        assert_eq!(labels(Axis::linear("x"), &[0.0, 1.0]), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(Axis::log("x").at(vec![1e6, 10.0, 10.0, 250.0]), &[10.0, 1e6]), ["10", "250", "10⁶"]);
        assert_eq!(labels(Axis::named("x", vec!["a".into(), "b".into()]), &[]), ["a", "b"]);
        assert_eq!(labels(Axis::log("x").down_to(1e-18), &[0.0, 1e-17]), ["10⁻¹⁸", "2·10⁻¹⁸", "5·10⁻¹⁸", "10⁻¹⁷"]);
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
