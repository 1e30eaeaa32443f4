//! The file of a contact problem: JSON, `"schema": 1`.
//!
//! ```json
//! {"schema": 1, "name": "point", "level": "impulse",
//!  "contacts": [{"name": "tip", "friction": {"coulomb": [0.5]}, "restitution": 0.0}],
//!  "delassus": [[0.5, 0.0], [0.0, 0.5]],
//!  "free": [-3.0, 1.0]}
//! ```
//!
//! | field | meaning |
//! |---|---|
//! | `schema` | 1 |
//! | `name` | a name |
//! | `level` | `impulse` (N·s and m/s) or `force` (N and m/s²) |
//! | `contacts` | the contacts in the order of their rows; `friction` is `"none"` (also if it is left out), `{"coulomb": [μ]}`, `{"coulomb": [μ1, μ2]}`, `{"pyramid": [[x, y], …]}` or `{"sliding": {"coefficient": μ, "direction": [d…]}}`; `restitution` is 0 if it is left out |
//! | `delassus`, `free` | G by rows and b; or instead |
//! | `mechanism` | `mass` by rows, `jacobian` by rows, and the generalized velocity `free` |
//! | `before` | contact velocities before the impact; the free velocity if it is left out |
//!
//! A contact has the rows normal, then tangents: 1, 2 or 3. Any other key is an error. Numbers are written as the shortest decimal that
//! reads back to the same bits. NaN cannot be written in JSON.

mod locate;

use crate::malformed::{Defect, Malformed};
use crate::problem::{Contact, Friction, Level, Mechanism, Problem};
use nalgebra::{DMatrix, DVector};
use serde::Deserialize;
use std::fmt;
use std::fmt::Write as _;
use std::io::{Read, Write as _};
use std::path::Path;
use thiserror::Error;

/// The schema's version that this crate reads and writes.
pub const SCHEMA: u64 = 1;
/// The largest file that is read, in bytes: a dense matrix of 1500 rows.
pub const LIMIT: usize = 1 << 26;

/// A file that is not a contact problem: the place, and why.
#[derive(Debug)]
pub struct FileError {
    /// The file as the caller named it.
    pub file: String,
    /// Line and column counted from 1, where they are known.
    pub position: Option<(usize, usize)>,
    /// What is wrong.
    pub problem: FileProblem,
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Some((line, column)) => write!(f, "{}:{line}:{column}: {}", self.file, self.problem),
            None => write!(f, "{}: {}", self.file, self.problem),
        }
    }
}

impl std::error::Error for FileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.problem.source()
    }
}

