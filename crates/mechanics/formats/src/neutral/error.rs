//! What can be wrong with a description file.

use crate::{FileError, TextError};
use featherbench_model::Malformed;
use std::fmt;
use thiserror::Error;

/// A description file that cannot be read or written: the place, and why.
pub type NeutralError = FileError<NeutralProblem>;

/// What is wrong with a description file.
#[derive(Debug, Error)]
pub enum NeutralProblem {
    /// The file is not text.
    #[error("the file {0}")]
    Text(#[from] TextError),
    /// The text is not JSON.
    #[error("this is not valid JSON: {message} (in {})", Field(field))]
    Syntax {
        /// The path to the field; `.` for the whole file.
        field: String,
        /// What the parser expected.
        message: String,
    },
    /// A field is missing or unknown, or has a wrong type.
    #[error("{}: {message} (datasets/models/FORMAT.md lists the fields)", Field(field))]
    Field {
        /// The path to the field, such as `bodies[3].joint.axis`; `.` for the whole file.
        field: String,
        /// What is wrong with it.
        message: String,
    },
    /// Another version of the format.
    #[error("format {found} is not known; this version of featherbench reads \"format\": 1")]
    Version {
        /// The version in the file.
        found: String,
    },
    /// A section of the format that this version does not support.
    #[error("section '{section}' is not supported by this version of featherbench; remove it to read the rest of the robot")]
    UnsupportedSection {
        /// The section's key.
        section: &'static str,
    },
    /// The numbers are not a robot.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// The file cannot be written; an earlier file of this name is unchanged.
    #[error("the file cannot be written: {0}")]
    Write(#[source] std::io::Error),
}

/// A field's path in words.
struct Field<'a>(&'a str);

impl fmt::Display for Field<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            "." => write!(f, "the file"),
            path => write!(f, "field '{path}'"),
        }
    }
}
