//! What can go wrong with residuals.

use featherbench_dynamics::{DimensionError, NotPositiveDefinite};
use thiserror::Error;

/// The errors of residuals and of the dynamics that they correct.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ResidualError {
    /// An argument has the wrong size.
    #[error(transparent)]
    Dimension(#[from] DimensionError),
    /// The joint-space inertia matrix of the nominal model is not positive definite.
    #[error(transparent)]
    NotPositiveDefinite(#[from] NotPositiveDefinite),
    /// A number is NaN or infinite.
    #[error("{what} number {index} is not finite; look for NaN in what computes it")]
    NotFinite {
        /// The argument.
        what: &'static str,
        /// Where the number stands in it.
        index: usize,
    },
    /// A parameter that makes no sense.
    #[error("{parameter} number {index} is {value}; {demand}")]
    Parameter {
        /// Its name.
        parameter: &'static str,
        /// The dof.
        index: usize,
        /// Its value.
        value: f64,
        /// What it must be.
        demand: &'static str,
    },
    /// The acceleration is not determined: M + ∂r/∂a is singular, or so nearly that no digit is left.
    #[error(
        "M + ∂r/∂a has the reciprocal condition {reciprocal_condition:e}, below {threshold:e}: the acceleration is not determined; \
         make the residual depend less on the acceleration"
    )]
    IllPosed {
        /// Smallest over largest singular value, after scaling by the diagonal of M.
        reciprocal_condition: f64,
        /// The least that is accepted.
        threshold: f64,
    },
    /// Newton's method did not find the acceleration.
    #[error("the acceleration did not converge in {iterations} iterations: M a + h + r − τ is still {residual:e} of its terms")]
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// What was left, relative to its largest term.
        residual: f64,
    },
    /// A residual that depends on the commanded joint forces was asked without them.
    #[error("this residual depends on the commanded joint forces: give the state with `State::with_command`")]
    NoCommand,
    /// Dry friction at rest: any force of an interval is possible.
    #[error("dof {dof} is at rest and does not accelerate: dry friction may be any force of ±{limit}; ask for the interval")]
    Interval {
        /// The dof.
        dof: usize,
        /// The largest friction.
        limit: f64,
    },
    /// There is no such body.
    #[error("body {body} does not exist: the robot has {bodies}")]
    NoBody {
        /// The body's number.
        body: usize,
        /// How many there are.
        bodies: usize,
    },
    /// The statement holds for joints with a number per dof alone.
    #[error("{what} needs joints with one number of q per dof, and this robot has nq = {nq}, nv = {nv}")]
    NotAVectorSpace {
        /// What was asked.
        what: &'static str,
        /// Numbers of q.
        nq: usize,
        /// Dofs.
        nv: usize,
    },
    /// A matrix that must be positive definite is not.
    #[error("{what} is not positive definite: its smallest eigenvalue is {smallest:e}")]
    Indefinite {
        /// The matrix.
        what: &'static str,
        /// Its smallest eigenvalue.
        smallest: f64,
    },
    /// A residual in another program did not answer.
    #[error("the residual did not answer: {0}")]
    NoAnswer(String),
    /// The data do not determine what was to be learned, or the optimiser gave up.
    #[error("learning failed: {0}")]
    Learning(String),
}

impl From<featherbench_dynamics::Error> for ResidualError {
    fn from(error: featherbench_dynamics::Error) -> Self {
        match error {
            featherbench_dynamics::Error::Dimension(error) => Self::Dimension(error),
            featherbench_dynamics::Error::NotPositiveDefinite(error) => Self::NotPositiveDefinite(error),
        }
    }
}

/// An error if a number is not finite.
pub(crate) fn finite(what: &'static str, values: &[f64]) -> Result<(), ResidualError> {
    match values.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(ResidualError::NotFinite { what, index }),
        None => Ok(()),
    }
}

/// An error if a parameter is not finite, or does not fulfil the demand.
pub(crate) fn demand(
    parameter: &'static str,
    values: &[f64],
    demand: &'static str,
    holds: impl Fn(f64) -> bool,
) -> Result<(), ResidualError> {
    match values.iter().position(|&x| !(x.is_finite() && holds(x))) {
        Some(index) => Err(ResidualError::Parameter { parameter, index, value: values[index], demand }),
        None => Ok(()),
    }
}

/// An error if a count is not the expected one.
pub(crate) fn expect(what: &'static str, expected: usize, found: usize) -> Result<(), ResidualError> {
    Ok(DimensionError::expect(what, expected, found)?)
}
