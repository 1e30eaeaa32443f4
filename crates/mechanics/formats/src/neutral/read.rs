//! Reading: serde mirrors of the description; what does not fit them is an error.

use super::continua::ContinuumFields;
use super::fields::{BodyIndex, PlacementFields};
use super::loops::Tie;
use super::residuals::Entry;
use super::uncertain::Section;
use super::{FORMAT, LIMIT, NeutralError, NeutralProblem};
use crate::text;
use featherbench_model::{
    BodyDescription, Continuum, DescribedResidual, Description, Frame, JointDescription, JointType, Malformed, Provenance,
};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::error::Category;
use std::path::Path;

/// Reads a description file.
///
/// The description is valid (see [`Description::validate`]); it need not be canonical.
///
/// # Errors
/// [`NeutralError`], naming file, line, column and field.
pub fn read(path: impl AsRef<Path>) -> Result<Description, NeutralError> {
    let path = path.as_ref();
    let file = path.display().to_string();
    match text::read(path, LIMIT) {
        Ok(text) => parse(&text, &file),
        Err(error) => Err(NeutralError::new(file, None, error)),
    }
}

/// Reads a description from a text; `file` is its name in errors.
///
/// # Errors
/// [`NeutralError`], naming file, line, column and field.
pub fn parse(text: &str, file: &str) -> Result<Description, NeutralError> {
    let error = |position, problem: NeutralProblem| NeutralError::new(file, position, problem);
    let text = text::check(text, LIMIT).map_err(|problem| error(None, problem.into()))?;

    let mut deserializer = serde_json::Deserializer::from_str(text);
    let document: Document = serde_path_to_error::deserialize(&mut deserializer).map_err(|found| {
        // The version first: another version may have other fields.
        if let Some(format) = other_version(text) {
            return error(key_position(text, "format"), NeutralProblem::Version { found: format.to_string() });
        }
        let field = found.path().to_string();
        let (position, problem) = explain(field, &found.into_inner());
        error(position, problem)
    })?;
    deserializer.end().map_err(|found| {
        let (position, problem) = explain(".".to_owned(), &found);
        error(position, problem)
    })?;

    if document.format != FORMAT {
        return Err(error(key_position(text, "format"), NeutralProblem::Version { found: document.format.to_string() }));
    }
    if let Some(section) = document.unsupported() {
        return Err(error(key_position(text, section), NeutralProblem::UnsupportedSection { section }));
    }
    let description = document.describe();
    description.validate().map_err(|malformed| error(body_position(text, &malformed), malformed.into()))?;
    Ok(description)
}

/// The format of a text that is JSON of another version.
fn other_version(text: &str) -> Option<serde_json::Value> {
    let version: Version = serde_json::from_str(text).ok()?;
    version.format.filter(|format| format.as_u64() != Some(FORMAT))
}

/// Position and problem of a JSON error.
fn explain(field: String, error: &serde_json::Error) -> (Option<(usize, usize)>, NeutralProblem) {
    let (line, column) = (error.line(), error.column());
    let message = error.to_string();
    let message = message.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&message).to_owned();
    let problem = match error.classify() {
        Category::Data => NeutralProblem::Field { field, message },
        // A list of fixed length must end after its last item. So "trailing characters" inside the file mean one item too many.
        Category::Syntax if field != "." && message == "trailing characters" => {
            NeutralProblem::Field { field, message: "the list is longer than it should be".to_owned() }
        }
        Category::Io | Category::Syntax | Category::Eof => NeutralProblem::Syntax { field, message },
    };
    (Some((line, column)), problem)
}

/// The position of the first key of this name. In valid JSON a quoted word before a colon is a key: quotes inside strings are escaped.
fn key_position(text: &str, key: &str) -> Option<(usize, usize)> {
    let quoted = format!("\"{key}\"");
    let is_key = |place: usize| text[place + quoted.len()..].trim_start().starts_with(':');
    text.match_indices(&quoted).map(|(place, _)| place).find(|&place| is_key(place)).map(|place| text::position(text, place))
}

/// The position of the body of an error. A body's name is unique, but a joint or frame may have the same name: the position is only a help.
fn body_position(text: &str, malformed: &Malformed) -> Option<(usize, usize)> {
    let quoted = serde_json::Value::from(malformed.about()?).to_string();
    text.find(&quoted).map(|place| text::position(text, place))
}

