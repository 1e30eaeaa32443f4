//! Timing: a paired experiment. All candidates for a quantity are timed in alternating blocks on one core, with an A/A replicate of our
//! usual method. The regime `stream` uses many distinct states, `hot` one.
//!
//! A time includes everything from raw q, v, a or τ to the result: sine and cosine, gravity, armature and full inertias. `factorization`
//! and `solve` start from a mass matrix or factors made before. Converting coordinates and reading results are outside the clock for all
//! candidates. `guide/studies/timing.md` describes the protocol, the statistics and the meaning of each number.
//!
//! There are four kinds of cells:
//! - the *machine*: its peak, its clock, an empty call;
//! - a *check* for each candidate: the error of its answer at every state of the stream;
//! - the *overhead* of calling it, if its times are estimates;
//! - an *experiment* for each quantity and cache regime: all blocks of all rounds, in a cell for each of its processes.
//!
//! A pure function makes rows of them. A time does not count in three cases: without a good check; in an experiment whose A/A replicate
//! differs from the first copy; and on a robot with many such experiments. These rows keep their values, are not valid and give the reason.

mod best_other;
mod check;
pub(crate) mod machine;
mod overhead;
pub(crate) mod protocol;
pub(crate) mod rows;
pub(crate) mod samples;
pub(crate) mod section;
pub(crate) mod words;

use featherbench_bench::statistics::PROCESSES;
use featherbench_bench::{Asked, Cell, Context, Core, Engine, Finished, HarnessError, NoAnswer, OWN, Outcome, Quantity, Robot, Study};
use featherbench_results::Row;
use featherbench_robots::{Random, StateBatch};
use featherbench_spatial::contention;
use featherbench_study::{Entry, Made, Setup};
use machine::{Machine, Pinned};
use protocol::{Budget, Ready};
use samples::Candidate;
pub use section::{InstructionCounts, disturbed, instructions};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use std::time::Instant;

/// The timing study.
pub struct Timing {
    /// The table of the suite.
    pub settings: Settings,
    /// Our own kernels to time on a robot; the first of a quantity is the reference.
    pub kernels: Kernels,
}

/// The table `[timing]` of a suite.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Distinct states in the stream.
    pub states: usize,
    /// Seconds for each candidate in each experiment, of all its processes together.
    pub seconds: f64,
    /// The engines that are timed beside ours if they are installed, by all their methods for the quantities of our kernels: native
    /// oracles, and oracles whose clock estimates.
    #[serde(default)]
    pub engines: Vec<String>,
    /// The quantities that are timed. Without any it is all of our kernels.
    #[serde(default, deserialize_with = "quantities")]
    pub quantities: Vec<Quantity>,
    /// Those of the engines whose fastest method is compared with each of ours: rows `best_other`.
    #[serde(default)]
    pub best_of: Vec<String>,
    /// Without `quantities`: whether derivatives are timed, and nothing else. Otherwise everything else is.
    #[serde(default)]
    pub derivatives: bool,
}

/// Quantities by their words.
fn quantities<'de, D: Deserializer<'de>>(words: D) -> Result<Vec<Quantity>, D::Error> {
    let words = Vec::<String>::deserialize(words)?;
    let parsed = |word: &String| Quantity::parse(word).ok_or_else(|| D::Error::custom(format!("there is no quantity '{word}'")));
    words.iter().map(parsed).collect()
}

/// The kernels that are timed on a robot, as (quantity, method).
pub type Kernels = fn(&Robot) -> Vec<(Quantity, &'static str)>;

/// The study in the registry.
pub const ENTRY: Entry = Entry { name: "timing", make: of_suite, sections: section::sections, words: words::WORDS };

/// The study, if the suite asks for it.
fn of_suite(setup: &Setup) -> Made {
    let settings = setup.suite.settings::<Settings>("timing")?;
    if let Some(stranger) =
        settings.iter().flat_map(|settings| settings.best_of.iter().filter(|engine| !settings.engines.contains(engine))).next()
    {
        let message = format!("[timing]: '{stranger}' is in best_of, but not in engines");
        return Err(HarnessError::Config { path: setup.suite.path().to_owned(), message });
    }
    Ok(settings.map(|settings| Box::new(Timing { settings, kernels: featherbench_kernels::timed }) as _))
}

/// Name of the side file with the raw samples in a run's folder.
const SAMPLES_NAME: &str = "timing.jsonl";

/// Our own kernels, with which all candidates are compared.
const REFERENCE: &str = OWN;
/// The metric of the time of the fastest method of some engines over that of one of ours.
const BEST_OTHER: &str = "best_other";
/// The quantity of the rows of the machine.
const MACHINE: &str = "machine";
/// The cache regimes.
const REGIMES: [&str; 2] = ["stream", "hot"];
/// The largest number of values of states in memory at once: 100 MB, far more than any cache.
const MOST_NUMBERS: usize = 12_000_000;
/// The largest number of entries of mass matrices, if a quantity is one or needs one: the registry keeps as many.
const MOST_ENTRIES: usize = 4 << 20;

/// The core that takes the times of this process.
pub(crate) static CORE: Core = Core::new(contention);

/// The kinds of cells, with their parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
enum CellKind {
    Machine,
    Check { states: usize },
    Overhead { states: usize },
    Experiment(Paired),
}

/// The parameters of an experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Paired {
    cache: String,
    states: usize,
    /// Of all processes together.
    seconds: f64,
    /// Which of the processes this is.
    process: usize,
    candidates: Vec<Candidate>,
}

