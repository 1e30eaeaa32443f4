//! The result of a robot file's import by an engine's own parser.

use featherbench_formats::neutral;
use featherbench_model::Description;
use serde::{Deserialize, Serialize};

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
    /// What the file would be to a parser that reads one thing of it otherwise, by the engine that is the reference of its format.
    pub variants: Vec<ImportVariant>,
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
    /// Of each variant its cause, its text and the text of its description.
    #[serde(default)]
    variants: Vec<(String, String, u64, String)>,
}

impl Import {
    /// The import as JSON.
    ///
    /// # Errors
    /// A sentence, when its description is no robot.
    pub fn to_text(&self) -> Result<String, String> {
        let text = |description: &Description| neutral::to_string(description).map_err(|error| error.to_string());
        let written = self.written.as_ref().map(text).transpose()?;
        let (description, notes, keyframes) = (text(&self.description)?, self.notes.clone(), self.keyframes.clone());
        let variant =
            |variant: &ImportVariant| Ok((variant.cause.clone(), variant.text.clone(), variant.edits, text(&variant.description)?));
        let variants = self.variants.iter().map(variant).collect::<Result<_, String>>()?;
        serde_json::to_string(&Written { notes, description, written, keyframes, variants }).map_err(|error| error.to_string())
    }

    /// The import of a text by [`Import::to_text`].
    ///
    /// # Errors
    /// A sentence, when the text is no import.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let Written { notes, description, written, keyframes, variants } = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let parse = |text: &str| neutral::parse(text, "an import").map_err(|error| error.to_string());
        let written = written.as_deref().map(parse).transpose()?;
        let variant = |(cause, text, edits, description): (String, String, u64, String)| {
            Ok(ImportVariant { cause, text, edits, description: parse(&description)? })
        };
        let variants = variants.into_iter().map(variant).collect::<Result<_, String>>()?;
        Ok(Self { description: parse(&description)?, notes, keyframes, written, variants })
    }
}
