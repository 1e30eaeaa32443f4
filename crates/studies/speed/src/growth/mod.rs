//! Growth: time and memory of each engine's methods as robots grow, and where each engine stops.
//!
//! Every size is measured in a process of its own, ours too, with limits of memory and time. There the methods of another engine follow each
//! other; each of ours has its own. An engine that exits or refuses at a size, or is
//! ended by a limit, has its largest size before that as its result, with the reason. The run goes on. No method is asked for a larger size
//! after that, or for a size that is expected to take longer than the suite waits.
//!
//! | row | meaning |
//! |---|---|
//! | `seconds` | median time of a call, with the bootstrap interval of the median over blocks of calls |
//! | `build_seconds` | from the description to a model with its workspace; for an oracle, messages included |
//! | `peak` | the most memory that the process ever had resident: program, libraries, robot as read, model, workspace |
//! | `resident` | memory resident after the last call |
//! | `error` | forward dynamics: ‖a − truth‖₂ / ‖truth‖₂ |
//! | `time_exponent` | p of time ~ nᵖ over the last two decades, with its bootstrap interval |
//! | `resident_per_dof` | all resident memory over the dofs, at 10⁶ dofs and more |
//! | `memory_per_dof` | growth of the resident memory per dof, between the last two sizes |
//! | `memory_exponent` | p of (resident − resident at the smallest size) ~ nᵖ over the last two decades |
//! | `largest` | dofs of the largest tree that was answered; the reason says why no larger one was |
//! | `time_ratio`, `crossover_measured` | ours: a method against the serial one that `reference` names, and the size where both take the same time |
//! | `different_answers` | ours: how many different answers a method on several threads gives, over all numbers of threads |
//!
//! Judged are our memory per dof and the number of answers, which is one. An engine that fails at a size up to `must` is an error. All else is
//! measured only.

mod line;
mod own;
mod rows;
mod slope;
pub(crate) mod words;

use crate::scaling::{relative_error, truth};
use featherbench_bench::alone::{self, Ask, Measured, Question};
use featherbench_bench::{Asked, Cell, Context, Engine, Finished, Limits, NoAnswer, OWN, Outcome, Quantity, Study};
use featherbench_results::Row;
use featherbench_study::{Entry, no_section};
use line::{Grown, Point, Stop};
use own::Own;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// The growth study.
pub struct Growth {
    settings: Settings,
    measure: Ask,
    /// True accelerations by tree: every engine and method is compared with them.
    truths: Mutex<BTreeMap<String, Arc<Vec<f64>>>>,
    /// What cells did that were measured with an earlier one, by their ids.
    ahead: Mutex<BTreeMap<String, Grown>>,
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
    /// Numbers of threads for our methods that use several; none of them is measured if there is no number.
    #[serde(default)]
    pub threads: Vec<usize>,
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
    /// The sizes for other engines than ours, ascending; without them they have ours.
    #[serde(default)]
    pub peers: Option<Vec<u64>>,
    /// Every engine must answer up to this size.
    pub must: u64,
}

impl Line {
    /// The sizes at which an engine is asked.
    fn sizes_of(&self, engine: &str) -> &[u64] {
        match &self.peers {
            Some(sizes) if engine != OWN => sizes,
            _ => &self.sizes,
        }
    }
}

/// The parameters of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Params {
    #[serde(flatten)]
    of_line: OfLine,
    of: String,
    sizes: Vec<u64>,
    must: u64,
    seconds: f64,
    patience: u64,
    memory: u64,
    seed: u64,
}

/// Those of them that its rows have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct OfLine {
    line: String,
    /// Of our methods that use several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) threads: Option<usize>,
}

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "growth",
    make: |setup| setup.made("growth", |settings| Growth::new(settings, Arc::clone(&setup.measure))),
    sections: no_section,
    words: words::WORDS,
};

impl Growth {
    /// The study with these settings; `measure` measures in a process of its own.
    pub fn new(settings: Settings, measure: Ask) -> Self {
        Self { settings, measure, truths: Mutex::default(), ahead: Mutex::default() }
    }

