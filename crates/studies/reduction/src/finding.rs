//! A failure: what a row says is wrong with a robot, in a form that can be asked again of a simpler robot.
//!
//! The study of the row compares the simpler robot too, and its gates judge. So a reduced case has the measure, the bound and the known
//! deviation of the row. The truth is the reference where the study takes our answers ([`Agreement`]).

use featherbench_bench::truth::TruthModel;
use featherbench_bench::{Cell, Context, Engine, Finished, Gates, Identity, NoAnswer, OWN, Outcome, Quantity, Robot, Study, cause};
use featherbench_comparison::{Accuracy, Agreement, Derivatives};
use featherbench_results::{EngineSource, ModelOrigin, Row, Verdict};
use featherbench_robots::Case as StateCase;
use featherbench_study::answer;
use serde_json::json;
use std::collections::BTreeMap;

/// Measures of the agreement study that take more than one answer of engines, or none.
pub(super) const OF_SEVERAL: [&str; 3] = ["pairwise", "scaled_on_readback", "kappa_scaled"];

/// What is wrong with an answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// The known deviation of this id.
    Known(String),
    /// It fails its gate, or is no number, for no known cause.
    Unknown,
    /// Its error is above this.
    Above(f64),
}

/// What a row says of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The study, by name.
    pub study: String,
    /// The quantity.
    pub quantity: Quantity,
    /// The engine's method.
    pub method: String,
    /// The measure; empty where there is no answer.
    pub metric: String,
    /// The states among which it was found; `None` stands for all.
    pub states: Option<StateCase>,
    /// What is wrong.
    pub fault: Fault,
}

/// How an answer is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// By a number.
    Number,
    /// There is no answer.
    NoAnswer,
    /// The answer has a NaN or an infinity.
    NotFinite,
    /// The answer has numbers, and the measure is none.
    NoMeasure,
}

impl Kind {
    /// Why there is no number, in words; `None` if there is one.
    pub fn told(self) -> Option<&'static str> {
        match self {
            Self::Number => None,
            Self::NoAnswer => Some("there is no answer"),
            Self::NotFinite => Some("the answer has a NaN or an infinity"),
            Self::NoMeasure => Some("the measure is no number: the true answer is zero, or there is none"),
        }
    }
}

/// A failure on one robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The measure; one where there is none.
    pub severity: f64,
    /// How the answer is wrong.
    pub kind: Kind,
}

impl Failure {
    /// What a row with a fault says; `None` if it has no fault, or if its study asks for more than a robot at a state.
    ///
    /// ```
    /// use featherbench_results::{Row, Verdict};
    /// use featherbench_reduction::{Fault, Failure};
    ///
    /// let row = Row { study: "agreement".into(), quantity: "fd".into(), verdict: Verdict::Fail, ..Row::default() };
    /// assert_eq!(Failure::of(&row).unwrap().fault, Fault::Unknown);
    /// assert_eq!(Failure::of(&Row { verdict: Verdict::Pass, ..row }), None);
    /// ```
    pub fn of(row: &Row) -> Option<Self> {
        let fault = match row.verdict {
            Verdict::Deviation => Fault::Known(cause(row)?),
            Verdict::Fail | Verdict::Error => Fault::Unknown,
            Verdict::Pass | Verdict::Info | Verdict::Skip => return None,
        };
        Self::with(row, fault)
    }

    /// The same of any row, with this fault.
    pub fn with(row: &Row, fault: Fault) -> Option<Self> {
        let known = study(&row.study).is_some() && !OF_SEVERAL.contains(&row.metric.as_str());
        // A reduced state has no wrenches on bodies.
        let quantity = Quantity::parse(&row.quantity).filter(|quantity| known && *quantity != Quantity::InverseDynamicsWrench)?;
        Some(Self {
            study: row.study.clone(),
            quantity,
            method: row.method.clone(),
            metric: row.metric.clone(),
            states: StateCase::parse(&row.states),
            fault,
        })
    }

