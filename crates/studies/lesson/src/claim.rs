//! A claim of the lesson, and the numbers that decide it.

use featherbench_constrained::{BadGraph, BadMechanism};
use featherbench_dynamics::{DimensionError, Error};
use featherbench_hybrid::HybridError;
use featherbench_model::Malformed;
use featherbench_spatial::largest;
use thiserror::Error as ThisError;

/// What of a claim is right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// All of it.
    Yes,
    /// Some cases of it, or some of its numbers.
    InPart,
    /// It is wrong.
    No,
    /// The lesson says nothing that gives a number: what is missing is added.
    Silent,
}

/// A statement of the lesson with its right form.
#[derive(Clone, Copy)]
pub struct Claim {
    /// Its name in rows.
    pub id: &'static str,
    /// Where it is in the lesson.
    pub place: &'static str,
    /// What it is about.
    pub title: &'static str,
    /// What the lesson says, in our words.
    pub says: &'static str,
    /// What is right.
    pub right: &'static str,
    /// What of it holds.
    pub holds: Holds,
    /// Computes its numbers, for the seed of what is drawn.
    pub numbers: fn(u64) -> Result<Vec<Number>, Failure>,
}

/// A number by the lesson's statement and by the right one, each with a second route.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// What it is.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// What the lesson's statement gives.
    pub lesson: Option<Stated>,
    /// The right value.
    pub corrected: f64,
    /// The right value by a second route.
    pub second: f64,
}

/// What the lesson's statement gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stated {
    /// Its value.
    pub value: f64,
    /// By how much it is off, by a route that does not form the value.
    pub off_by: f64,
}

impl Number {
    /// A right number with its second route, on which the lesson is silent.
    pub fn new(name: impl Into<String>, unit: &'static str, corrected: f64, second: f64) -> Self {
        Self { name: name.into(), unit, lesson: None, corrected, second }
    }

    /// The same number with what the lesson's statement gives, and by how much that is off.
    #[must_use]
    pub fn stated(self, value: f64, off_by: f64) -> Self {
        Self { lesson: Some(Stated { value, off_by }), ..self }
    }

    /// A count or a yes (1) and no (0).
    pub fn count(name: impl Into<String>, corrected: usize, second: usize) -> Self {
        Self::new(name, "1", corrected as f64, second as f64)
    }

    /// The larger magnitude of both right values; 1 where both are 0.
    fn scale(&self) -> f64 {
        let largest = largest([self.corrected, self.second]);
        if largest == 0.0 { 1.0 } else { largest }
    }

    /// How far the two routes to the right value are apart, relative to it.
    pub fn error(&self) -> f64 {
        (self.corrected - self.second).abs() / self.scale()
    }

    /// How far the lesson's value is from the right one.
    pub fn off_by(&self) -> Option<f64> {
        self.lesson.map(|lesson| lesson.value - self.corrected)
    }

    /// How far this separation is from its own second route, relative to the larger of the right value and the separation.
    pub fn separation_error(&self) -> Option<f64> {
        let (lesson, off_by) = (self.lesson?, self.off_by()?);
        let scale = if lesson.off_by.abs() > self.scale() { lesson.off_by.abs() } else { self.scale() };
        Some((off_by - lesson.off_by).abs() / scale)
    }

    /// Whether the lesson's value is right, to `1e-9` of the right one; `None` where the lesson is silent. NaN is not right.
    pub fn holds(&self) -> Option<bool> {
        self.off_by().map(|off_by| off_by.abs() <= 1e-9 * self.scale())
    }
}

/// Why a claim has no numbers. No default case gives one.
#[derive(Debug, ThisError)]
pub enum Failure {
    /// A robot with bad numbers.
    #[error(transparent)]
    Model(#[from] Malformed),
    /// Dynamics that have no answer.
    #[error(transparent)]
    Dynamics(#[from] Error),
    /// A list of another length.
    #[error(transparent)]
    Dimension(#[from] DimensionError),
    /// A hybrid system's run or event.
    #[error(transparent)]
    Hybrid(#[from] HybridError),
    /// A graph that is no robot.
    #[error(transparent)]
    Graph(#[from] BadGraph),
    /// A mechanism that is none.
    #[error(transparent)]
    Mechanism(#[from] BadMechanism),
    /// An expression without a value.
    #[error(transparent)]
    Algebra(#[from] crate::AlgebraError),
    /// Anything else, with what to do.
    #[error("{0}")]
    Other(String),
}

impl Failure {
    /// A failure of anything that can be told.
    pub fn of(cause: impl std::fmt::Display) -> Self {
        Self::Other(cause.to_string())
    }
}
