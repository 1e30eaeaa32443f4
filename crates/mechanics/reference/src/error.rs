//! Why the reference gives no answer.

use thiserror::Error;

/// Why the reference gives no answer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Error {
    /// The description is not a robot.
    #[error(transparent)]
    Malformed(#[from] featherbench_model::Malformed),
    /// A vector has the wrong length.
    #[error("{array} has {found} numbers; this robot takes {expected}")]
    Length {
        /// The vector.
        array: &'static str,
        /// Numbers found.
        found: usize,
        /// Numbers expected.
        expected: usize,
    },
    /// A number is NaN or infinite.
    #[error("{array}[{index}] is not finite")]
    NotFinite {
        /// The vector.
        array: &'static str,
        /// The index.
        index: usize,
    },
    /// A text is not a decimal number.
    #[error("'{text}' is no decimal number")]
    NotANumber {
        /// The text.
        text: String,
    },
    /// A quaternion, axis or rotation cannot be normalised: it is zero or singular.
    #[error("body '{body}': {what} has no direction; it is zero or singular")]
    NoDirection {
        /// The body's name.
        body: String,
        /// What has no direction.
        what: &'static str,
    },
    /// A pivot of the mass matrix is not positive.
    #[error("the mass matrix is not positive definite at degree of freedom {dof}")]
    NotPositiveDefinite {
        /// The degree of freedom.
        dof: usize,
    },
    /// The equations have no unique solution.
    #[error("the equations are singular at row {row}")]
    Singular {
        /// The row without a pivot.
        row: usize,
    },
    /// The method does not support this joint.
    #[error("body '{body}': this route has no coordinates for a {kind} joint")]
    Unsupported {
        /// The body's name.
        body: String,
        /// The joint's kind.
        kind: &'static str,
    },
    /// A closed form was asked outside its domain.
    #[error("{what}")]
    Domain {
        /// What must hold.
        what: &'static str,
    },
}
