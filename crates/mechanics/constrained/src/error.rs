//! What can go wrong with constrained dynamics.

use featherbench_dynamics::{DimensionError, NotPositiveDefinite};
use thiserror::Error;

/// The errors of constrained kinematics and dynamics.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Error {
    /// An argument has the wrong size.
    #[error(transparent)]
    Dimension(#[from] DimensionError),
    /// The joint-space inertia matrix is not positive definite.
    #[error(transparent)]
    NotPositiveDefinite(#[from] NotPositiveDefinite),
    /// A number of the state is NaN or infinite.
    #[error("{what} number {index} is not finite; look for NaN in what computes it")]
    NotFinite {
        /// The argument.
        what: &'static str,
        /// Where the number stands in it.
        index: usize,
    },
    /// The model has another tree than the constraints.
    #[error("the constraints were made for another tree; make them with the topology of the model that you pass")]
    OtherTree,
    /// The frames of a joint that holds their orientation are half a turn apart.
    #[error("constraint '{constraint}': its frames are half a turn apart, where the orientation error has no direction; start closer")]
    HalfTurn {
        /// The constraint.
        constraint: String,
    },
    /// The accelerations asked for contradict each other.
    #[error(
        "constraint '{constraint}' asks for an acceleration that the others forbid: row {row} misses it by {residual:e} \
         (rank {rank} of {rows} rows); ask for compatible ones, or use the proximal method, which reports the residual"
    )]
    Inconsistent {
        /// The constraint with the largest residual.
        constraint: String,
        /// The row.
        row: usize,
        /// What the acceleration misses there, in the row's unit per s².
        residual: f64,
        /// The rank.
        rank: usize,
        /// The number of rows.
        rows: usize,
    },
    /// A parameter of a method that makes no sense.
    #[error("{parameter} is {value}; {demand}")]
    Parameter {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        demand: &'static str,
    },
    /// An iteration ended at its cap.
    #[error("{what} did not converge in {iterations} iterations: the residual is still {residual:e}; start closer, or allow more")]
    NotConverged {
        /// What was iterated.
        what: &'static str,
        /// Iterations done.
        iterations: usize,
        /// The residual then.
        residual: f64,
    },
}

impl From<featherbench_dynamics::Error> for Error {
    fn from(error: featherbench_dynamics::Error) -> Self {
        match error {
            featherbench_dynamics::Error::Dimension(error) => Self::Dimension(error),
            featherbench_dynamics::Error::NotPositiveDefinite(error) => Self::NotPositiveDefinite(error),
        }
    }
}
