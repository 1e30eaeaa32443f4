//! The catalogue of the failures of runs, as data: a line for each known deviation of each engine, and for each failure that is none.

use super::finding::Fault;
use featherbench_results::{CHECKSUMS_NAME, Checksums, ResultsError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The folder of the catalogue in a run's folder.
pub const CATALOGUE: &str = "catalogue";

/// The catalogue as data, in its folder.
pub const CATALOGUE_NAME: &str = "catalogue.json";

/// The catalogue of one run or several: `catalogue.json`.
///
/// ```
/// use featherbench_reduction::{Catalogue, Line, Status};
///
/// let line = Line {
///     name: "dart-zyx-aba".into(),
///     engine: "dart".into(),
///     class: "zyx-aba".into(),
///     reason: "Euler angles near a pitch of 90°".into(),
///     reproduction: None,
///     status: Status::None { why: "no row shows it".into() },
/// };
/// let catalogue = Catalogue { runs: vec!["a".into()], lines: vec![line] };
/// let text = serde_json::to_string(&catalogue).unwrap();
/// assert_eq!(serde_json::from_str::<Catalogue>(&text).unwrap(), catalogue);
/// assert!(text.contains(r#""status":"none""#));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Catalogue {
    /// The runs, by name.
    pub runs: Vec<String>,
    /// Its lines: engine after engine, known deviations first.
    pub lines: Vec<Line>,
}

/// A known deviation, or a failure that is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Its name, unique in the catalogue; the folder of its case, if it has one.
    pub name: String,
    /// The engine.
    pub engine: String,
    /// The id of the known deviation, or quantity and method.
    pub class: String,
    /// The cause, as far as it is known.
    pub reason: String,
    /// The reproduction that shows the cause alone, by name.
    pub reproduction: Option<String>,
    /// What shows it here.
    #[serde(flatten)]
    pub status: Status,
}

/// What shows a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum Status {
    /// A reduced case.
    Reduced(Box<Reduction>),
    /// No reduced case.
    None {
        /// Why not.
        why: String,
    },
}

/// A reduced case: where it comes from, and what it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reduction {
    /// The run that shows it.
    pub run: String,
    /// The robot that it was reduced from.
    pub robot: String,
    /// The cell.
    pub cell: String,
    /// The quantity.
    pub quantity: String,
    /// The engine's method.
    pub method: String,
    /// The measure; empty where there is no answer.
    pub metric: String,
    /// The bodies of the robot.
    pub bodies: usize,
    /// Its error; `None` where there is no number.
    pub error: Option<f64>,
    /// The bodies of the reduced robot.
    pub reduced_bodies: usize,
    /// Its joints, counted by kind.
    pub joints: BTreeMap<String, usize>,
    /// Its error; `None` where there is no number.
    pub reduced_error: Option<f64>,
    /// Why there is no number.
    pub without: Option<String>,
    /// The steps that were tried.
    pub tried: usize,
    /// The files in the folder of the case.
    pub files: Vec<String>,
}

impl Catalogue {
    /// The catalogue as a table in Markdown.
    pub fn readme(&self) -> String {
        let mut text = format!(
            "# Catalogue of failures: {}\n\nA line for each known deviation of each engine, and for each method that fails or has an error above rounding. A case is \
         the smallest robot and state that still show it, with at least {} of its error, by the measure of its study.\n\n\
         | engine | what | run | robot | bodies | error | bodies, reduced | error, reduced | reproduction |\n|---|---|---|---|---|---|---|---|---|\n",
            self.runs.join(", "),
            crate::KEEP
        );
        for Line { name, engine, class, reproduction, status, .. } in &self.lines {
            let reproduction = reproduction.as_deref().unwrap_or("–");
            text += &match status {
                Status::Reduced(case) => format!(
                    "| {engine} | [{class}]({name}/README.md) | {} | {} | {} | {} | {} | {} | {reproduction} |\n",
                    case.run,
                    case.robot,
                    case.bodies,
                    told(case.error),
                    case.reduced_bodies,
                    told(case.reduced_error)
                ),
                Status::None { why } => format!("| {engine} | {class} | no case: {why} | | | | | | {reproduction} |\n"),
            };
        }
        text
    }

    /// Reads the catalogue in a folder, which of a run is [`CATALOGUE`]; `None` if there is none.
    ///
    /// # Errors
    /// [`ResultsError`], naming the file.
    pub fn read(folder: &Path) -> Result<Option<Self>, ResultsError> {
        let path = folder.join(CATALOGUE_NAME);
        if !path.exists() {
            return Ok(None);
        }
        // An older version wrote none.
        let bytes = if folder.join(CHECKSUMS_NAME).is_file() {
            Checksums::read(folder)?.bytes(CATALOGUE_NAME)?
        } else {
            std::fs::read(&path).map_err(|source| ResultsError::Io { path: path.clone(), source })?
        };
        serde_json::from_slice(&bytes).map(Some).map_err(|source| ResultsError::Json { path, source })
    }

    /// The catalogue with new lines in the place of those of the same names; other new lines come last.
    pub fn renewed(mut self, lines: Vec<Line>) -> Self {
        for line in lines {
            match self.lines.iter_mut().find(|known| known.name == line.name) {
                Some(known) => *known = line,
                None => self.lines.push(line),
            }
        }
        self
    }
}

/// An error in two digits, or that there is none.
pub fn told(error: Option<f64>) -> String {
    error.map_or_else(|| "no number".to_owned(), |error| format!("{error:.1e}"))
}

impl Line {
    /// The reduced case.
    pub fn reduction(&self) -> Option<&Reduction> {
        match &self.status {
            Status::Reduced(reduction) => Some(reduction),
            Status::None { .. } => None,
        }
    }
}

impl Fault {
    /// The word for it in the name of a line: nothing for errors above rounding, which the first catalogues had alone.
    pub(crate) fn suffix(&self) -> &'static str {
        match self {
            Self::Known(_) | Self::Above(_) => "",
            Self::Unknown => "-fails",
        }
    }
}
