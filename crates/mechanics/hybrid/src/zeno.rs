//! Infinitely many events in finite time: the geometric tail is recognised and extrapolated.
//!
//! Let tₖ be the times of the events of one guard in one mode. If the ratios rₖ = (tₖ − tₖ₋₁)/(tₖ₋₁ − tₖ₋₂) are equal and below 1, the
//! times converge, and Aitken's formula gives the limit:
//!
//! ```text
//! t∞ = tₖ + (tₖ − tₖ₋₁) r/(1 − r)
//! ```
//!
//! The error that is stated is the largest change of the last estimates, plus what errors of 16ε|tₖ| in each of three times can do to one:
//! 64ε|tₖ|/(1 − r)². It is an estimate: a sequence may change its law after it was looked at.
//! States are extrapolated by the same formula, each with its own ratio; theirs may differ by the root of the spread.
//!
//! Source: A. C. Aitken, *On Bernoulli's numerical solution of algebraic equations* (1926).

use crate::run::{Event, Limit, Tail};
use crate::settings::Zeno;
use crate::system::rounding;
use featherbench_spatial::{Real, largest};

/// The tail of the kind of the last event, if it is recognised.
pub(crate) fn recognise<T: Real>(settings: &Zeno, events: &[Event<T>]) -> Option<Tail<T>> {
    let last = events.last()?;
    let kind: Vec<&Event<T>> = events.iter().filter(|event| event.mode == last.mode && event.guard == last.guard).collect();
    if kind.len() <= settings.intervals {
        return None;
    }
    let tail = &kind[kind.len() - settings.intervals - 1..];
    let times: Vec<T> = tail.iter().map(|event| event.time).collect();
    let ratios: Vec<f64> = times.windows(3).map(|t| ratio(t).min_lane()).collect();
    let first = ratios[0];
    let (low, high) = ratios.iter().fold((first, first), |(a, b), &x| (if x < a { x } else { a }, if x > b { x } else { b }));
    // NaN, from two events at one instant, is no tail.
    let geometric = low > 0.0 && high <= settings.ratio && high - low <= settings.spread;
    if !geometric || ratios.iter().any(|ratio| ratio.is_nan()) {
        return None;
    }
    let state = (0..last.after.len()).map(|k| limit(&tail.iter().map(|event| event.after[k]).collect::<Vec<_>>(), settings)).collect();
    let ratio = ratios[ratios.len() - 1];
    Some(Tail { mode: last.mode, guard: last.guard, time: aitken(&times, ratio), ratio, state, computed: kind.len() })
}

/// The limit of a sequence; `None` if it has no geometric tail.
fn limit<T: Real>(values: &[T], settings: &Zeno) -> Option<Limit<T>> {
    let magnitude = largest(values.iter().map(|value| value.min_lane()));
    // It does not move any more, or it only keeps the rounding of numbers near one.
    let noise = 64.0 * rounding::<T>() * magnitude.max(1.0);
    let moves: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).min_lane().abs()).collect();
    if moves[moves.len() - 1] <= noise {
        return Some(Limit { value: values[values.len() - 1], error: 2.0 * noise });
    }
    let ratios: Vec<f64> = values.windows(3).map(|three| ratio(three).min_lane()).collect();
    let last = ratios[ratios.len() - 1];
    // The spread of ratios of states, and what the noise does to each.
    let steady = |(ratio, before): (&f64, &f64)| (ratio - last).abs() <= settings.spread.sqrt() + noise / before;
    let geometric = ratios.iter().zip(&moves).all(steady) && last.abs() <= settings.ratio;
    geometric.then(|| aitken(values, last))
}

/// (x₂ − x₁)/(x₁ − x₀).
fn ratio<T: Real>(values: &[T]) -> T {
    (values[2] - values[1]) / (values[1] - values[0])
}

/// The estimate from the last three, with the changes of all estimates as its error.
fn aitken<T: Real>(values: &[T], last: f64) -> Limit<T> {
    let estimate = |three: &[T]| {
        let r = ratio(three);
        three[2] + (three[2] - three[1]) * r / (T::one() - r)
    };
    let estimates: Vec<T> = values.windows(3).map(estimate).collect();
    let value = estimates[estimates.len() - 1];
    let change = largest(estimates.iter().map(|other| (*other - value).min_lane()));
    let rounding = 64.0 * rounding::<T>() * values[values.len() - 1].min_lane().abs() / (1.0 - last).powi(2);
    Limit { value, error: change + rounding }
}
