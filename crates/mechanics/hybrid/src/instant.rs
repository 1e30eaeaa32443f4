//! What happens at one instant: which guards are met, and chains of their resets in two orders.
//!
//! A guard is *met* if the flow would be past it within the tolerance of time, |g| ≤ |ġ| δt, or rounding, and g moves in the guard's
//! direction. A guard for both directions is met by crossings only. A guard is not met again right after its own event in the same mode:
//! where its reset does not turn g back, the flow passes.

use crate::error::{HybridError, expect_finite};
use crate::run::{Event, Settled, Simultaneous};
use crate::settings::Settings;
use crate::system::{Bound, Direction, Hybrid, expect_mode};
use featherbench_spatial::{Real, largest};

/// A moment of a run.
#[derive(Clone)]
pub(crate) struct Moment<T> {
    pub(crate) mode: usize,
    pub(crate) time: T,
    pub(crate) state: Vec<T>,
}

/// g and ġ of a guard as plain numbers.
pub(crate) fn value_and_rate<S: Hybrid, T: Real>(bound: &Bound<S, T>, guard: usize, now: &Moment<T>) -> (f64, f64) {
    let (value, rate) = bound.guard(guard, now.time, &now.state, &bound.rate(now.time, &now.state));
    (value.min_lane(), rate.min_lane())
}

/// The guards that are met. `last` are the mode and the guard of the last event of this instant.
pub(crate) fn met<S: Hybrid, T: Real>(
    system: &S,
    theta: &[T],
    now: &Moment<T>,
    last: Option<(usize, usize)>,
    settings: &Settings,
) -> Vec<usize> {
    let bound = Bound { system, theta, mode: now.mode };
    let is_met = |guard: &usize| {
        let (value, rate) = value_and_rate(&bound, *guard, now);
        let closing = match system.direction(now.mode, *guard) {
            Direction::Falling => rate < -settings.grazing_rate,
            Direction::Rising => rate > settings.grazing_rate,
            Direction::Either => false,
        };
        let noise = bound.noise(*guard, now.time, &now.state);
        closing && value.abs() <= rate.abs() * settings.time + noise && last != Some((now.mode, *guard))
    };
    (0..system.guards(now.mode)).filter(is_met).collect()
}

/// Applies the reset of a guard.
///
/// # Errors
/// If the reset is not finite, or leads to a mode that does not exist.
pub(crate) fn fire<S: Hybrid, T: Real>(
    system: &S,
    theta: &[T],
    now: &mut Moment<T>,
    guard: usize,
    correction: f64,
) -> Result<Event<T>, HybridError> {
    let bound = Bound { system, theta, mode: now.mode };
    let (_, rate) = value_and_rate(&bound, guard, now);
    let after = bound.reset(guard, now.time, &now.state);
    expect_finite("reset", now.time, &after)?;
    let (mode, target) = (now.mode, bound.target(guard, now.time, &after));
    expect_mode(system, target)?;
    now.mode = target;
    let before = std::mem::replace(&mut now.state, after.clone());
    Ok(Event { time: now.time, correction, mode, guard, target, before, after, rate })
}

/// Which of the guards that are met comes first.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    Ascending,
    Descending,
}

/// Both orders of the guards that are met at one time.
///
/// # Errors
/// As [`fire`].
pub(crate) fn both_orders<S: Hybrid, T: Real>(
    system: &S,
    theta: &[T],
    now: &Moment<T>,
    guards: Vec<usize>,
    settings: &Settings,
) -> Result<Simultaneous<T>, HybridError> {
    let run = |order| settle(system, theta, now.clone(), &guards, order, settings);
    let (ascending, descending) = (run(Order::Ascending)?, run(Order::Descending)?);
    let same = ascending.mode == descending.mode && ascending.complete && descending.complete;
    let difference = |(a, b): (&T, &T)| (*a - *b).min_lane().abs() / (1.0 + a.min_lane().abs());
    let differences = ascending.state.iter().zip(&descending.state).map(difference);
    let disagreement = if same { largest(differences) } else { f64::INFINITY };
    Ok(Simultaneous { time: now.time, mode: now.mode, guards, ascending, descending, disagreement })
}

/// Fires one guard after another until none is met.
fn settle<S: Hybrid, T: Real>(
    system: &S,
    theta: &[T],
    mut now: Moment<T>,
    guards: &[usize],
    order: Order,
    settings: &Settings,
) -> Result<Settled<T>, HybridError> {
    let mut waiting = guards.to_vec();
    let mut fired = Vec::new();
    while fired.len() < settings.chain {
        let next = if order == Order::Ascending { waiting.first() } else { waiting.last() };
        let Some(next) = next.copied() else {
            return Ok(Settled { guards: fired, mode: now.mode, state: now.state, complete: true });
        };
        let last = Some((now.mode, next));
        fire(system, theta, &mut now, next, 0.0)?;
        fired.push(next);
        waiting = met(system, theta, &now, last, settings);
    }
    Ok(Settled { guards: fired, mode: now.mode, state: now.state, complete: waiting.is_empty() })
}
