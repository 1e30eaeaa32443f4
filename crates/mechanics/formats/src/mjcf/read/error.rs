//! What can be wrong with an MJCF file.

use crate::{FileError, TextError, text};
use featherbench_model::Malformed;
use thiserror::Error;

/// An MJCF file that cannot be imported: the place, and why.
pub type MjcfError = FileError<MjcfProblem>;

/// What is wrong with an MJCF file.
#[derive(Debug, Error)]
pub enum MjcfProblem {
    /// The file is not text.
    #[error("the file {0}")]
    Text(#[from] TextError),
    /// The text is not XML.
    #[error("this is not well-formed XML: {message}")]
    Xml {
        /// What the parser found.
        message: String,
        /// Line and column.
        position: (usize, usize),
    },
    /// A document type declaration.
    #[error("the file declares a document type; entities are not expanded, remove the <!DOCTYPE …>")]
    DocumentType,
    /// The root element has another name.
    #[error("the root element is <{found}>, not <mujoco>; is this an MJCF file?")]
    NotMujoco {
        /// The element found.
        found: String,
    },
    /// Something that only MuJoCo's compiler makes bodies of.
    #[error("{what} is not read here; `featherbench gen mjcf` reads the file by MuJoCo's compiler and writes a description")]
    NotRead {
        /// The element or attribute.
        what: String,
    },
    /// An included file that cannot be read.
    #[error("the included file {file} {why}")]
    Include {
        /// The file.
        file: String,
        /// Why.
        why: TextError,
    },
    /// A file that is included already, or includes itself.
    #[error("{file} is included already; MuJoCo refuses it too")]
    IncludedTwice {
        /// The file, as the include names it.
        file: String,
    },
    /// A file whose root has nothing in it.
    #[error("this file is included, and its root has no elements")]
    IncludesNothing,
    /// An include with elements of its own.
    #[error("<include> has elements of its own; write it as <include file=\"…\"/>")]
    IncludeWithContent,
    /// An element lacks an attribute.
    #[error("<{element}> of {owner} has no attribute '{attribute}'")]
    MissingAttribute {
        /// The element.
        element: String,
        /// The body.
        owner: String,
        /// The attribute.
        attribute: &'static str,
    },
    /// An attribute is not the numbers that are expected.
    #[error("{attribute}=\"{value}\" of {owner} is not {expected}")]
    NotNumbers {
        /// The body or element.
        owner: String,
        /// The attribute.
        attribute: String,
        /// Its value.
        value: String,
        /// What is expected.
        expected: String,
    },
    /// A number is NaN or infinite.
    #[error("{attribute}=\"{value}\" of {owner} is not finite")]
    NotFinite {
        /// The body or element.
        owner: String,
        /// The attribute.
        attribute: String,
        /// Its value.
        value: String,
    },
    /// A word that MJCF does not have there.
    #[error("{attribute}=\"{value}\" of {owner} is unknown; one of {expected} is expected")]
    UnknownWord {
        /// The body or element.
        owner: String,
        /// The attribute.
        attribute: String,
        /// Its value.
        value: String,
        /// The words.
        expected: &'static str,
    },
    /// A class without a default.
    #[error("{owner} is of class '{class}', which no <default> has")]
    UnknownClass {
        /// The body or element.
        owner: String,
        /// The class.
        class: String,
    },
    /// Vectors that give no orientation.
    #[error("{attribute}=\"{value}\" of {owner} gives no orientation: a vector has no length, or two are parallel")]
    NoOrientation {
        /// The body or element.
        owner: String,
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        value: String,
    },
    /// A free joint below another body, or beside another joint.
    #[error("{owner} has a free joint {found}; it must be the only joint of a body of the world")]
    FreeBelow {
        /// The body.
        owner: String,
        /// Where it stands.
        found: &'static str,
    },
    /// Two joints have one name.
    #[error("{owner} has a joint '{name}', as another body has; rename one")]
    RepeatedJoint {
        /// The second body.
        owner: String,
        /// The name.
        name: String,
    },
    /// A body with joints has no mass.
    #[error("{owner} moves and has no mass; MuJoCo refuses it too: give it an <inertial>, or shapes with mass")]
    Massless {
        /// The body.
        owner: String,
    },
    /// The description that the file makes is malformed.
    #[error("{0}")]
    Malformed(#[from] Malformed),
}

/// A problem and the byte offset that it is about.
pub(super) struct At {
    pub offset: Option<usize>,
    pub problem: MjcfProblem,
}

impl MjcfProblem {
    /// This problem at a byte offset.
    pub(super) fn at(self, offset: usize) -> At {
        At { offset: Some(offset), problem: self }
    }
}

impl At {
    /// An error of this text; `name` is its file.
    pub(super) fn in_text(self, name: &str, text: &str) -> MjcfError {
        let of_parser = if let MjcfProblem::Xml { position, .. } = &self.problem { Some(*position) } else { None };
        let position = self.offset.map(|offset| text::position(text, offset)).or(of_parser);
        MjcfError::new(name, position, self.problem)
    }
}
