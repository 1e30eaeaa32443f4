//! Writing for other programs: what the formats have in common.
//!
//! Another format may lack something that the robot has. Every such [`Loss`] is listed. The file is written only when there is none, or
//! when the caller asked to leave them out.

mod loss;
pub(crate) mod names;
pub(crate) mod order;
pub(crate) mod xml;

pub use loss::{Loss, Reason};
pub(crate) use loss::{deforming, residuals};

use crate::{Place, text};
use featherbench_model::Malformed;
use std::io;
use std::path::Path;
use thiserror::Error;

/// What to do about what the format cannot hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum OnLoss {
    /// Write nothing and list it.
    #[default]
    Refuse,
    /// Leave it out where the rest is still the robot, and list it.
    LeaveOut,
}

/// Why a robot was not written.
#[derive(Debug, Error)]
pub enum ExportError {
    /// The description is not a robot.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// The format cannot hold all of the robot.
    #[error("{}", loss::listed(format, losses))]
    Inexpressible {
        /// The format's name.
        format: &'static str,
        /// Everything that it cannot hold.
        losses: Vec<Loss>,
    },
    /// The file cannot be written; an earlier file of this name is unchanged.
    #[error("{place}: the file cannot be written: {source}")]
    Io {
        /// The file.
        place: Place,
        /// The error of the operating system.
        source: io::Error,
    },
}

impl ExportError {
    /// Whether [`OnLoss::LeaveOut`] would write the robot.
    pub fn can_be_left_out(&self) -> bool {
        matches!(self, Self::Inexpressible { losses, .. } if losses.iter().all(|loss| loss.reason.can_be_left_out()))
    }
}

/// An error for these losses, unless they may be left out.
pub(crate) fn settle(format: &'static str, losses: Vec<Loss>, on_loss: OnLoss) -> Result<Vec<Loss>, ExportError> {
    let refused = |loss: &Loss| on_loss == OnLoss::Refuse || !loss.reason.can_be_left_out();
    if losses.iter().any(refused) {
        return Err(ExportError::Inexpressible { format, losses: losses.into_iter().filter(refused).collect() });
    }
    Ok(losses)
}

/// Writes a text completely or not at all.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), ExportError> {
    let place = || Place { file: path.display().to_string(), position: None };
    text::write(path, text).map_err(|source| ExportError::Io { place: place(), source })
}
