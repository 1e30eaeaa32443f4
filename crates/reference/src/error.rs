//! Why a question about the truth has no answer.

use thiserror::Error;

/// Why a question about the truth has no answer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Error {
    /// The description is no robot.
    #[error(transparent)]
    Malformed(#[from] featherbench_model::Malformed),
    /// A vector has the wrong length.
    #[error("{array} has {found} numbers; this robot takes {expected}")]
    Length {
        /// The vector.
        array: &'static str,
        /// Numbers found.
        found: usize,
        /// Numbers due.
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
    /// A text is no decimal number.
    #[error("'{text}' is no decimal number")]
    NotANumber {
        /// The text.
        text: String,
    },
    /// A quaternion, an axis or a rotation cannot be made one, being zero or singular.
    #[error("body '{body}': {what} has no direction; it is zero or singular")]
    NoDirection {
        /// The body's name.
        body: String,
        /// What has none.
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
    /// The route does not know this joint.
    #[error("body '{body}': this route has no coordinates for a {kind} joint")]
    Unsupported {
        /// The body's name.
        body: String,
        /// The joint's kind.
        kind: &'static str,
    },
    /// A closed form was asked outside of its domain.
    #[error("{what}")]
    Domain {
        /// What must hold.
        what: &'static str,
    },
}