    /// The methods of an engine that are measured, with the threads of those that use several. Of other engines, of those that can be timed:
    /// the usual one of inverse dynamics, all of forward dynamics.
    fn methods(&self, engine: &dyn Engine) -> Vec<(Quantity, String, Option<usize>)> {
        if engine.identity().name == OWN {
            let serial = own::METHODS.iter().filter(|own| !own.parallel).map(|own| (own.quantity, own.name(1), None));
            let parallel = own::METHODS.iter().filter(|own| own.parallel);
            let threaded = |own: &'static Own| self.settings.threads.iter().map(|&n| (own.quantity, own.name(n), Some(n)));
            return serial.chain(parallel.flat_map(threaded)).collect();
        }
        let usual = engine.timed(Quantity::InverseDynamics).into_iter().take(1).map(|method| (Quantity::InverseDynamics, method, None));
        let forward = engine.timed(Quantity::ForwardDynamics).into_iter().map(|method| (Quantity::ForwardDynamics, method, None));
        usual.chain(forward).collect()
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

    /// The end of a line before a size whose answer is expected to take longer than the suite waits, by a power law through the last two sizes.
    /// An answer needs the model and two calls.
    fn too_long(&self, points: &[Point], sizes: &[u64]) -> Option<Stop> {
        let [.., before, last] = points else { return None };
        let [m, n, next] = *sizes.get(points.len() - 2..=points.len())? else { return None };
        let took = |point: &Point| point.build + 2.0 * slope::median(&point.calls);
        let steps = (next as f64 / n as f64).ln() / (n as f64 / m as f64).ln();
        let expected = took(last) * (took(last) / took(before)).powf(steps);
        let patience = self.settings.patience;
        let reason = format!("not asked: {expected:.0} s are expected by the last two sizes, and the suite waits {patience} s");
        (expected > patience as f64).then(|| Stop { size: next, tree: String::new(), reason, offered: false })
    }

    /// Measures cells of one engine along their line, size after size.
    ///
    /// Each cell goes up to its first size without an answer, or ends before the first that is expected to take too long.
    ///
    /// At a size all methods follow each other, so that an engine need not build the same robot for each.
    fn grow(&self, seed: u64, cells: &[Cell], line: &Line) -> Result<Vec<Grown>, NoAnswer> {
        let limits = Limits { answer: Duration::from_secs(self.settings.patience), memory: self.settings.memory << 20 };
        let mut all = vec![Grown::default(); cells.len()];
        let Some(engine) = cells.first().map(|cell| cell.engine.as_str()) else { return Ok(all) };
        let sizes = line.sizes_of(engine);
        for &size in sizes {
            let tree = line.of.replace('*', &size.to_string());
            for (cell, grown) in cells.iter().zip(&mut all).filter(|(_, grown)| grown.stop.is_none()) {
                let quantity = Quantity::parse(&cell.quantity).ok_or_else(|| NoAnswer::Failed("there is no such quantity".into()))?;
                let question = Question {
                    engine: cell.engine.clone(),
                    robot: tree.clone(),
                    quantity,
                    method: own::of(cell).map_or(cell.method.as_str(), |own| own.method).to_owned(),
                    threads: own::threads(cell),
                    seed,
                    seconds: self.settings.seconds,
                    limits,
                };
                let stop = |reason, offered| Some(Stop { size, tree: tree.clone(), reason, offered });
                match (self.measure)(&question).and_then(|measured| self.point(&question, measured)) {
                    Ok(point) => {
                        grown.points.push(point);
                        let tree = |stop: &Stop| line.of.replace('*', &stop.size.to_string());
                        grown.stop = self.too_long(&grown.points, sizes).map(|stop| Stop { tree: tree(&stop), ..stop });
                    }
                    Err(NoAnswer::NotOffered(reason)) => grown.stop = stop(reason, false),
                    Err(NoAnswer::Failed(reason)) => grown.stop = stop(reason, true),
                }
            }
        }
        Ok(all)
    }

    /// The cells that are measured with this one: of ours it alone, of another engine also its later cells on the same line.
    fn together(&self, context: &Context, cell: &Cell) -> Vec<Cell> {
        if cell.engine == OWN {
            return vec![cell.clone()];
        }
        let of_line = |other: &Cell| other.engine == cell.engine && other.robot == cell.robot;
        self.plan(context).into_iter().filter(of_line).skip_while(|other| other != cell).collect()
    }

    /// What a cell's methods did along its line. Cells that were measured with it are kept until they are asked for.
    fn line(&self, &Asked { context, cell, .. }: &Asked) -> Result<Grown, NoAnswer> {
        let ahead = || self.ahead.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(grown) = ahead().remove(&cell.id()) {
            return Ok(grown);
        }
        let failed = |reason: &str| NoAnswer::Failed(reason.to_owned());
        let line = self.settings.lines.iter().find(|line| line.name == cell.robot);
        let line = line.ok_or_else(|| failed("there is no line of this cell"))?;
        let cells = self.together(context, cell);
        let mut grown = cells.iter().map(Cell::id).zip(self.grow(context.seed, &cells, line)?);
        let (_, own) = grown.next().ok_or_else(|| failed("the plan has no such cell"))?;
        ahead().extend(grown);
        Ok(own)
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
        let &Settings { seconds, patience, memory, ref lines, .. } = &self.settings;
        let mut cells = Vec::new();
        for line in lines {
            for engine in &engines {
                for (quantity, method, threads) in self.methods(*engine) {
                    let identity = engine.identity();
                    let params = Params {
                        of_line: OfLine { line: line.name.clone(), threads },
                        of: line.of.clone(),
                        sizes: line.sizes_of(&identity.name).to_vec(),
                        must: line.must,
                        seconds,
                        patience,
                        memory,
                        seed: context.seed,
                    };
                    let cell = Cell::of_case(self.name(), &line.name, (&identity.name, &identity.version), quantity.name(), method, params);
                    cells.push(Cell { robot_hash: String::new(), ..cell });
                }
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        self.line(asked).map(|grown| grown.to_text()).into()
    }

    /// All rows come from [`Study::compare_all`]: no tree is a robot of the suite.
    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        rows::rows(context, finished)
    }
}
