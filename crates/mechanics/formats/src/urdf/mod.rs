//! URDF: links and joints of an XML file as a neutral description, and back.
//!
//! The import is strict. Engines repair without a note: a missing inertia becomes zero, a word in a vector is skipped, an axis of length
//! zero becomes x. Then they disagree. Here each of these is an error with file, line and column. Whatever is left out or altered gives a
//! [`Note`].
//!
//! - A link without `<inertial>` has no mass. That is allowed where it is fixed to a link with mass. A link that moves without any mass is
//!   an error unless [`Options::allow_massless`].
//! - Gravity is not part of URDF: (0, 0, −9.81).
//! - The root link is fixed to the world ([`Base::Fixed`]) or has a free joint named `root_joint` ([`Base::Floating`]).
//!   A root without inertia, such as a link `world`, may carry the robot on a `floating` joint. Then that joint is the floating base.
//! - Siblings keep the order of their joints in the file. (Parsers built on urdfdom sort them by joint name.)
//! - `rpy` is R = Rz(yaw)·Ry(pitch)·Rx(roll); an axis is normalised, with a note when that changes more than its last digit.
//! - Fixed joints are merged, each leaving a frame with the link's name.
//! - A `floating` joint becomes free, a `planar` one planar in the plane normal to its axis, `continuous` revolute without position limits.
//!   A `revolute` or `prismatic` joint whose `<limit>` gives neither `lower` nor `upper` has none (urdfdom would lock it at zero).
//! - xacro is an error: macros must be expanded first. Meshes and other formats are errors that name the format.
//! - A joint with `<mimic>` is a joint of the tree, and a loop ties it to the joint that it follows: q = offset + multiplier·q_leader.
//!   A mimic that cannot be tied is an error that names the joints. With [`Options::independent_mimics`] there is a note instead of the
//!   loop, and the joint is independent, as in engines by default.
//! - Noted and not imported: visual and collision geometry, `safety_controller`, `calibration`, and every element of `<robot>` that is
//!   neither link nor joint.
//!
//! Limits: 10 MB, a million XML nodes, no document type declaration (hence no entities to expand). Nesting uses no stack.

mod angles;
mod elements;
mod error;
mod links;
mod tree;
mod write;
mod xml;

pub use error::{UrdfError, UrdfProblem};
pub use links::{Inertial, LinkInFile, Mimic, links, mimics};
pub use write::{to_string, write};

use crate::text;
use featherbench_model::{Description, Warning};
use std::fmt;
use std::path::Path;

/// The largest file that is read, bytes.
pub const LIMIT: usize = 10 << 20;

/// The joint of the root link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Base {
    /// Fixed to the world: its inertia has no effect.
    #[default]
    Fixed,
    /// A free joint.
    Floating,
}

/// How a file is imported.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Options {
    /// The joint of the root link.
    pub base: Base,
    /// Whether a moving body may have no mass (with a note); otherwise that is an error.
    pub allow_massless: bool,
    /// Whether joints that mimic another are imported as independent joints (with a note); otherwise a loop ties each to the other.
    pub independent_mimics: bool,
}

/// Something that was left out or altered.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// The line it is about, counted from 1.
    pub line: usize,
    /// What was done.
    pub text: String,
    /// The model's warning for the same number, if it is one that is normalised.
    pub warning: Option<Warning>,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.text)
    }
}

/// Reads a URDF file: a canonical description, and notes in the order of the file.
///
/// # Errors
/// [`UrdfError`], naming file, line, column and the link or joint.
pub fn read(path: impl AsRef<Path>, options: &Options) -> Result<(Description, Vec<Note>), UrdfError> {
    let path = path.as_ref();
    let file = path.display().to_string();
    match text::read(path, LIMIT) {
        Ok(text) => import(&text, &file, options),
        Err(error) => Err(UrdfError::new(file, None, error)),
    }
}

/// Imports URDF from a text; `file` is its name in errors.
///
/// # Errors
/// [`UrdfError`], naming file, line, column and the link or joint.
pub fn import(text: &str, file: &str, options: &Options) -> Result<(Description, Vec<Note>), UrdfError> {
    let text = text::check(text, LIMIT).map_err(|problem| UrdfError::new(file, None, problem))?;
    let read = || -> Result<_, error::At> {
        let document = xml::parse(text)?;
        let mut notes = Vec::new();
        let robot = elements::Robot::read(&document, options, &mut notes)?;
        let description = tree::assemble(&robot, options, &mut notes)?;
        notes.sort_by_key(|note| note.offset);
        Ok((description, notes))
    };
    let (description, notes) = read().map_err(|error::At { offset, problem }| {
        let of_parser = if let UrdfProblem::Xml { position, .. } = &problem { Some(*position) } else { None };
        let position = offset.map(|offset| text::position(text, offset)).or(of_parser);
        UrdfError::new(file, position, problem)
    })?;
    let lines = text::Lines::new(text);
    let note = |note: error::NoteAt| Note { line: lines.line(note.offset), text: note.text, warning: note.warning };
    Ok((description, notes.into_iter().map(note).collect()))
}
