//! Where a guard is crossed within a step: a search on the dense output, and then on the integrator itself.
//!
//! The search looks at φ = ±g on cells of the step, with its rate. Let φ > 0 mean *before the event*. Then each cell is one of
//!
//! | φ at its ends | rates at its ends | there is |
//! |---|---|---|
//! | + − | any | a crossing |
//! | + + | − + | a minimum: two crossings, grazing, or nothing |
//! | − − | + − | a maximum: a crossing behind it, grazing, or nothing |
//!
//! A guard may vary faster than the state, by the time or by its own text. So a step is accepted only if each guard along it is a
//! polynomial of degree 5 too, to 10⁻⁴ of its largest value on the step. What is finer than that is not looked for.
//!
//! A root is bracketed on the dense output by bisection. Its time is then that of Newton's method on steps of the integrator, which is kept
//! in the bracket.

use crate::dense::Dense;
use crate::error::HybridError;
use crate::extrapolation::Extrapolation;
use crate::settings::Settings;
use crate::system::{Bound, Hybrid};
use featherbench_spatial::{Real, largest};

/// The cells of a step: a guard that turns more often than once in an eighth of a step escapes; the dense output, of degree 5, turns four
/// times in all.
const CELLS: usize = 8;
/// Halvings of a cell: to the last digit of s.
const HALVINGS: usize = 52;
/// How far a crossing may lie from that on the dense output, as a fraction of the step.
pub(crate) const SLACK: f64 = 1e-3;

/// How far a guard on a step may be from its polynomial, relative to its largest value there.
const RESOLUTION: f64 = 1e-4;
/// Where that is looked at: not at equal distances, so that no oscillation is met at its zeros alone.
const LOOKS: [f64; 4] = [0.13, 0.31, 0.72, 0.89];

/// How far a guard along the dense output is from a polynomial. The polynomial goes through the guard's values and rates at the beginning,
/// the middle and the end. A distance up to 1 is allowed, and NaN is not.
pub(crate) fn unresolved<S: Hybrid, T: Real>(bound: &Bound<S, T>, guard: usize, dense: &Dense<T>, settings: &Settings) -> f64 {
    let at = |s: f64| {
        let (t, x, rate) = dense.at(s);
        bound.guard(guard, t, &x, &rate)
    };
    let nodes = [at(0.0), at(0.5), at(1.0)].map(|(value, rate)| ([value], [rate]));
    let polynomial = Dense::new(dense.start, dense.length, [0, 1, 2].map(|k| (&nodes[k].0[..], &nodes[k].1[..])));
    let mut size = largest(nodes.iter().map(|(value, _)| value[0].min_lane()));
    let mut deviation = 0.0_f64;
    for s in LOOKS {
        let value = at(s).0;
        let off = (value - polynomial.at(s).1[0]).min_lane().abs();
        size = largest([size, value.min_lane()]);
        deviation = if off > deviation || off.is_nan() { off } else { deviation };
    }
    deviation / (RESOLUTION * size + settings.grazing_value)
}

/// What is in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Found {
    /// A crossing between two fractions of the step.
    Crossing { low: f64, high: f64 },
    /// An extremum that touches zero, at a fraction of the step.
    Touch { at: f64 },
}

impl Found {
    /// About where in the step.
    pub(crate) fn at(self) -> f64 {
        match self {
            Self::Crossing { low, high } => f64::midpoint(low, high),
            Self::Touch { at } => at,
        }
    }
}

/// What is known of φ at the beginning of a step, where rounding may give it either sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Begin {
    /// Its sign is right.
    Plain,
    /// It is zero, and grows.
    Leaving,
    /// It is zero after its own event, and goes on to be negative.
    Passed,
}

/// The first crossing or touch of a guard in a step. `sign` makes g positive before the event.
pub(crate) fn search<S: Hybrid, T: Real>(
    bound: &Bound<S, T>,
    guard: usize,
    sign: f64,
    begin: Begin,
    dense: &Dense<T>,
    settings: &Settings,
) -> Option<Found> {
    let phi = |s: f64| {
        let (t, x, rate) = dense.at(s);
        let (value, slope) = bound.guard(guard, t, &x, &rate);
        (sign * value.min_lane(), sign * slope.min_lane())
    };
    let mut before = phi(0.0);
    if begin == Begin::Passed {
        before.0 = 0.0;
    }
    let mut low = 0.0;
    for cell in 1..=CELLS {
        let high = cell as f64 / CELLS as f64;
        let after = phi(high);
        let starts = cell == 1 && begin == Begin::Leaving;
        if before.0 > 0.0 || starts {
            let turns_up = before.1 < 0.0 && after.1 > 0.0 && !starts;
            if after.0 <= 0.0 {
                if !starts {
                    return Some(halve(|s| phi(s).0, low, high));
                }
                // It left zero, and came back in the same cell: the crossing is behind its maximum.
                let top = extremum(|s| phi(s).1, low, high);
                return Some(if phi(top).0 > 0.0 { halve(|s| phi(s).0, top, high) } else { Found::Touch { at: low } });
            }
            if turns_up {
                let bottom = extremum(|s| -phi(s).1, low, high);
                let depth = phi(bottom).0;
                if depth.abs() <= settings.grazing_value {
                    return Some(Found::Touch { at: bottom });
                }
                if depth < 0.0 {
                    return Some(halve(|s| phi(s).0, low, bottom));
                }
            }
        } else if after.0 <= 0.0 && before.1 > 0.0 && after.1 < 0.0 {
            let top = extremum(|s| phi(s).1, low, high);
            let height = phi(top).0;
            if height.abs() <= settings.grazing_value {
                return Some(Found::Touch { at: top });
            }
            if height > 0.0 {
                return Some(halve(|s| phi(s).0, top, high));
            }
        }
        (before, low) = (after, high);
    }
    None
}

