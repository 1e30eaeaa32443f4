//! Growth: time and memory of each engine's methods as robots grow, and where each engine stops.
//!
//! Every size is measured in a process of its own, ours too, with limits of memory and time. An engine that exits, is ended by a limit or
//! refuses at a size has its largest size before that as its result, with the reason. The run goes on.
//!
//! | row | meaning |
//! |---|---|
//! | `seconds` | median time of a call, with the bootstrap interval of the median over blocks of calls |
//! | `build_seconds` | from the description to a model with its workspace; for an oracle, messages included |
//! | `peak` | the most memory that the process ever had resident: program, libraries, robot as read, model, workspace |
//! | `resident` | memory resident after the last call |
//! | `error` | forward dynamics: ‖a − truth‖₂ / ‖truth‖₂ |
//! | `time_exponent` | p of time ~ nᵖ over the last two decades, with its bootstrap interval |
//! | `memory_per_dof` | growth of the resident memory per dof, between the last two sizes |
//! | `largest` | dofs of the largest tree that was answered; the reason says why no larger one was |
//! | `time_ratio`, `crossover_measured` | ours: the way by the mass matrix against the articulated-body algorithm |
//!
//! All are measured and none is judged, with one exception: an engine that fails at a size up to `must` is an error.

mod line;
mod rows;
mod slope;

use crate::scaling::{relative_error, truth};
use crate::{Made, Setup};
use featherbench_bench::alone::{self, Ask, Measured, Question};
use featherbench_bench::{Cell, Context, Engine, Finished, Limits, NoAnswer, OWN, Outcome, Quantity, Robot, Study};
use featherbench_results::Row;
use line::{Grown, Point, Stop};
use serde::Deserialize;
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// The growth study.
pub struct Growth {
    settings: Settings,
    measure: Ask,
    /// True accelerations by tree: every engine and method is compared with them.
    truths: Mutex<BTreeMap<String, Arc<Vec<f64>>>>,
}

/// The table `[growth]` of a suite.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Seconds for the blocks of calls at each size.
    pub seconds: f64,
    /// Seconds to wait for one answer of a process.
    pub patience: u64,
    /// Limit of a process' address space, MiB.
    pub memory: u64,
    /// Engines beside ours, if they are installed.
    #[serde(default)]
    pub engines: Vec<String>,
    /// Families along which robots grow.
    pub lines: Vec<Line>,
}

/// A family along which robots grow.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Its name in rows.
    pub name: String,
    /// The generator's text, with `*` in the place of the size.
    pub of: String,
    /// The sizes, ascending.
    pub sizes: Vec<u64>,
    /// Every engine must answer up to this size.
    pub must: u64,
}

/// Our methods that are measured.
const OWN_METHODS: [(Quantity, &str); 4] = [
    (Quantity::InverseDynamics, "rnea"),
    (Quantity::Momentum, "kinematics"),
    (Quantity::ForwardDynamics, "aba"),
    (Quantity::ForwardDynamics, "ltdl"),
];

/// The study, if the suite asks for it.
pub(crate) fn of_suite(setup: &Setup) -> Made {
    let settings = setup.suite.settings::<Settings>("growth")?;
    Ok(settings.map(|settings| Box::new(Growth::new(settings, Arc::clone(&setup.measure))) as _))
}

impl Growth {
    /// The study with these settings; `measure` measures in a process of its own.
    pub fn new(settings: Settings, measure: Ask) -> Self {
        Self { settings, measure, truths: Mutex::default() }
    }

    /// The methods of an engine that are measured, of those that can be timed: the usual one of inverse dynamics, all of forward dynamics.
    fn methods(engine: &dyn Engine) -> Vec<(Quantity, String)> {
        if engine.identity().name == OWN {
            return OWN_METHODS.map(|(quantity, method)| (quantity, method.to_owned())).into();
        }
        let usual = engine.timed(Quantity::InverseDynamics).into_iter().take(1).map(|method| (Quantity::InverseDynamics, method));
        usual.chain(engine.timed(Quantity::ForwardDynamics).into_iter().map(|method| (Quantity::ForwardDynamics, method))).collect()
    }

    /// The true acceleration of a tree.
    fn truth(&self, tree: &str, seed: u64) -> Result<Arc<Vec<f64>>, NoAnswer> {
        let known = || self.truths.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(truth) = known().get(tree) {
            return Ok(Arc::clone(truth));
        }
        let truth = Arc::new(truth(&alone::robot(tree, seed)?)?);
        known().insert(tree.to_owned(), Arc::clone(&truth));
        Ok(truth)
    }