/// What is wrong with a file.
#[derive(Debug, Error)]
pub enum FileProblem {
    /// The file cannot be opened, read or written.
    #[error("the file cannot be used: {0}")]
    Io(#[from] std::io::Error),
    /// The file is too large.
    #[error("the file is larger than {LIMIT} bytes")]
    TooBig,
    /// The file is not UTF-8.
    #[error("the file is not UTF-8 text (byte {byte} is no part of a character)")]
    NotText {
        /// The first bad byte, counted from 0.
        byte: usize,
    },
    /// The text is not JSON, or a field is missing, unknown or of a wrong type.
    #[error("field '{field}': {message}")]
    Field {
        /// The path to the field; `.` for the whole file.
        field: String,
        /// What the reader expected.
        message: String,
    },
    /// Another version of the schema.
    #[error("schema {found} is not known; this version reads \"schema\": 1")]
    Schema {
        /// The version in the file.
        found: u64,
    },
    /// Neither or both of `delassus` and `mechanism`.
    #[error("give either 'delassus' and 'free', or 'mechanism'; {found}")]
    Data {
        /// What is there.
        found: &'static str,
    },
    /// The numbers are not a contact problem.
    #[error(transparent)]
    Malformed(#[from] Malformed),
}

/// Reads a problem from a file.
///
/// # Errors
/// [`FileError`], naming file, line, column and field.
pub fn read(path: impl AsRef<Path>) -> Result<Problem, FileError> {
    let path = path.as_ref();
    let error = |problem| FileError { file: path.display().to_string(), position: None, problem };
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(|io| error(io.into()))?;
    // One byte more than allowed shows that the file is too long.
    file.take(LIMIT as u64 + 1).read_to_end(&mut bytes).map_err(|io| error(io.into()))?;
    if bytes.len() > LIMIT {
        return Err(error(FileProblem::TooBig));
    }
    let text = String::from_utf8(bytes).map_err(|found| error(FileProblem::NotText { byte: found.utf8_error().valid_up_to() }))?;
    parse(&text, &path.display().to_string())
}

/// Reads a problem from a text; `file` is its name in errors.
///
/// ```
/// let text = r#"{"schema": 1, "name": "point", "level": "impulse",
///  "contacts": [{"name": "tip", "friction": {"coulomb": [-0.5]}}],
///  "delassus": [[0.5, 0.0], [0.0, 0.5]], "free": [-3.0, 1.0]}"#;
/// let error = featherbench_contact::file::parse(text, "point.json").unwrap_err();
/// let said = "point.json:2:56: field 'contacts[0].friction.coulomb[0]': the coefficient of friction is -0.5; it is at least 0";
/// assert_eq!(error.to_string(), said);
/// ```
///
/// # Errors
/// [`FileError`], naming file, line, column and field.
pub fn parse(text: &str, file: &str) -> Result<Problem, FileError> {
    let error = |position, problem| FileError { file: file.to_owned(), position, problem };
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let document: Document = serde_path_to_error::deserialize(&mut deserializer).map_err(|found| {
        // The version first: another version may have other fields.
        if let Some(found) = serde_json::from_str::<Version>(text).ok().map(|v| v.schema).filter(|schema| *schema != SCHEMA) {
            return error(locate::position_of(text, "schema"), FileProblem::Schema { found });
        }
        let field = found.path().to_string();
        let (position, message) = said(&found.into_inner());
        error(Some(position), FileProblem::Field { field, message })
    })?;
    deserializer.end().map_err(|found| {
        let (position, message) = said(&found);
        error(Some(position), FileProblem::Field { field: ".".to_owned(), message })
    })?;
    if document.schema != SCHEMA {
        return Err(error(locate::position_of(text, "schema"), FileProblem::Schema { found: document.schema }));
    }
    document.problem().map_err(|problem| {
        let field = if let FileProblem::Malformed(malformed) = &problem { malformed.field.as_str() } else { "." };
        error(locate::position_of(text, field), problem)
    })
}

/// Line and column of a JSON error, and its message without them.
fn said(error: &serde_json::Error) -> ((usize, usize), String) {
    let (line, column) = (error.line(), error.column());
    let message = error.to_string();
    let message = message.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&message).to_owned();
    ((line, column), message)
}

/// Writes a problem to a file, completely or not at all.
///
/// # Errors
/// [`FileError`] if the file cannot be written.
pub fn write(problem: &Problem, path: impl AsRef<Path>) -> Result<(), FileError> {
    let path = path.as_ref();
    let error = |io| FileError { file: path.display().to_string(), position: None, problem: FileProblem::Io(io) };
    let name = path.file_name().ok_or_else(|| error(std::io::Error::new(std::io::ErrorKind::InvalidInput, "this is no file name")))?;
    let neighbour = path.with_file_name(format!(".{}.{}.part", name.to_string_lossy(), std::process::id()));
    let written = std::fs::File::create(&neighbour)
        .and_then(|mut file| file.write_all(to_text(problem).as_bytes()).and_then(|()| file.sync_all()))
        .and_then(|()| std::fs::rename(&neighbour, path));
    if written.is_err() {
        // Only the first error is reported.
        let _ = std::fs::remove_file(&neighbour);
    }
    written.map_err(error)
}

/// The text of a problem's file. Reading it gives the same problem.
pub fn to_text(problem: &Problem) -> String {
    // Numbers, names and lists of them always have a JSON text.
    let json = |value: serde_json::Value| value.to_string();
    let mut text = String::from("{\n");
    let level = match problem.level() {
        Level::Impulse => "impulse",
        Level::Force => "force",
    };
    let name = json(problem.name().into());
    let _ = writeln!(text, " \"schema\": {SCHEMA},\n \"name\": {name},\n \"level\": \"{level}\",\n \"contacts\": [");
    for (index, contact) in problem.contacts().iter().enumerate() {
        let comma = if index + 1 < problem.contacts().len() { "," } else { "" };
        let (name, friction) = (json(contact.name.as_str().into()), json(friction_value(&contact.friction)));
        let restitution = json(contact.restitution.into());
        let _ = writeln!(text, "  {{\"name\": {name}, \"friction\": {friction}, \"restitution\": {restitution}}}{comma}");
    }
    text.push_str(" ],\n");
    let list = |vector: &DVector<f64>| json(vector.as_slice().into());
    if problem.before() != problem.free() {
        let _ = writeln!(text, " \"before\": {},", list(problem.before()));
    }
    match problem.mechanism() {
        Some(mechanism) => {
            let (mass, jacobian) = (rows(&mechanism.mass), rows(&mechanism.jacobian));
            let free = list(&mechanism.free);
            let _ = writeln!(text, " \"mechanism\": {{\n  \"mass\": {mass},\n  \"jacobian\": {jacobian},\n  \"free\": {free}\n }}");
        }
        None => {
            let _ = writeln!(text, " \"delassus\": {},\n \"free\": {}", rows(problem.delassus()), list(problem.free()));
        }
    }
    text.push_str("}\n");
    text
}

/// A matrix, one row per line.
fn rows(matrix: &DMatrix<f64>) -> String {
    let row = |row: usize| serde_json::Value::from(matrix.row(row).iter().copied().collect::<Vec<f64>>()).to_string();
    format!("[{}]", (0..matrix.nrows()).map(row).collect::<Vec<_>>().join(",\n   "))
}

fn friction_value(friction: &Friction) -> serde_json::Value {
    match friction {
        Friction::None => "none".into(),
        Friction::Coulomb { coefficients } => serde_json::json!({ "coulomb": coefficients }),
        Friction::Pyramid { vertices } => serde_json::json!({ "pyramid": vertices }),
        Friction::Sliding { coefficient, direction } => {
            serde_json::json!({ "sliding": { "coefficient": coefficient, "direction": direction } })
        }
    }
}

#[derive(Deserialize)]
struct Version {
    schema: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    schema: u64,
    name: String,
    level: Level,
    contacts: Vec<ContactFields>,
    delassus: Option<Vec<Vec<f64>>>,
    free: Option<Vec<f64>>,
    mechanism: Option<MechanismFields>,
    before: Option<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ContactFields {
    name: String,
    #[serde(default)]
    friction: FrictionFields,
    #[serde(default)]
    restitution: f64,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum FrictionFields {
    #[default]
    None,
    Coulomb(Vec<f64>),
    Pyramid(Vec<[f64; 2]>),
    Sliding {
        coefficient: f64,
        direction: Vec<f64>,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MechanismFields {
    mass: Vec<Vec<f64>>,
    jacobian: Vec<Vec<f64>>,
    free: Vec<f64>,
}

impl Document {
    fn problem(self) -> Result<Problem, FileProblem> {
        let contacts = self.contacts.into_iter().map(Contact::from).collect();
        let problem = match (self.delassus, self.free, self.mechanism) {
            (Some(delassus), Some(free), None) => {
                let (delassus, free) = (matrix(&delassus, "delassus")?, DVector::from_vec(free));
                Problem::from_delassus(self.name, self.level, contacts, delassus, free)?
            }
            (None, None, Some(fields)) => {
                let (mass, jacobian) = (matrix(&fields.mass, "mechanism.mass")?, matrix(&fields.jacobian, "mechanism.jacobian")?);
                let mechanism = Mechanism { mass, jacobian, free: DVector::from_vec(fields.free) };
                Problem::from_mechanism(self.name, self.level, contacts, mechanism)?
            }
            (None, None, None) => return Err(FileProblem::Data { found: "there is neither" }),
            (Some(_), None, None) => return Err(FileProblem::Data { found: "'free' is missing" }),
            (None, Some(_), None) => return Err(FileProblem::Data { found: "'delassus' is missing" }),
            (_, _, Some(_)) => return Err(FileProblem::Data { found: "there are parts of both" }),
        };
        Ok(match self.before {
            Some(before) => problem.with_before(DVector::from_vec(before))?,
            None => problem,
        })
    }
}

/// A matrix of rows of equal length.
fn matrix(rows: &[Vec<f64>], field: &str) -> Result<DMatrix<f64>, Malformed> {
    let columns = rows.first().map_or(0, Vec::len);
    if let Some((index, row)) = rows.iter().enumerate().find(|(_, row)| row.len() != columns) {
        return Err(Malformed::new(format!("{field}[{index}]"), Defect::Size { found: row.len(), expected: columns }));
    }
    Ok(DMatrix::from_fn(rows.len(), columns, |row, column| rows[row][column]))
}

impl From<ContactFields> for Contact {
    fn from(fields: ContactFields) -> Self {
        let friction = match fields.friction {
            FrictionFields::None => Friction::None,
            FrictionFields::Coulomb(coefficients) => Friction::Coulomb { coefficients },
            FrictionFields::Pyramid(vertices) => Friction::Pyramid { vertices },
            FrictionFields::Sliding { coefficient, direction } => Friction::Sliding { coefficient, direction },
        };
        Self { name: fields.name, friction, restitution: fields.restitution }
    }
}
