//! What a run gives: how it ended, its events, and every step and event in order.

use crate::error::HybridError;
use crate::system::{Hybrid, expect_mode};

/// Where a run begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Start<T> {
    /// The mode.
    pub mode: usize,
    /// t.
    pub time: T,
    /// x.
    pub state: Vec<T>,
}

/// One event: a guard was met, and its reset was applied.
#[derive(Clone, Debug, PartialEq)]
pub struct Event<T> {
    /// t*.
    pub time: T,
    /// The last Newton correction of t* that was seen; one more followed. Above [`crate::Settings::time`] only where the rounding of g
    /// hides more. Zero for an event at the instant of another.
    pub correction: f64,
    /// The mode before.
    pub mode: usize,
    /// The guard.
    pub guard: usize,
    /// The mode after.
    pub target: usize,
    /// x⁻.
    pub before: Vec<T>,
    /// x⁺.
    pub after: Vec<T>,
    /// ġ = ∇g·f₋ + ∂g/∂t.
    pub rate: f64,
}

/// An accepted step of the integrator.
#[derive(Clone, Debug, PartialEq)]
pub struct Step<T> {
    /// Its mode.
    pub mode: usize,
    /// t at its beginning.
    pub time: T,
    /// Its length.
    pub length: T,
    /// x at its beginning.
    pub state: Vec<T>,
}

/// What happened, in order.
#[derive(Clone, Debug, PartialEq)]
pub enum Record<T> {
    /// A step.
    Step(Step<T>),
    /// The event with this index.
    Event(usize),
}

/// Guards that were met at one time, and what follows from the two orders of their resets.
#[derive(Clone, Debug, PartialEq)]
pub struct Simultaneous<T> {
    /// When.
    pub time: T,
    /// The mode.
    pub mode: usize,
    /// The guards.
    pub guards: Vec<usize>,
    /// The guard with the lowest index first, and so on until no guard is met.
    pub ascending: Settled<T>,
    /// The guard with the highest index first, and so on.
    pub descending: Settled<T>,
    /// The largest difference of a state, absolute or relative to 1 + |x|; infinite if the modes differ or one order does not end.
    pub disagreement: f64,
}

/// The end of a chain of events at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled<T> {
    /// The guards, in order, each in the mode of its moment.
    pub guards: Vec<usize>,
    /// The mode after.
    pub mode: usize,
    /// The state after.
    pub state: Vec<T>,
    /// False if the cap of the chain was reached.
    pub complete: bool,
}

/// Which cap was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cap {
    /// Steps.
    Steps,
    /// Events.
    Events,
    /// Events at one instant.
    Chain,
}

/// A limit that was extrapolated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit<T> {
    /// The limit.
    pub value: T,
    /// Its estimated error.
    pub error: f64,
}

/// The tail of a run with infinitely many events.
#[derive(Clone, Debug, PartialEq)]
pub struct Tail<T> {
    /// The mode before the events.
    pub mode: usize,
    /// Their guard.
    pub guard: usize,
    /// t∞.
    pub time: Limit<T>,
    /// The ratio of the last two intervals.
    pub ratio: f64,
    /// x∞, of the states after the resets; `None` of a state without a geometric tail.
    pub state: Vec<Option<Limit<T>>>,
    /// How many of the events were computed.
    pub computed: usize,
}

/// How a run ended. Only [`Status::Finished`] reached the time that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Status<T> {
    /// At the time that was asked for.
    Finished,
    /// Infinitely many events in finite time were recognised; the tail is extrapolated.
    Zeno(Tail<T>),
    /// A guard was touched with ġ = 0, within the tolerances: no event time depends smoothly on the state here.
    Grazing {
        /// The mode.
        mode: usize,
        /// The guard.
        guard: usize,
        /// g there.
        value: f64,
        /// ġ there.
        rate: f64,
    },
    /// Several guards were met at once, and the end depends on their order: the last entry of [`Run::simultaneous`].
    Ambiguous,
    /// A cap was reached.
    Capped(Cap),
}

impl<T> Status<T> {
    /// One word for a row: `finished`, `zeno`, `grazing`, `ambiguous` or `capped`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Zeno(_) => "zeno",
            Self::Grazing { .. } => "grazing",
            Self::Ambiguous => "ambiguous",
            Self::Capped(_) => "capped",
        }
    }
}

/// A run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run<T> {
    /// How it ended.
    pub status: Status<T>,
    /// Where it ended: the mode.
    pub mode: usize,
    /// The time.
    pub time: T,
    /// The state, after the reset if an event was the last.
    pub state: Vec<T>,
    /// Its events.
    pub events: Vec<Event<T>>,
    /// Instants at which several guards were met.
    pub simultaneous: Vec<Simultaneous<T>>,
    /// Steps and events in order.
    pub records: Vec<Record<T>>,
    /// Steps that were tried and rejected.
    pub rejected: usize,
    /// κ of the integrator.
    pub(crate) columns: usize,
}

impl<T> Run<T> {
    /// An error unless each record has the size and the modes of the system.
    pub(crate) fn expect<S: Hybrid>(&self, system: &S) -> Result<(), HybridError> {
        let states = |what, found: usize| match found == system.states() {
            true => Ok(()),
            false => Err(HybridError::Size { what, expected: system.states(), found }),
        };
        states("state", self.state.len())?;
        for record in &self.records {
            match record {
                Record::Step(step) => {
                    states("state of a step", step.state.len())?;
                    expect_mode(system, step.mode)?;
                }
                Record::Event(index) if *index >= self.events.len() => {
                    return Err(HybridError::Size { what: "events", expected: index + 1, found: self.events.len() });
                }
                // The size and the modes of an event are looked at by its saltation.
                Record::Event(_) => {}
            }
        }
        Ok(())
    }
}
