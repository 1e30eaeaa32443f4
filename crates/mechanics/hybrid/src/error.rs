//! What can go wrong before or during a run. How a run ends without an error is a [`crate::Status`].

use featherbench_spatial::Real;
use thiserror::Error;

/// The errors of hybrid simulation.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum HybridError {
    /// A list of another length.
    #[error("'{what}' has {found} numbers, but the system needs {expected}")]
    Size {
        /// Which list.
        what: &'static str,
        /// The length that the system asks for.
        expected: usize,
        /// The length that was given.
        found: usize,
    },
    /// NaN or infinite where a run begins.
    #[error("'{what}' is {value}; give a finite number")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// The system has no such mode.
    #[error("mode {mode} does not exist: the system has {modes}")]
    Mode {
        /// The mode that was named by the start or by [`crate::Hybrid::target`].
        mode: usize,
        /// How many there are.
        modes: usize,
    },
    /// The end of the run lies before its beginning.
    #[error("the run is to end at t = {to:e}, before it begins at t = {from:e}")]
    Backward {
        /// The beginning.
        from: f64,
        /// The end.
        to: f64,
    },
    /// A setting out of its range.
    #[error("the setting '{field}' is {value}; it is {range}")]
    Setting {
        /// Its name.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// A parameter of a case out of its range.
    #[error("the parameter '{name}' is {value}; it is {range}")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// The tolerance asks for a step that time cannot resolve.
    #[error(
        "at t = {time:e} the tolerance asks for a step of {step:e}, which is too small; the flow or a guard is not smooth there, or not \
         finite"
    )]
    StepTooSmall {
        /// When it happened.
        time: f64,
        /// The step.
        step: f64,
    },
    /// A reset, guard or flow gave NaN or infinity.
    #[error("'{what}' is not finite at t = {time:e}")]
    Overflow {
        /// Which function.
        what: &'static str,
        /// When.
        time: f64,
    },
    /// The root search of a guard did not end.
    #[error(
        "guard {guard} of mode {mode} is crossed near t = {time:e}, but its time is not found to {tolerance:e}: the last change is \
         {change:e}; a guard that jumps has no such time"
    )]
    NotLocated {
        /// The mode.
        mode: usize,
        /// The guard.
        guard: usize,
        /// Where the search ended.
        time: f64,
        /// The tolerance of time.
        tolerance: f64,
        /// The last change of the event time.
        change: f64,
    },
    /// A saltation matrix does not exist: ġ = 0.
    #[error("guard {guard} of mode {mode} is met at t = {time:e} with the rate {rate:e}: the event time has no derivative there")]
    Tangent {
        /// The mode.
        mode: usize,
        /// The guard.
        guard: usize,
        /// When.
        time: f64,
        /// ∇g·f₋ + ∂g/∂t.
        rate: f64,
    },
}

/// An error unless the list has the length that the system asks for and holds finite numbers.
pub(crate) fn expect<T: Real>(what: &'static str, numbers: &[T], expected: usize) -> Result<(), HybridError> {
    if numbers.len() != expected {
        return Err(HybridError::Size { what, expected, found: numbers.len() });
    }
    match numbers.iter().map(|number| number.min_lane()).find(|value| !value.is_finite()) {
        Some(value) => Err(HybridError::NotFinite { what, value }),
        None => Ok(()),
    }
}

/// An error unless all numbers are finite.
pub(crate) fn expect_finite<T: Real>(what: &'static str, time: T, numbers: &[T]) -> Result<(), HybridError> {
    let finite = numbers.iter().all(|number| number.min_lane().is_finite());
    if finite { Ok(()) } else { Err(HybridError::Overflow { what, time: time.min_lane() }) }
}
