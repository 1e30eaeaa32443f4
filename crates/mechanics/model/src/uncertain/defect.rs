//! What can be wrong with the section `uncertain`.

use thiserror::Error;

/// What is wrong with an uncertain variable or a correlation.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum UncertainDefect {
    /// Another variable has the same name.
    #[error("another variable has the same name; names must be unique")]
    DuplicateName,
    /// A number is NaN or infinite.
    #[error("{field} is {value}; write a finite number")]
    NotFinite {
        /// The field that holds the number.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// A number that must be positive.
    #[error("{field} is {value}; it must be positive")]
    NotPositive {
        /// The field that holds the number.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// The lower bound is not below the upper.
    #[error("the lower bound {low} is not below the upper bound {high}")]
    Bounds {
        /// The lower bound.
        low: f64,
        /// The upper bound.
        high: f64,
    },
    /// A truncation far out in the tail.
    #[error(
        "the bounds {low} and {high} leave less than a thousandth of the normal variable; give the distribution by its own mean and deviation"
    )]
    Tail {
        /// The lower bound.
        low: f64,
        /// The upper bound.
        high: f64,
    },
    /// Nothing follows it.
    #[error("on: nothing follows the variable; name one number at least")]
    NoTarget,
    /// A body that does not exist.
    #[error("on: body {body} does not exist (there are {count} bodies, counted from 0)")]
    NoBody {
        /// The body.
        body: usize,
        /// How many there are.
        count: usize,
    },
    /// A body that is part of another.
    #[error(
        "on: body {body} is fixed to its parent and has no inertia of its own in the dynamics; name the moving body, or merge them first"
    )]
    FixedBody {
        /// The body.
        body: usize,
    },
    /// A component, entry or dof that the body has not.
    #[error("on: body {body} has no {field} {index}; there are {count}, counted from 0")]
    NoIndex {
        /// The body.
        body: usize,
        /// The field.
        field: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// Armature on a free joint, which a description refuses too.
    #[error("on: body {body} has a free joint, which has no armature")]
    FreeArmature {
        /// The body.
        body: usize,
    },
    /// Two variables, or one twice, set the same number.
    #[error("on: the {field} of body {body} follows another variable too; let a number follow one")]
    Repeated {
        /// The body.
        body: usize,
        /// The field.
        field: &'static str,
    },
    /// A factor of zero changes nothing.
    #[error("on: the {field} of body {body} is zero, so a factor changes nothing; set it as a value")]
    FactorOfZero {
        /// The body.
        body: usize,
        /// The field.
        field: &'static str,
    },
    /// A density is known as a factor alone.
    #[error("on: the density of body {body} takes a factor, not a value")]
    DensityValue {
        /// The body.
        body: usize,
    },
    /// A normal variable on a number that must stay positive.
    #[error(
        "a normal variable cannot be the {field} of body {body}: it is negative or near zero with positive probability, so 1/{field} has no mean and \
         no variance, and neither have accelerations; truncate it by 'truncated_normal' above zero, or take 'lognormal' or 'gamma'"
    )]
    Gaussian {
        /// The body.
        body: usize,
        /// The field.
        field: &'static str,
    },
    /// A distribution that reaches values which the number cannot have.
    #[error("the {field} of body {body} must {demand}, and the variable reaches down to {low}; raise its lower bound")]
    Reaches {
        /// The body.
        body: usize,
        /// The field.
        field: &'static str,
        /// What the number must do.
        demand: &'static str,
        /// The lowest value.
        low: f64,
    },
    /// A gamma variable whose reciprocal has no variance.
    #[error(
        "the deviation is {deviation} of a mean of {mean}: 1/x of a gamma variable has a variance only if the deviation is below {limit} of the \
         mean; take a smaller one, or 'lognormal'"
    )]
    HeavyGamma {
        /// The mean.
        mean: f64,
        /// The standard deviation.
        deviation: f64,
        /// 1/√2.
        limit: f64,
    },
    /// A correlation of a variable that does not exist, or with itself, or given twice.
    #[error("correlations[{index}]: {what}")]
    Correlation {
        /// The place of the correlation in the list, counted from 0.
        index: usize,
        /// What is wrong.
        what: String,
    },
    /// No variables are correlated so.
    #[error(
        "correlations: the matrix is not positive definite (its smallest pivot is {pivot:e}); no variables are correlated so. For variables that are equal, let one act on several numbers"
    )]
    Indefinite {
        /// The smallest pivot of the elimination.
        pivot: f64,
    },
}