    /// The failure at the first state of a robot; `None` if it is not there. The robot has the name of the one that the failure was seen on:
    /// the size of a known deviation is that of a name.
    pub fn shown(&self, engine: &dyn Engine, gates: &Gates, robot: &Robot) -> Option<Shown> {
        // Some properties are those at a state of rest, which is the second of two.
        let properties = Robot::new(&robot.description, "reduced", ModelOrigin::Generated, 2, 1).ok()?.properties();
        let gates = gates.clone().with_altered(&robot.name, properties);
        let (kind, rows) = compared(&self.study, engine, &gates, robot, self.quantity, &self.method)?;
        let is_it = |row: &&Row| match &self.fault {
            Fault::Known(id) => cause(row).is_some_and(|cause| cause == *id),
            Fault::Unknown => matches!(row.verdict, Verdict::Fail | Verdict::Error),
            Fault::Above(least) => row.value.is_some_and(|value| value > *least),
        };
        let mut own = rows.iter().filter(|row| row.engine == engine.identity().name && row.method == self.method);
        let row = own.find(|row| row.metric == self.metric && is_it(row))?;
        Some(match row.value {
            Some(severity) => Shown { severity, kind: Kind::Number },
            None => Shown { severity: 1.0, kind },
        })
    }
}

/// The rows of an engine's answer, and how the answer would be wrong if its row has no value.
fn compared(name: &str, engine: &dyn Engine, gates: &Gates, robot: &Robot, quantity: Quantity, method: &str) -> Option<(Kind, Vec<Row>)> {
    let study = study(name)?;
    let cell = Cell::new(name, robot, engine.identity(), quantity.name(), method, json!({}));
    let outcome = answer(engine, robot, quantity, method).into();
    let kind = match &outcome {
        Outcome::Values(values) if values.iter().all(|x| x.is_finite()) => Kind::NoMeasure,
        Outcome::Values(_) => Kind::NotFinite,
        Outcome::Text(_) | Outcome::NoAnswer(_) => Kind::NoAnswer,
    };
    let mut finished = vec![(Cell { scalar: quantity.precision().into(), ..cell }, outcome)];
    if name == Agreement.name() {
        finished.insert(0, truth(robot, quantity));
    }
    let context = Context { robots: std::slice::from_ref(robot), engines: &[], gates, seed: 0 };
    Some((kind, study.compare(&context, robot, &finished)))
}

/// The studies whose cells ask a robot at its states, and nothing else.
fn study(name: &str) -> Option<Box<dyn Study>> {
    let all: [Box<dyn Study>; 4] =
        [Box::new(Agreement), Box::new(Accuracy::STATES), Box::new(Accuracy::SWEEP), Box::new(Derivatives::default())];
    all.into_iter().find(|study| study.name() == name)
}

/// The truth in the place of our answer.
fn truth(robot: &Robot, quantity: Quantity) -> Finished {
    let model = TruthModel::new(robot);
    let count = robot.asked(quantity);
    let values: Option<Vec<Vec<f64>>> = (0..count).map(|k| model.as_ref()?.answer(robot, quantity, k)).collect();
    let none = || Outcome::NoAnswer(NoAnswer::Failed("there is no true answer".into()));
    let identity = Identity { name: OWN.into(), version: String::new(), source: EngineSource::Own, build: BTreeMap::new() };
    let cell = Cell::new(Agreement.name(), robot, &identity, quantity.name(), "truth", json!({}));
    (cell, values.map_or_else(none, |values| Outcome::Values(values.concat())))
}

/// The true answer to a quantity at a robot's first state, to the nearest double; `None` if there is none.
pub fn true_answer(robot: &Robot, quantity: Quantity) -> Option<Vec<f64>> {
    if Quantity::DERIVATIVES.contains(&quantity) {
        return featherbench_bench::truth::TrueDerivatives::new(robot)?.answer(robot, quantity, 0);
    }
    let quantity = quantity.in_double();
    TruthModel::new(robot)?.answer(robot, quantity, 0)
}

/// The metric of the rows of a quantity in the studies `accuracy` and `sweep` that says how severe an error is.
pub fn metric(quantity: Quantity) -> &'static str {
    if quantity == Quantity::ForwardDynamics { "error_over_floor" } else { "true" }
}

/// The severity of an engine's error at the first state of a robot: for forward dynamics its ratio to the conditioning bound, else its unit-free
/// measure. It is that of the study's rows. `None` without an answer.
pub fn severity(engine: &dyn Engine, robot: &Robot, quantity: Quantity, method: &str) -> Option<f64> {
    let (_, rows) = compared(Accuracy::SWEEP.name(), engine, &Gates::default(), robot, quantity, method)?;
    rows.iter().find(|row| row.metric == metric(quantity))?.value
}