/// Where a rate that is positive at `low` and negative at `high` is zero.
fn extremum(rate: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if rate(middle) > 0.0 { low = middle } else { high = middle }
    }
    f64::midpoint(low, high)
}

/// The crossing between `low`, where φ > 0, and `high`, where φ ≤ 0.
fn halve(phi: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> Found {
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if phi(middle) > 0.0 { low = middle } else { high = middle }
    }
    Found::Crossing { low, high }
}

/// A point of the flow at which a guard is met.
pub(crate) struct Located<T> {
    /// The time after the beginning of the step.
    pub(crate) length: T,
    pub(crate) state: Vec<T>,
    /// g and ġ there.
    pub(crate) value: f64,
    pub(crate) rate: f64,
    /// The last correction before the final one.
    pub(crate) correction: f64,
}

/// A step of the integrator that can be cut.
pub(crate) struct Cut<'a, S, T> {
    pub(crate) bound: &'a Bound<'a, S, T>,
    pub(crate) method: &'a Extrapolation<T>,
    pub(crate) time: T,
    pub(crate) length: T,
    pub(crate) state: &'a [T],
    pub(crate) first: &'a [T],
}

impl<S: Hybrid, T: Real> Cut<'_, S, T> {
    /// The state after a part of the step, with g and ġ.
    fn after(&self, guard: usize, length: T) -> (Vec<T>, T, T) {
        let field = |t: T, x: &[T], rate: &mut [T]| self.bound.flow(t, x, rate);
        let state = self.method.step(field, self.time, length, self.state, self.first).end;
        let t = self.time + length;
        let (value, rate) = self.bound.guard(guard, t, &state, &self.bound.rate(t, &state));
        (state, value, rate)
    }

    /// The point of a touch: where the dense output has its extremum. An error of δ there changes g by g̈δ²/2 only.
    pub(crate) fn touch(&self, guard: usize, at: f64) -> Located<T> {
        let length = self.length * T::from_f64(at);
        let (state, value, rate) = self.after(guard, length);
        Located { length, state, value: value.min_lane(), rate: rate.min_lane(), correction: 0.0 }
    }

    /// The point of a crossing, by Newton's method on steps of the integrator.
    ///
    /// # Errors
    /// If 60 corrections lead neither below the tolerance of time nor to the rounding of g: either Newton's method converges in a few, or
    /// halving the bracket does.
    pub(crate) fn locate(&self, guard: usize, sign: f64, found: Found, settings: &Settings) -> Result<Located<T>, HybridError> {
        let part = |s: f64| self.length * T::from_f64(s);
        // The dense output errs: the bracket of the true crossing is wider than its own.
        let at = found.at();
        let (mut low, mut high) = (part((at - SLACK).max(0.0)), part(at + SLACK));
        let mut length = part(at);
        let mut change = f64::INFINITY;
        for _ in 0..60 {
            let (state, value, rate) = self.after(guard, length);
            let correction = -(value / rate);
            change = correction.min_lane().abs();
            let time = self.time + length;
            let reached = change <= settings.time || change * rate.min_lane().abs() <= self.bound.noise(guard, time, &state);
            if reached {
                let length = length + correction;
                let (state, value, rate) = self.after(guard, length);
                return Ok(Located { length, state, value: value.min_lane(), rate: rate.min_lane(), correction: change });
            }
            if sign * value.min_lane() > 0.0 {
                low = length
            } else {
                high = length
            }
            let next = length + correction;
            let inside = (next - low).min_lane() >= 0.0 && (high - next).min_lane() >= 0.0;
            length = if inside { next } else { (low + high) * T::from_f64(0.5) };
        }
        let time = (self.time + length).min_lane();
        Err(HybridError::NotLocated { mode: self.bound.mode, guard, time, tolerance: settings.time, change })
    }
}