impl Paired {
    /// Those of a cell; `None` of any other cell.
    fn of(cell: &Cell) -> Option<Self> {
        if let Ok(CellKind::Experiment(paired)) = cell.params() { Some(paired) } else { None }
    }
}

/// The largest robot, in dofs, that is timed through an interpreter. Converting a thousand states of a larger one takes minutes per method.
const LARGEST_ESTIMATE: usize = 64;

/// Whether a robot is too large for times that are estimates.
fn refused(robot: &Robot, estimate: bool) -> bool {
    estimate && robot.states.nv > LARGEST_ESTIMATE
}

impl Study for Timing {
    fn name(&self) -> &'static str {
        "timing"
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

    fn is_common(&self, cell: &Cell) -> bool {
        matches!(cell.params(), Ok(CellKind::Machine))
    }

    /// The time that each candidate is given; other cells take about as long as one candidate in one process.
    fn seconds(&self, _: &Context, cell: &Cell) -> f64 {
        let candidates = Paired::of(cell).map_or(1, |paired| paired.candidates.len());
        self.settings.seconds * candidates as f64 / PROCESSES as f64
    }

    fn process(&self, cell: &Cell) -> Option<usize> {
        Paired::of(cell).map(|paired| paired.process)
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        let Some(featherbench) = context.engine(REFERENCE) else { return cells };
        for robot in context.robots.iter().filter(|robot| robot.takes(self.name())) {
            if cells.is_empty() {
                // The cell of the machine is evaluated once, with the first robot.
                cells.push(self.cell(robot, featherbench, Quantity::StoredEntries, "empty", CellKind::Machine));
            }
            for (quantity, candidates) in self.experiments(context, robot) {
                let states = self.stream_length(robot, quantity);
                for candidate in candidates.iter().filter(|candidate| !candidate.control) {
                    let Some(engine) = context.engine(&candidate.engine) else { continue };
                    let answered = Quantity::parse(&candidate.quantity).unwrap_or(quantity);
                    cells.push(self.cell(robot, engine, answered, &candidate.method, CellKind::Check { states }));
                    if candidate.estimate && !refused(robot, candidate.estimate) {
                        cells.push(self.cell(robot, engine, quantity, &candidate.method, CellKind::Overhead { states }));
                    }
                }
                let Some(usual) = candidates.first() else { continue };
                let timed = candidates.iter().filter(|candidate| !refused(robot, candidate.estimate));
                let timed: Vec<Candidate> = timed.cloned().collect();
                for regime in REGIMES {
                    let states = if regime == "hot" { 1 } else { states };
                    cells.extend((0..PROCESSES).map(|process| {
                        let Settings { seconds, .. } = self.settings;
                        let paired = Paired { cache: regime.into(), states, seconds, process, candidates: timed.clone() };
                        self.cell(robot, featherbench, quantity, &usual.method, CellKind::Experiment(paired))
                    }));
                }
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        self.measured(asked).into()
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        rows::rows(context.gates, robot, &self.settings.best_of, finished)
    }

    /// The raw samples.
    fn side_file(&self, finished: &[Finished]) -> Option<(&'static str, String)> {
        (!finished.is_empty()).then(|| (SAMPLES_NAME, samples::lines(finished)))
    }
}

impl Timing {
    /// The numbers of a cell.
    fn measured(&self, asked: &Asked) -> Result<Vec<f64>, NoAnswer> {
        let Asked { context, cell, .. } = *asked;
        let (robot, engine, quantity) = (asked.robot()?, asked.engine()?, asked.quantity()?);
        let featherbench = context.engine(REFERENCE).ok_or_else(|| NoAnswer::Failed("our engine is not there".into()))?;
        let kind: CellKind = cell.params()?;
        if kind != CellKind::Machine && refused(robot, engine.estimates()) {
            let reason = format!("times that are estimates are taken of robots up to {LARGEST_ESTIMATE} degrees of freedom");
            return Err(NoAnswer::NotOffered(reason));
        }
        let random = |count| StateBatch::random(&robot.model, count, context.seed);
        match kind {
            CellKind::Machine => {
                let mut empty = featherbench.prepare(robot, quantity, "topology", &robot.states)?;
                let _pinned = Pinned::to_one_core();
                Ok(Machine::measure(empty.as_mut())?.to_values())
            }
            CellKind::Check { states } => check::errors(&robot.clone().at(random(states)), featherbench, engine, quantity, &cell.method),
            CellKind::Overhead { states } => {
                let states = random(states);
                let _pinned = Pinned::to_one_core();
                overhead::per_call(engine.prepare(robot, quantity, &cell.method, &states)?.as_mut())
            }
            CellKind::Experiment(Paired { states: count, candidates, .. }) => {
                let states = random(count);
                let _pinned = Pinned::to_one_core();
                let prepare = |which: usize| -> Ready {
                    let Candidate { engine, quantity, method, .. } = &candidates[which];
                    let lost = || NoAnswer::Failed("there is no engine or quantity of this candidate".into());
                    let quantity = Quantity::parse(quantity).ok_or_else(lost)?;
                    context.engine(engine).ok_or_else(lost)?.prepare(robot, quantity, method, &states)
                };
                let mut random = Random::named(context.seed, &cell.id());
                let start = Instant::now();
                let clock = || start.elapsed();
                let budget = Budget::of(self.settings.seconds / PROCESSES as f64);
                Ok(protocol::experiment(&prepare, candidates.len(), count, budget, &clock, &CORE, &mut random).to_values())
            }
        }
    }

    fn cell(&self, robot: &Robot, engine: &dyn Engine, quantity: Quantity, method: &str, params: CellKind) -> Cell {
        Cell { scalar: quantity.precision().into(), ..Cell::new(self.name(), robot, engine.identity(), quantity.name(), method, params) }
    }

    /// The quantities with their candidates: our usual method, its A/A replicate, our other methods, the other engines. A method in single
    /// precision stands beside those in double.
    fn experiments(&self, context: &Context, robot: &Robot) -> Vec<(Quantity, Vec<Candidate>)> {
        let candidate = |engine: &dyn Engine, quantity: Quantity, method: &str, control| Candidate {
            engine: engine.identity().name.clone(),
            version: engine.identity().version.clone(),
            quantity: quantity.name().to_owned(),
            method: method.to_owned(),
            control,
            estimate: engine.estimates(),
        };
        let Some(featherbench) = context.engine(REFERENCE) else { return Vec::new() };
        let mut experiments: Vec<(Quantity, Vec<Candidate>)> = Vec::new();
        let Settings { quantities, derivatives, .. } = &self.settings;
        let asked = |(quantity, _): &(Quantity, &str)| match &quantities[..] {
            [] => quantity.is_derivative() == *derivatives,
            named => named.contains(&quantity.in_double()),
        };
        for (quantity, method) in (self.kernels)(robot).into_iter().filter(asked) {
            let one = |control| candidate(featherbench, quantity, method, control);
            match experiments.iter_mut().find(|(known, _)| *known == quantity.in_double()) {
                Some((_, candidates)) => candidates.push(one(false)),
                None => experiments.push((quantity.in_double(), vec![one(false), one(true)])),
            }
        }
        for (quantity, candidates) in &mut experiments {
            for engine in self.settings.engines.iter().filter_map(|name| context.engine(name)) {
                candidates.extend(engine.timed(*quantity).iter().map(|method| candidate(engine, *quantity, method, false)));
            }
        }
        experiments
    }

    /// The stream's length for a quantity of a robot: as requested, or fewer if the states or their matrices would not fit.
    fn stream_length(&self, robot: &Robot, quantity: Quantity) -> usize {
        let numbers = robot.states.nq + 3 * robot.states.nv + 6 * robot.states.bodies;
        let entries = match quantity {
            Quantity::MassMatrixSparse | Quantity::Factorization | Quantity::Solve => robot.model.topology.stored(),
            // Forward dynamics may factorize a matrix. Ten times the number that are kept take a second or two.
            Quantity::ForwardDynamics => robot.model.topology.stored() / 10,
            _ => 1,
        };
        self.settings.states.min(1 + MOST_NUMBERS / numbers.max(1)).min(1 + MOST_ENTRIES / entries.max(1))
    }
}
