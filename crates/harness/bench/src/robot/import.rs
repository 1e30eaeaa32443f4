//! The result of a robot file's import by an engine's own parser.

use featherbench_formats::neutral;
use featherbench_model::Description;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The result of a file's import by an engine's own parser.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The engine's robot, canonical. It has no body if the engine holds no joint.
    pub description: Description,
    /// The parser's known edits.
    pub notes: Vec<ImportNote>,
    /// Configurations that the file names, in the description's coordinates; quaternions as the engine has them.
    pub keyframes: Vec<Vec<f64>>,
    /// The same robot with the file's own inertias, if the engine repaired them.
    pub written: Option<Description>,
}

/// The robot of a file of which one thing, or several, are read otherwise: a hypothesis about another parser.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportVariant {
    /// A word of `oracles/PROTOCOL.md`, such as `gravity_ignored`.
    pub cause: String,
    /// What is read otherwise, as the end of a sentence.
    pub text: String,
    /// The number of things that are read otherwise.
    pub edits: u64,
    /// The robot, canonical. It has no body if nothing moves.
    pub description: Description,
}

/// A file that a writer made of another one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rewritten {
    /// The writer.
    pub by: String,
    /// The file, or why there is none.
    pub file: Result<PathBuf, String>,
}

/// An edit by a parser, or an element that it did not import.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImportNote {
    /// A word of `oracles/PROTOCOL.md`, such as `mass_edited`.
    pub cause: String,
    /// The link, joint or element that it is about.
    pub about: Option<String>,
    /// What was done, one sentence.
    pub text: String,
    /// The numbers that `oracles/PROTOCOL.md` defines for the cause; empty if the engine gives none.
    pub numbers: Vec<f64>,
}

/// An import as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    notes: Vec<ImportNote>,
    /// The text of the description.
    description: String,
    /// That of the robot with the file's own inertias.
    written: Option<String>,
    keyframes: Vec<Vec<f64>>,
}

impl Import {
    /// The import as JSON.
    ///
    /// # Errors
    /// A sentence, when its description is no robot.
    pub fn to_text(&self) -> Result<String, String> {
        let written = self.written.as_ref().map(text).transpose()?;
        let (description, notes, keyframes) = (text(&self.description)?, self.notes.clone(), self.keyframes.clone());
        serde_json::to_string(&Written { notes, description, written, keyframes }).map_err(|error| error.to_string())
    }

    /// The import of a text by [`Import::to_text`].
    ///
    /// # Errors
    /// A sentence, when the text is no import.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let Written { notes, description, written, keyframes } = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let written = written.as_deref().map(parse).transpose()?;
        Ok(Self { description: parse(&description)?, notes, keyframes, written })
    }
}

impl ImportVariant {
    /// Variants as JSON: of each its cause, its text, the number of its edits and the text of its description.
    ///
    /// # Errors
    /// A sentence, when a description is no robot.
    pub fn to_text(variants: &[Self]) -> Result<String, String> {
        let listed: Vec<(&str, &str, u64, String)> = variants
            .iter()
            .map(|variant| Ok((&*variant.cause, &*variant.text, variant.edits, text(&variant.description)?)))
            .collect::<Result<_, String>>()?;
        serde_json::to_string(&listed).map_err(|error| error.to_string())
    }

    /// The variants of a text by [`ImportVariant::to_text`].
    ///
    /// # Errors
    /// A sentence, when the text is no list of variants.
    pub fn from_text(text: &str) -> Result<Vec<Self>, String> {
        let listed: Vec<(String, String, u64, String)> = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let variant = |(cause, text, edits, description): (String, String, u64, String)| {
            Ok(Self { cause, text, edits, description: parse(&description)? })
        };
        listed.into_iter().map(variant).collect()
    }
}

fn text(description: &Description) -> Result<String, String> {
    neutral::to_string(description).map_err(|error| error.to_string())
}

fn parse(text: &str) -> Result<Description, String> {
    neutral::parse(text, "an import").map_err(|error| error.to_string())
}
