//! Reading MJCF: nested bodies with their joints as a neutral description.

mod element;
mod error;
mod include;
mod inertial;
mod joint;
mod settings;
mod told;
mod tree;

pub use error::{MjcfError, MjcfProblem};

use crate::text;
use error::At;
use featherbench_model::Description;
use include::Source;
use roxmltree::Document;
use std::fmt;
use std::path::Path;

/// The largest file that is read, bytes.
pub const LIMIT: usize = 10 << 20;

/// Something that was left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The line it is about, counted from 1.
    pub line: usize,
    /// What was done.
    pub text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.text)
    }
}

/// Reads an MJCF file with the files that it includes: a canonical description, and notes in the order of the file.
///
/// # Errors
/// [`MjcfError`], naming file, line, column and the body.
pub fn read(path: impl AsRef<Path>) -> Result<(Description, Vec<Note>), MjcfError> {
    let path = path.as_ref();
    assemble(&Source::read(path)?, &path.display().to_string())
}

/// Imports MJCF from a text, which includes no files; `file` is its name in errors.
///
/// ```
/// let text = r#"<mujoco model="pendulum"><worldbody><body name="arm">
///   <joint name="hinge" axis="0 1 0"/><inertial pos="0 0 -1" mass="2" diaginertia="0.1 0.1 0.01"/>
/// </body></worldbody></mujoco>"#;
/// let (robot, notes) = featherbench_formats::mjcf::import(text, "pendulum.xml")?;
/// assert_eq!((robot.nv(), robot.bodies[0].mass, notes.len()), (1, 2.0, 0));
/// # Ok::<(), featherbench_formats::mjcf::MjcfError>(())
/// ```
///
/// # Errors
/// [`MjcfError`], naming file, line, column and the body.
pub fn import(text: &str, file: &str) -> Result<(Description, Vec<Note>), MjcfError> {
    let text = text::check(text, LIMIT).map_err(|problem| MjcfError::new(file, None, problem))?;
    assemble(&Source::text(text, file), file)
}

/// The description of a text that has all its files.
fn assemble(source: &Source, file: &str) -> Result<(Description, Vec<Note>), MjcfError> {
    let read = || -> Result<_, At> {
        let document = parse(&source.text)?;
        let root = document.root_element();
        if !root.has_tag_name("mujoco") {
            return Err(MjcfProblem::NotMujoco { found: root.tag_name().name().to_owned() }.at(root.range().start));
        }
        tree::assemble(root, file)
    };
    let (description, notes) = read().map_err(|at| source.blame(at))?;
    Ok((description, notes.into_iter().map(|(offset, text)| source.note(offset, text)).collect()))
}

/// The document of a text.
fn parse(text: &str) -> Result<Document<'_>, At> {
    text::xml(text).map_err(|error| match error {
        roxmltree::Error::DtdDetected => MjcfProblem::DocumentType.at(text.find("<!DOCTYPE").unwrap_or(0)),
        other => {
            let (message, position) = text::of_parser(&other);
            At { offset: None, problem: MjcfProblem::Xml { message, position } }
        }
    })
}
