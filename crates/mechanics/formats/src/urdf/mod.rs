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
//! - Versions 1.0 (of a file that gives none), 1.1 and 1.2 are known. Another one is an error, as in the specification.
//! - `quat_xyzw` (from version 1.1) may have any length but zero; a note tells a length other than one. Beside `rpy` it is an error. A file
//!   of version 1.0 does not have it: it is noted, and not read.
//! - `rpy` is R = Rz(yaw)·Ry(pitch)·Rx(roll); an axis is normalised, with a note when that changes more than its last digit.
//! - Fixed joints are merged, each leaving a frame with the link's name.
//! - A `floating` joint becomes free, a `planar` one planar in the plane normal to its axis, `continuous` revolute without position limits.
//!   A `revolute` or `prismatic` joint whose `<limit>` gives neither `lower` nor `upper` has none (urdfdom would lock it at zero).
//! - xacro is an error: macros must be expanded first. Meshes and other formats are errors that name the format.
//! - A joint with `<mimic>` is a joint of the tree, and a loop ties it to the joint that it follows: q = offset + multiplier·q_leader.
//!   A mimic that cannot be tied is an error that names the joints. With [`Options::independent_mimics`] there is a note instead of the
//!   loop, and the joint is independent, as in engines by default.
//! - Noted and not imported: visual and collision geometry, `safety_controller`, `calibration`, every element of `<robot>` that is
//!   neither link nor joint, and every attribute that is not named here. `acceleration`, `deceleration` and `jerk` of `<limit>`
//!   (version 1.2) are such: the equations of motion have no such limits.
//!
//! Limits: 10 MB, a million XML nodes, no document type declaration (hence no entities to expand). Nesting uses no stack.

mod angles;
mod elements;
mod error;
mod links;
mod mend;
mod tree;
mod write;
mod xml;

pub use error::{UrdfError, UrdfProblem};
pub use links::{BadValue, FileInertial, FileLink, Mimic};
pub use mend::Mended;
pub use write::{to_string, write};

use crate::{TextError, text};
use featherbench_model::{Description, Warning};
use roxmltree::Document;
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
    import(&content(path)?, &path.display().to_string(), options)
}

/// The text of a URDF file.
///
/// # Errors
/// [`UrdfError`], naming the file: it cannot be read, is too large or is no UTF-8.
pub fn content(path: impl AsRef<Path>) -> Result<String, UrdfError> {
    let path = path.as_ref();
    text::read(path, LIMIT).map_err(|problem| unplaced(&path.display().to_string(), problem))
}

/// Imports URDF from a text; `file` is its name in errors.
///
/// # Errors
/// [`UrdfError`], naming file, line, column and the link or joint.
pub fn import(text: &str, file: &str, options: &Options) -> Result<(Description, Vec<Note>), UrdfError> {
    Parsed::of(text.as_bytes(), file)?.import(options)
}

/// A URDF text that is parsed once, and then asked for the robot and for what the file says link by link.
pub struct Parsed<'a> {
    text: &'a str,
    file: &'a str,
    document: Document<'a>,
}

impl<'a> Parsed<'a> {
    /// Parses the content of a file; `file` is its name in errors.
    ///
    /// # Errors
    /// [`UrdfError`], when it is no XML in UTF-8 or too large.
    pub fn of(bytes: &'a [u8], file: &'a str) -> Result<Self, UrdfError> {
        let text = text::of_bytes(bytes, LIMIT).and_then(|text| text::check(text, LIMIT));
        let text = text.map_err(|problem| unplaced(file, problem))?;
        let document = xml::parse(text).map_err(|error| placed(text, file, error))?;
        Ok(Self { text, file, document })
    }

    /// The robot: a canonical description, and notes in the order of the file.
    ///
    /// # Errors
    /// [`UrdfError`], naming file, line, column and the link or joint.
    pub fn import(&self, options: &Options) -> Result<(Description, Vec<Note>), UrdfError> {
        let mut notes = Vec::new();
        let robot = elements::Robot::read(&self.document, options, &mut notes);
        let description = robot.and_then(|robot| tree::assemble(&robot, options, &mut notes));
        let description = description.map_err(|error| placed(self.text, self.file, error))?;
        notes.sort_by_key(|note| note.offset);
        let lines = text::Lines::new(self.text);
        let note = |note: error::NoteAt| Note { line: lines.line(note.offset), text: note.text, warning: note.warning };
        Ok((description, notes.into_iter().map(note).collect()))
    }

    /// The links in the order of the file, with their collision geometry at a density (kg/m³). A file whose links have an error has none.
    pub fn links(&self, density: f64) -> Vec<FileLink> {
        links::links(&self.document, density)
    }

    /// Damping and friction that no joint can have, in the order of the file. The import refuses them.
    pub fn bad_values(&self) -> Vec<BadValue> {
        links::bad_values(&self.document, &text::Lines::new(self.text))
    }

    /// The joints that are not fixed, depth-first, with siblings in the order of their joints' names: the order of parsers built on urdfdom.
    pub fn sorted_joints(&self) -> Vec<String> {
        links::sorted_joints(&self.document)
    }

    /// The mimics in the order of the file.
    pub fn mimics(&self) -> Vec<Mimic> {
        links::mimics(&self.document)
    }
}

/// A problem of a whole file.
fn unplaced(file: &str, problem: TextError) -> UrdfError {
    UrdfError::new(file, None, problem)
}

/// A problem at its place in a text.
fn placed(text: &str, file: &str, error::At { offset, problem }: error::At) -> UrdfError {
    let of_parser = if let UrdfProblem::Xml { position, .. } = &problem { Some(*position) } else { None };
    let position = offset.map(|offset| text::position(text, offset)).or(of_parser);
    UrdfError::new(file, position, problem)
}
