//! Why an identification is refused.

use featherbench_dynamics::DimensionError;
use featherbench_model::Malformed;
use thiserror::Error;

/// An identification that cannot be done, with what to do about it.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum IdentificationError {
    /// The robot's description is none.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// Arrays of states that do not fit the robot.
    #[error(transparent)]
    Dimension(#[from] DimensionError),
    /// An array of another length than the samples need.
    #[error("{array} has {found} numbers; {samples} samples of this robot take {expected}")]
    Length {
        /// The array.
        array: &'static str,
        /// Numbers found.
        found: usize,
        /// Samples.
        samples: usize,
        /// Numbers expected.
        expected: usize,
    },
    /// NaN or infinite.
    #[error("{what} is {value}; give a finite number")]
    NotFinite {
        /// Where the number stands.
        what: String,
        /// The number.
        value: f64,
    },
    /// Fewer equations than unknowns.
    #[error("{equations} equations do not determine {unknowns} parameters; give a longer log, or ask for fewer terms")]
    TooFew {
        /// Rows of all samples.
        equations: usize,
        /// Base parameters.
        unknowns: usize,
    },
    /// No column of the regressor differs from zero.
    #[error("no parameter has an effect on the torques of these samples; let the robot move, or let gravity act")]
    NoEffect,
    /// The singular values have no gap where the threshold cuts.
    #[error(
        "the rank is not clear: {by_singular} singular values are above the threshold {threshold:e}, but {by_columns} columns are independent \
         (σ gap {gap:.1e}); give more samples, or states that excite more"
    )]
    UnclearRank {
        /// The rank by singular values.
        by_singular: usize,
        /// The rank by pivoted columns.
        by_columns: usize,
        /// The threshold, relative to the largest singular value.
        threshold: f64,
        /// Ratio of the singular values on both sides of the cut.
        gap: f64,
    },
    /// A decomposition did not converge, or a triangular matrix is singular.
    #[error("{0} has no solution in double precision; scale the data, or give samples that excite more")]
    Singular(&'static str),
    /// An iteration reached its limit.
    #[error("{method} did not converge within {iterations} iterations (last step {step:.1e}); raise the limit, or the regularisation")]
    NotConverged {
        /// The method.
        method: &'static str,
        /// Iterations done.
        iterations: usize,
        /// The last relative step.
        step: f64,
    },
    /// A body without a physical inertia where one is needed.
    #[error("body '{body}': {defect}; the physically consistent estimators start from a body that can exist")]
    Unphysical {
        /// The body.
        body: String,
        /// What is wrong.
        defect: String,
    },
    /// A joint that a Fourier trajectory cannot move.
    #[error(
        "joint '{joint}' is {kind}; Fourier trajectories move joints whose positions are plain numbers (fix the base, or log a motion of yours)"
    )]
    NotExcitable {
        /// The joint.
        joint: String,
        /// Its kind.
        kind: &'static str,
    },
    /// A setting out of its range.
    #[error("setting '{setting}' is {value}; {expected}")]
    Setting {
        /// Its name.
        setting: &'static str,
        /// The value.
        value: String,
        /// What it takes.
        expected: &'static str,
    },
    /// No answer of a solver of semidefinite programmes.
    #[error(
        "the semidefinite programme has no answer: {reason}; install the engine by `featherbench oracles install`, or take log_cholesky"
    )]
    NoSolver {
        /// Why.
        reason: String,
    },
    /// No trajectory within the limits was found.
    #[error(
        "none of {tries} trajectories keeps the limits of joints, speed and torque; the last broke that of joint '{joint}'; lower the frequency or widen the limits"
    )]
    NoTrajectory {
        /// Trajectories tried.
        tries: usize,
        /// The joint whose limit the last one broke.
        joint: String,
    },
}
