//! The cell: the unit of work.

use crate::{Identity, NoAnswer, Robot, hash};
use featherbench_results::canonical_json;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

/// One evaluation: an engine, its method, a quantity, a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// The study of the cell.
    pub study: String,
    /// The robot's name.
    pub robot: String,
    /// The robot's content hash.
    pub robot_hash: String,
    /// The other parameters of the work.
    pub params: Value,
    /// The engine's name.
    pub engine: String,
    /// The engine's version.
    pub version: String,
    /// The engine's method.
    pub method: String,
    /// The quantity.
    pub quantity: String,
    /// The arithmetic.
    pub scalar: String,
}

impl Cell {
    /// The cell in which an engine computes a quantity of a robot, in the arithmetic of the engine.
    pub fn new(study: &str, robot: &Robot, engine: &Identity, quantity: &str, method: impl Into<String>, params: impl Serialize) -> Self {
        Self {
            robot_hash: robot.hash.clone(),
            scalar: engine.scalar().into(),
            ..Self::of_case(study, &robot.name, (&engine.name, &engine.version), quantity, method, params)
        }
    }

    /// The cell of a case that is no robot of the suite, in `f64`. Its parameters are all there is to it, and their hash is its own. The engine
    /// is its name and its version.
    pub fn of_case(
        study: &str,
        case: &str,
        (engine, version): (&str, &str),
        quantity: &str,
        method: impl Into<String>,
        params: impl Serialize,
    ) -> Self {
        let params = json!(params);
        Self {
            study: study.into(),
            robot: case.into(),
            robot_hash: hash::of(canonical_json(&params).as_bytes()),
            params,
            engine: engine.into(),
            version: version.into(),
            method: method.into(),
            quantity: quantity.into(),
            scalar: "f64".into(),
        }
    }

    /// Its parameters as the type that its study plans it with.
    ///
    /// # Errors
    /// [`NoAnswer::Failed`] if they are of another study.
    pub fn params<P: DeserializeOwned>(&self) -> Result<P, NoAnswer> {
        P::deserialize(&self.params).map_err(|error| NoAnswer::Failed(format!("the parameters of this cell: {error}")))
    }

    /// The cell's id: a hash of everything in it.
    pub fn id(&self) -> String {
        let Self { study, robot, robot_hash, params, engine, version, method, quantity, scalar } = self;
        let content = json!([study, robot, robot_hash, params, engine, version, method, quantity, scalar]);
        hash::of(canonical_json(&content).as_bytes())[..16].to_owned()
    }

    /// The cell as a path of words: `--filter` matches it, and progress shows it.
    pub fn path(&self) -> String {
        format!("{}/{}/{}/{}/{}", self.study, self.robot, self.engine, self.quantity, self.method)
    }
}

/// The result of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The values, state after state.
    Values(Vec<f64>),
    /// A text that the cell's study can read.
    Text(String),
    /// No values, and why.
    NoAnswer(NoAnswer),
}

impl Outcome {
    /// The values, when there are any.
    pub fn values(&self) -> Option<&[f64]> {
        match self {
            Self::Values(values) => Some(values),
            Self::Text(_) | Self::NoAnswer(_) => None,
        }
    }

    /// The values, or why there are none; a text has none.
    pub fn answer(&self) -> Result<&[f64], NoAnswer> {
        match self {
            Self::Values(values) => Ok(values),
            Self::NoAnswer(refusal) => Err(refusal.clone()),
            Self::Text(_) => Err(NoAnswer::Failed("the outcome is a text, and numbers are due".into())),
        }
    }
}

impl From<Result<Vec<f64>, NoAnswer>> for Outcome {
    fn from(result: Result<Vec<f64>, NoAnswer>) -> Self {
        result.map_or_else(Self::NoAnswer, Self::Values)
    }
}

impl From<Result<String, NoAnswer>> for Outcome {
    fn from(result: Result<String, NoAnswer>) -> Self {
        result.map_or_else(Self::NoAnswer, Self::Text)
    }
}
