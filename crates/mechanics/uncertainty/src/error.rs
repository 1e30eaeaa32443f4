//! Why there is no answer.

use featherbench_model::{DimensionError, Malformed, UncertainDefect};
use thiserror::Error;

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Error {
    /// The description is no robot, or its uncertain parameters are none.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// A distribution is none.
    #[error("variable {variable}: {defect}")]
    Distribution {
        /// The variable, counted from 0.
        variable: usize,
        /// What is wrong with it.
        defect: UncertainDefect,
    },
    /// A vector has the wrong length.
    #[error(transparent)]
    Dimension(#[from] DimensionError),
    /// The dynamics have no answer at the nominal parameters.
    #[error("the dynamics at the means of the variables: {0}")]
    Dynamics(#[from] featherbench_dynamics::Error),
    /// There are no variables.
    #[error("there are no uncertain parameters; write a section 'uncertain', or give all masses a spread")]
    NoVariables,
    /// A sample has no finite answer.
    #[error(
        "sample {sample} of replicate {replicate} has no finite answer: the mass matrix is not positive definite there, or the answer overflows; \
         narrow the distributions so that every sample is a robot"
    )]
    NotFinite {
        /// The replicate.
        replicate: u64,
        /// The sample, counted from 0.
        sample: u64,
    },
    /// A point of a deterministic rule has no finite answer.
    #[error("point {point} of the {method} has no finite answer; narrow the distributions")]
    NotFinitePoint {
        /// The method.
        method: &'static str,
        /// The point, counted from 0.
        point: usize,
    },
    /// A point is outside a distribution's support.
    #[error("the {method} asks at {value} for variable {variable}, which is outside its support; take another method")]
    OutsideSupport {
        /// The method.
        method: &'static str,
        /// The variable, counted from 0.
        variable: usize,
        /// The value.
        value: f64,
    },
    /// An order of polynomials that are not known.
    #[error(
        "order {order} is above {limit}, up to which the polynomials of a variable are known; take order {highest} or a lower one, or sample"
    )]
    OrderTooHigh {
        /// The order.
        order: usize,
        /// The highest order of a polynomial.
        limit: usize,
        /// The highest order that these variables allow.
        highest: usize,
    },
    /// Too many nodes of a tensor rule.
    #[error(
        "{points} points for each of {variables} variables make {points}^{variables} nodes, and {limit} are allowed; take order {highest} or a lower \
         one, or sample"
    )]
    TooManyNodes {
        /// The points in each direction: one more than the order.
        points: usize,
        /// The variables.
        variables: usize,
        /// The largest number of nodes.
        limit: usize,
        /// The highest order that these variables allow.
        highest: usize,
    },
    /// More variables than there are dimensions of points.
    #[error("there are {found} dimensions, and Sobol' points have {limit} at most; take random points")]
    TooManyDimensions {
        /// The dimensions.
        found: usize,
        /// The largest number.
        limit: usize,
    },
    /// A decomposition of the variance asks for independent variables.
    #[error("Sobol' indices are of independent variables, and these are correlated")]
    Correlated,
    /// A setting that makes no sense.
    #[error("{setting} is {found}; {demand}")]
    Setting {
        /// The setting.
        setting: &'static str,
        /// What was given.
        found: u64,
        /// What may be given.
        demand: &'static str,
    },
    /// Bounds of what has none.
    #[error("there are no exact bounds: {0}")]
    Unbounded(&'static str),
    /// The threads could not be started.
    #[error("the threads could not be started: {0}")]
    Threads(String),
}
