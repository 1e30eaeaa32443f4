//! A robot as one can draw it: its bodies in the world at the neutral configuration.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::ResultsError;

/// Name of the file of drawings in a run's folder.
///
/// It is a file of its own: programs that read `run.json` again and again (gates, history) do not read drawings.
pub const DRAWINGS_NAME: &str = "drawings.json";

/// A body of a drawing. Lengths are in m, in world axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnBody {
    /// Its name.
    pub name: String,
    /// The index of the body that it is on; the world, if there is none.
    pub parent: Option<usize>,
    /// Its mass, in kg.
    pub mass: f64,
    /// The origin of its frame.
    pub origin: [f64; 3],
    /// Its centre of mass.
    pub centre: [f64; 3],
    /// The half axes of the solid ellipsoid with its mass and inertia; of length zero if no body can have these.
    pub axes: [[f64; 3]; 3],
}

/// The bodies of a robot; a body comes after the one that it is on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Drawing(pub Vec<DrawnBody>);

impl Drawing {
    /// A robot with more bodies is not drawn: the bodies could not be told apart.
    pub const MOST_BODIES: usize = 200;
    /// A run keeps no more bytes of drawings: a sweep may have thousands of robots.
    pub const MOST_BYTES: usize = 2_000_000;

    /// Whether every number is finite: JSON has no others.
    ///
    /// ```
    /// use featherbench_results::{Drawing, DrawnBody};
    ///
    /// let ball = DrawnBody { name: "ball".into(), parent: None, mass: 1.0, origin: [0.0; 3], centre: [0.0; 3], axes: [[0.0; 3]; 3] };
    /// assert!(Drawing(vec![ball.clone()]).is_finite());
    /// assert!(!Drawing(vec![DrawnBody { mass: f64::NAN, ..ball }]).is_finite());
    /// ```
    pub fn is_finite(&self) -> bool {
        let places = |body: &DrawnBody| body.axes.iter().chain([&body.origin, &body.centre]).flatten().all(|x| x.is_finite());
        self.0.iter().all(|body| body.mass.is_finite() && places(body))
    }
}

/// The drawings as the text of their file: a robot a line. `path` is its name in errors.
///
/// # Errors
/// [`ResultsError::NonFinite`]: a number is not finite, which JSON cannot say.
pub fn drawings_to_text(drawings: &BTreeMap<String, Drawing>, path: &Path) -> Result<String, ResultsError> {
    if let Some((name, _)) = drawings.iter().find(|(_, drawing)| !drawing.is_finite()) {
        return Err(ResultsError::NonFinite { path: path.to_owned(), field: format!("the drawing of {name}"), value: f64::NAN });
    }
    let json = |source| ResultsError::Json { path: path.to_owned(), source };
    let line = |(name, drawing): (&String, &Drawing)| Ok(format!("{}:{}", serde_json::to_string(name)?, serde_json::to_string(drawing)?));
    let lines: Vec<String> = drawings.iter().map(line).collect::<Result<_, _>>().map_err(json)?;
    Ok(format!("{{\n{}\n}}\n", lines.join(",\n")))
}

/// The drawings of such a text, by robot; `path` is its name in errors.
///
/// ```
/// use featherbench_results::{drawings_to_text, parse_drawings};
///
/// let path = std::path::Path::new("drawings.json");
/// let text = r#"{"ball":[{"name":"b","parent":null,"mass":1.0,"origin":[0,0,0],"centre":[0,0,0],"axes":[[0,0,0],[0,0,0],[0,0,0]]}]}"#;
/// let drawings = parse_drawings(text, path).unwrap();
/// assert_eq!(drawings["ball"].0[0].mass, 1.0);
/// assert_eq!(parse_drawings(&drawings_to_text(&drawings, path).unwrap(), path).unwrap(), drawings);
/// ```
///
/// # Errors
/// [`ResultsError::Json`] names the line and the column.
pub fn parse_drawings(text: &str, path: &Path) -> Result<BTreeMap<String, Drawing>, ResultsError> {
    serde_json::from_str(text).map_err(|source| ResultsError::Json { path: path.to_owned(), source })
}