    /// A size with its error. An answer that is none ends the line: a text of an outcome cannot hold a NaN.
    fn point(&self, question: &Question, measured: Measured) -> Result<Point, NoAnswer> {
        let Measured { answer, calls, .. } = &measured;
        let failed = |reason: String| Err(NoAnswer::Failed(reason));
        if calls.is_empty() || !answer.iter().chain(calls).all(|x| x.is_finite()) {
            return failed("its answer holds a number that is not finite, or no time".into());
        }
        if question.quantity != Quantity::ForwardDynamics {
            return Ok(Point::of(&question.robot, measured, None));
        }
        let truth = self.truth(&question.robot, question.seed)?;
        if answer.len() != truth.len() {
            return failed(format!("its answer has {} numbers, {} are due", answer.len(), truth.len()));
        }
        let error = relative_error(answer, &truth);
        if error.is_finite() { Ok(Point::of(&question.robot, measured, Some(error))) } else { failed(format!("its error is {error}")) }
    }

    /// Measures a method along a line, up to the first size without an answer.
    fn grow(&self, seed: u64, cell: &Cell, line: &Line) -> Result<Grown, NoAnswer> {
        let quantity = Quantity::parse(&cell.quantity).ok_or_else(|| NoAnswer::Failed("there is no such quantity".into()))?;
        let limits = Limits { answer: Duration::from_secs(self.settings.patience), memory: self.settings.memory << 20 };
        let mut grown = Grown::default();
        for &size in &line.sizes {
            let tree = line.of.replace('*', &size.to_string());
            let question = Question {
                engine: cell.engine.clone(),
                robot: tree.clone(),
                quantity,
                method: cell.method.clone(),
                seed,
                seconds: self.settings.seconds,
                limits,
            };
            match (self.measure)(&question).and_then(|measured| self.point(&question, measured)) {
                Ok(point) => grown.points.push(point),
                Err(NoAnswer::NotOffered(reason)) => grown.stop = Some(Stop { size, tree, reason, offered: false }),
                Err(NoAnswer::Failed(reason)) => grown.stop = Some(Stop { size, tree, reason, offered: true }),
            }
            if grown.stop.is_some() {
                break;
            }
        }
        Ok(grown)
    }
}

impl Study for Growth {
    fn name(&self) -> &'static str {
        "growth"
    }

    fn exclusive(&self) -> bool {
        true
    }

    fn measures_time(&self) -> bool {
        true
    }

    fn engines(&self) -> &[String] {
        &self.settings.engines
    }

    /// A time that includes an exchange of messages says so in its row.
    fn needs_clocks(&self) -> bool {
        false
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let asked = [OWN].into_iter().chain(self.settings.engines.iter().map(String::as_str));
        let engines: Vec<&dyn Engine> = asked.filter_map(|name| context.engine(name)).collect();
        let Settings { seconds, patience, memory, lines, .. } = &self.settings;
        let mut cells = Vec::new();
        for line in lines {
            for engine in &engines {
                for (quantity, method) in Self::methods(*engine) {
                    let params = json!({
                        "line": line.name, "of": line.of, "sizes": line.sizes, "must": line.must,
                        "seconds": seconds, "patience": patience, "memory": memory, "seed": context.seed,
                    });
                    let identity = engine.identity();
                    cells.push(Cell {
                        study: self.name().into(),
                        robot: line.name.clone(),
                        robot_hash: String::new(),
                        params,
                        engine: identity.name.clone(),
                        version: identity.version.clone(),
                        method,
                        quantity: quantity.name().into(),
                        scalar: "f64".into(),
                    });
                }
            }
        }
        cells
    }

    fn evaluate(&self, context: &Context, cell: &Cell) -> Outcome {
        let line = self.settings.lines.iter().find(|line| line.name == cell.robot);
        let grown = line.ok_or_else(|| NoAnswer::Failed("there is no line of this cell".into()));
        match grown.and_then(|line| self.grow(context.seed, cell, line)) {
            Ok(grown) => Outcome::Text(grown.to_text()),
            Err(no_answer) => Outcome::NoAnswer(no_answer),
        }
    }

    /// All rows come from [`Study::compare_all`]: no tree is a robot of the suite.
    fn compare(&self, _: &Context, _: &Robot, _: &[Finished]) -> Vec<Row> {
        Vec::new()
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        rows::rows(context, finished)
    }
}