#[derive(Deserialize)]
struct Version {
    format: Option<serde_json::Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
struct Document {
    format: u64,
    name: String,
    gravity: [f64; 3],
    bodies: Vec<Body>,
    #[serde(default)]
    frames: Vec<NamedFrame>,
    provenance: Option<Source>,
    #[serde(default)]
    loops: Vec<Tie>,
    #[serde(default)]
    continua: Vec<ContinuumFields>,
    #[serde(default)]
    residuals: Vec<Entry>,
    #[serde(default)]
    uncertain: Section,
    actuation: Option<IgnoredAny>,
    contacts: Option<IgnoredAny>,
}

/// A body as it is kept, so that a list of bodies is never held twice.
#[derive(Deserialize)]
#[serde(from = "BodyFields")]
struct Body(BodyDescription);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyFields {
    name: String,
    mass: f64,
    com: [f64; 3],
    inertia: [f64; 6],
    parent: BodyIndex,
    joint: Joint,
}

/// A joint whose axis and pitch fit its type.
#[derive(Deserialize)]
#[serde(try_from = "JointFields")]
struct Joint(JointDescription);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointFields {
    name: String,
    #[serde(rename = "type")]
    kind: String,
    axis: Option<[f64; 3]>,
    pitch: Option<f64>,
    placement: PlacementFields,
    #[serde(default)]
    armature: Vec<f64>,
    #[serde(default)]
    damping: Vec<f64>,
    #[serde(default)]
    friction: Vec<f64>,
    #[serde(default)]
    lower: Vec<f64>,
    #[serde(default)]
    upper: Vec<f64>,
    #[serde(default)]
    velocity: Vec<f64>,
    #[serde(default)]
    effort: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NamedFrame {
    name: String,
    body: BodyIndex,
    placement: PlacementFields,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Source {
    source: String,
    licence: String,
    header: String,
    readme: String,
    #[serde(default)]
    notes: Vec<String>,
}

impl Document {
    fn unsupported(&self) -> Option<&'static str> {
        let sections = [("actuation", &self.actuation), ("contacts", &self.contacts)];
        sections.into_iter().find(|(_, section)| section.is_some()).map(|(name, _)| name)
    }

    fn describe(self) -> Description {
        let frame = |frame: NamedFrame| Frame { name: frame.name, body: frame.body.0, placement: frame.placement.into() };
        let provenance = |source: Source| Provenance {
            source: source.source,
            licence: source.licence,
            header: source.header,
            readme: source.readme,
            notes: source.notes,
        };
        Description {
            name: self.name,
            gravity: self.gravity,
            bodies: self.bodies.into_iter().map(|body| body.0).collect(),
            frames: self.frames.into_iter().map(frame).collect(),
            loops: self.loops.into_iter().map(|tie| tie.0).collect(),
            continua: self.continua.into_iter().map(Continuum::from).collect(),
            residuals: self.residuals.into_iter().map(DescribedResidual::from).collect(),
            uncertain: self.uncertain.into(),
            provenance: self.provenance.map(provenance),
        }
    }
}

impl From<BodyFields> for Body {
    fn from(BodyFields { name, mass, com, inertia, parent, joint }: BodyFields) -> Self {
        Self(BodyDescription { name, parent: parent.0, mass, com, inertia, joint: joint.0 })
    }
}

impl TryFrom<JointFields> for Joint {
    type Error = String;
    fn try_from(fields: JointFields) -> Result<Self, String> {
        let JointFields { name, kind, axis, pitch, placement, armature, damping, friction, lower, upper, velocity, effort } = fields;
        let Some(described) = JointType::named(&kind, axis.unwrap_or_default(), pitch.unwrap_or_default()) else {
            return Err(format!("joint '{name}' has the unknown type '{kind}'; choose one of {}", JointType::names().join(", ")));
        };
        if pitch.is_none() && matches!(described, JointType::Helical { .. }) {
            return Err(format!("helical joint '{name}' has no 'pitch'; give metres per radian"));
        }
        if axis.is_none() && described.axis().is_some() {
            return Err(format!("{kind} joint '{name}' has no 'axis'; give a unit vector"));
        }
        if axis.is_some() && described.axis().is_none() {
            return Err(format!("{kind} joint '{name}' has an 'axis', which such a joint has not; remove it"));
        }
        // Other programs write a pitch of zero for every joint; that is not an error.
        if pitch.is_some_and(|pitch| pitch != 0.0) && !matches!(described, JointType::Helical { .. }) {
            return Err(format!("{kind} joint '{name}' has a 'pitch', which only a helical joint has; remove it"));
        }
        let placement = placement.into();
        Ok(Self(JointDescription { name, kind: described, placement, armature, damping, friction, lower, upper, velocity, effort }))
    }
}
