//! What can go wrong in an integration.

use crate::{DimensionError, Error};
use featherbench_spatial::Real;
use thiserror::Error;

/// The errors of integrators.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum IntegrationError {
    /// The dynamics failed: an argument does not fit, or a joint meets no inertia.
    #[error(transparent)]
    Dynamics(#[from] Error),
    /// A number of the state is NaN or infinite.
    #[error("the step from t = {time:e} leads to a number that is not finite; take a shorter step, and look for NaN in forces and state")]
    NotFinite {
        /// When the step began.
        time: f64,
    },
    /// The iteration of an implicit step did not converge.
    #[error(
        "the implicit step from t = {time:e} did not converge in {iterations} iterations: the velocity still changes by {change:e}; \
         take a shorter step"
    )]
    NotConverged {
        /// When the step began.
        time: f64,
        /// Iterations done.
        iterations: usize,
        /// The largest change of a velocity in the last one.
        change: f64,
    },
    /// The linear equations of an implicit step's derivative have no unique solution.
    #[error("the derivative of the implicit step from t = {time:e} does not exist: its equations are singular; take a shorter step")]
    Singular {
        /// When the step began.
        time: f64,
    },
    /// The tolerance asks for a step that time cannot resolve.
    #[error("at t = {time:e} the tolerance asks for a step of {step:e}, which is too small; the motion is not smooth there, or allow more")]
    StepTooSmall {
        /// When it happened.
        time: f64,
        /// The step that was asked for.
        step: f64,
    },
    /// More steps than allowed.
    #[error("{steps} steps led to t = {time:e} only; allow more steps or a larger error")]
    TooManySteps {
        /// The time that was reached.
        time: f64,
        /// The steps allowed.
        steps: usize,
    },
}

impl From<DimensionError> for IntegrationError {
    fn from(error: DimensionError) -> Self {
        Self::Dynamics(error.into())
    }
}

/// The error of a workspace that was not made for derivatives.
pub(super) fn no_room() -> DimensionError {
    DimensionError { what: "workspaces made with_derivatives", expected: 1, found: 0 }
}

/// The magnitude of a number, of several lanes the largest; NaN if any is.
pub(super) fn magnitude<T: Real>(x: T) -> f64 {
    (-(-(x * x)).min_lane()).sqrt()
}

/// The largest magnitude, NaN if any number is.
pub(super) fn largest<T: Real>(numbers: impl Iterator<Item = T>) -> f64 {
    numbers.map(magnitude).fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}

/// An error unless each number of a state is finite.
pub(super) fn expect_finite<T: Real>(t: T, q: &[T], v: &[T]) -> Result<(), IntegrationError> {
    let finite = largest(q.iter().chain(v).copied()).is_finite();
    if finite { Ok(()) } else { Err(IntegrationError::NotFinite { time: t.min_lane() }) }
}
