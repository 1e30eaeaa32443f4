//! What can go wrong, as one enum.

use crate::Convention;
use featherbench_dynamics::{BatchError, DimensionError, NotPositiveDefinite};
use featherbench_formats::mjcf::MjcfError;
use featherbench_formats::neutral::NeutralError;
use featherbench_formats::urdf::UrdfError;
use featherbench_model::Malformed;
use featherbench_robots::BadFamily;
use thiserror::Error;

/// Why a robot was not made, or a call has no answer.
///
/// ```
/// use featherbench_rbd::{Error, Robot};
///
/// let robot = Robot::generated("chain:n=2")?;
/// let found = robot.inverse_dynamics(&[0.0, f64::NAN], &[0.0; 2], &[0.0; 2]);
/// assert!(matches!(found, Err(Error::NotFinite { argument: "q", index: 1, .. })));
/// assert_eq!(found.unwrap_err().to_string(), "q[1] is NaN; give a finite number");
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Error)]
pub enum Error {
    /// A URDF file cannot be read.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
    /// An MJCF file cannot be read.
    #[error(transparent)]
    Mjcf(#[from] MjcfError),
    /// A description file cannot be read.
    #[error(transparent)]
    Neutral(#[from] NeutralError),
    /// A description is not a robot.
    #[error(transparent)]
    Malformed(#[from] Box<Malformed>),
    /// No family of generated robots is described so.
    #[error(transparent)]
    Family(#[from] BadFamily),
    /// The ending of a file's name is not one that is read.
    #[error("{path}: the name ends in none of .urdf, .xml and .mjcf (MJCF), and .json; read it by `from_urdf`, `from_mjcf` or `from_json`")]
    UnknownEnding {
        /// The file as the caller named it.
        path: String,
    },
    /// No joint has this name.
    #[error("there is no joint '{name}'; the robot has {known}")]
    NoSuchJoint {
        /// The name given.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// No body and no fixed frame has this name.
    #[error("there is no body or frame '{name}'; the robot has {known}")]
    NoSuchFrame {
        /// The name given.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// A frame belongs to another robot.
    #[error("frame '{name}' belongs to a robot with other bodies; ask this robot for its frame")]
    ForeignFrame {
        /// The frame's name.
        name: String,
    },
    /// Bodies were placed and not moved, so they have no velocities.
    #[error("the bodies were placed by `placements`, and have no velocities; call `kinematics` for these")]
    NotMoved,
    /// An argument has the wrong length.
    #[error("{argument} has {found} numbers; this robot takes {expected}")]
    Length {
        /// The argument.
        argument: &'static str,
        /// The numbers that the robot needs.
        expected: usize,
        /// The numbers found.
        found: usize,
    },
    /// A number that was given is NaN or infinite.
    #[error("{argument}[{index}] is {value}; give a finite number")]
    NotFinite {
        /// The argument.
        argument: &'static str,
        /// The place in it, counted from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A quaternion is zero, or so long or short that its square is not a number of full precision.
    #[error("{argument}[{index}]: the quaternion of joint '{joint}' begins here and has length {length:e}: no rotation; give length 1")]
    NotARotation {
        /// The argument.
        argument: &'static str,
        /// Where the quaternion begins in it.
        index: usize,
        /// The joint.
        joint: String,
        /// The quaternion's length.
        length: f64,
    },
    /// A result is NaN or infinite, although each number that was given is finite.
    #[error("{result}[{index}] is {value}: the numbers given are too large for double precision; give smaller ones")]
    ResultNotFinite {
        /// The result.
        result: &'static str,
        /// The place in it, counted from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A dof moves no inertia.
    #[error(transparent)]
    NotPositiveDefinite(#[from] NotPositiveDefinite),
    /// An array of a workspace does not fit.
    #[error(transparent)]
    Dimension(#[from] DimensionError),
    /// A batch was not computed, or some of its states failed.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// Pinocchio's own parser gives the file from which the robot was read other coordinates.
    #[error(
        "the numbers of a model that Pinocchio's own URDF parser built are others: {reason}; reorder them by the names of its model \
         (`idx_qs`, `idx_vs`), or read the robot from a description, whose order of joints is that of its model"
    )]
    OtherCoordinates {
        /// What the parser does.
        reason: String,
    },
    /// An engine does not have this joint.
    #[error("{convention} has no coordinates of joint '{joint}' ({kind}): {reason}")]
    NoCoordinates {
        /// The engine.
        convention: Convention,
        /// The joint.
        joint: String,
        /// Its kind.
        kind: &'static str,
        /// Why.
        reason: &'static str,
    },
}

impl From<Malformed> for Error {
    fn from(malformed: Malformed) -> Self {
        Self::Malformed(Box::new(malformed))
    }
}

impl From<featherbench_dynamics::Error> for Error {
    fn from(error: featherbench_dynamics::Error) -> Self {
        match error {
            featherbench_dynamics::Error::Dimension(error) => Self::Dimension(error),
            featherbench_dynamics::Error::NotPositiveDefinite(error) => Self::NotPositiveDefinite(error),
        }
    }
}

/// An error, unless the argument has this many numbers and each is finite.
#[inline]
pub(crate) fn check(argument: &'static str, expected: usize, values: &[f64]) -> Result<(), Error> {
    if values.len() != expected {
        return Err(Error::Length { argument, expected, found: values.len() });
    }
    match first_not_finite(values) {
        Some((index, value)) => Err(Error::NotFinite { argument, index, value }),
        None => Ok(()),
    }
}

/// An error, unless the place for a result has this many numbers.
#[inline]
pub(crate) fn check_length(argument: &'static str, expected: usize, found: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Length { argument, expected, found }) }
}

/// An error, unless each number of a result is finite.
#[inline]
pub(crate) fn check_result(result: &'static str, values: &[f64]) -> Result<(), Error> {
    match first_not_finite(values) {
        Some((index, value)) => Err(Error::ResultNotFinite { result, index, value }),
        None => Ok(()),
    }
}

/// The first number that is NaN or infinite.
#[inline]
fn first_not_finite(values: &[f64]) -> Option<(usize, f64)> {
    // 0·x is 0 for a finite x and NaN otherwise. The sum has no branch, so it takes whole registers.
    if values.iter().fold(0.0, |sum, x| sum + 0.0 * x) == 0.0 {
        return None;
    }
    values.iter().copied().enumerate().find(|(_, x)| !x.is_finite())
}
