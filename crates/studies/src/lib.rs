//! Studies: the questions of featherbench, one folder each.
//!
//! - [`Agreement`]: do the engines agree on the same model, and how large is our error compared with the best engine's?
//! - [`Accuracy`]: how far is each from the truth, and which engine is right?
//! - `sweep`: what errors do drawn robots have, by depth, mass ratio, offset, speed and kind of joint?
//! - [`Conditioning`]: how does κ(M) grow, and does it matter?
//! - [`Derivatives`]: which engine's derivatives are right, on which joint, and what does the step of finite differences cost?
//! - [`Import`]: do they import the same file alike, and if not, where and why do they differ?
//! - [`Repeatability`]: does the same question have the same answer?
//! - [`Reproductions`]: do the engines' known deviations still exist, and in their known size?
//! - `contact`: what do solvers, laws and integrators answer where the answer is known?
//! - `continuum`: what do discretised rods and strings answer where the answer is known?
//! - `loops`: how right are engines' accelerations and motions of robots with loops, and what do they cost?
//! - `relaxation`: does another solver find the velocities of our convex relaxation?
//! - `identification`: what do logs tell of a robot's parameters, and do estimators find them?
//! - `lesson`: which statements of a course's lesson hold, and by how much do the others miss?
//! - [`ContactTiming`]: how long do solvers take for the contacts of standing robots, at the same residual?
//! - `scenes`: what do engines make of bodies in contact whose motion is known?
//! - `residuals`: are residuals what their formulas say, does any engine take them, and what is structure worth in learning?
//! - [`Steps`]: how does the acceleration of a step approach the true one, and how do steps change the energy?
//! - [`OperationCounts`]: are the counts of the sparse algorithms the integers of the theory?
//! - [`Scaling`]: what do sparsity and errors become as robots grow?
//! - [`Growth`]: how do time and memory grow with the robot, and where does each engine stop?
//! - `uncertainty`: what do uncertain parameters do to the dynamics, where the answer is known?
//! - [`Timing`]: how long does each candidate take, in a paired experiment?

mod accuracy;
mod agreement;
mod conditioning;
mod contact;
mod contact_timing;
mod continuum;
mod derivatives;
mod dictionary;
mod figures;
mod growth;
mod identification;
pub mod import;
mod known;
mod lesson;
mod loops;
mod operations;
mod relaxation;
mod repeatability;
mod reproductions;
mod residuals;
mod scaling;
mod scenes;
#[cfg(test)]
#[path = "../../robots/tests/share.rs"]
mod share;
mod steps;
mod sweep;
mod timing;
mod uncertainty;

pub use accuracy::Accuracy;
pub use agreement::Agreement;
pub use conditioning::Conditioning;
pub use contact_timing::ContactTiming;
pub use derivatives::Derivatives;
pub use dictionary::dictionary;
pub use figures::FIGURES;
pub use growth::{Growth, Settings as GrowthSettings};
pub use import::Import;
pub use operations::OperationCounts;
pub use repeatability::Repeatability;
pub use reproductions::{Reproduce, Reproductions};
pub use scaling::{Scaling, Settings as ScalingSettings};
pub use steps::Steps;
pub use sweep::reduce;
pub use timing::{InstructionCounts, Kernels, Settings as TimingSettings, Timing, instructions};

use featherbench_bench::alone::Ask;
use featherbench_bench::statistics::quantile;
use featherbench_bench::{Cell, Context, Engine, HarnessError, NoAnswer, Outcome, Quantity, Robot, Study, Suite};
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo};

/// The study that a suite asks for, if it does; an error names file, line and key.
type Made = Result<Option<Box<dyn Study>>, HarnessError>;

/// A study of the house.
struct Entry {
    name: &'static str,
    /// How it is made from a suite.
    make: fn(&Setup) -> Made,
    /// Its sections of the report of a run.
    sections: fn(&RunInfo, &[Row], &Overview) -> Vec<Section>,
    /// What its names in rows mean.
    words: dictionary::Words,
}

/// Every study, in the order of a run and of its report. Those that run alone come after all others; timing is the last, as it needs a quiet
/// machine.
const STUDIES: &[Entry] = &[
    Entry { name: "agreement", make: agreement::of_suite, sections: agreement::section::sections, words: agreement::words::WORDS },
    Entry { name: "import", make: import::of_suite, sections: import::section::sections, words: import::words::WORDS },
    Entry { name: "accuracy", make: accuracy::of_suite, sections: accuracy::section::sections, words: accuracy::words::WORDS },
    // The measures and the truth are those of the study before it, and so are the words.
    Entry { name: "sweep", make: sweep::of_suite, sections: sweep::section::sections, words: accuracy::words::WORDS },
    Entry {
        name: "conditioning",
        make: conditioning::of_suite,
        sections: conditioning::section::sections,
        words: conditioning::words::WORDS,
    },
    Entry { name: "derivatives", make: derivatives::of_suite, sections: derivatives::section::sections, words: derivatives::words::WORDS },
    Entry { name: "contact", make: contact::of_suite, sections: contact::section::sections, words: contact::words::WORDS },
    Entry { name: "continuum", make: continuum::of_suite, sections: continuum::section::sections, words: continuum::words::WORDS },
    Entry { name: "scenes", make: scenes::of_suite, sections: scenes::section::sections, words: scenes::words::WORDS },
    // Its rows are in the verdict and in the tables of rows.
    Entry { name: "relaxation", make: relaxation::of_suite, sections: no_section, words: relaxation::words::WORDS },
    Entry {
        name: "identification",
        make: identification::of_suite,
        sections: identification::section::sections,
        words: identification::words::WORDS,
    },
    Entry { name: "residuals", make: residuals::of_suite, sections: residuals::section::sections, words: residuals::words::WORDS },
    Entry { name: "lesson", make: lesson::of_suite, sections: lesson::section::sections, words: lesson::words::WORDS },
    Entry { name: "uncertainty", make: uncertainty::of_suite, sections: uncertainty::section::sections, words: uncertainty::words::WORDS },
    Entry { name: "steps", make: steps::of_suite, sections: steps::section::sections, words: steps::words::WORDS },
    Entry { name: "operations", make: operations::of_suite, sections: no_section, words: operations::words::WORDS },
    Entry { name: "scaling", make: scaling::of_suite, sections: scaling::section::sections, words: scaling::words::WORDS },
    Entry {
        name: "reproductions",
        make: reproductions::of_suite,
        sections: reproductions::section::sections,
        words: reproductions::words::WORDS,
    },
    Entry { name: "repeatability", make: repeatability::of_suite, sections: no_section, words: repeatability::words::WORDS },
    // Its rows are in the section of the study `scaling`.
    Entry { name: "growth", make: growth::of_suite, sections: no_section, words: growth::words::WORDS },
    Entry { name: "loops", make: loops::of_suite, sections: loops::section::sections, words: loops::words::WORDS },
    Entry {
        name: "contact_timing",
        make: contact_timing::of_suite,
        sections: contact_timing::section::sections,
        words: contact_timing::words::WORDS,
    },
    Entry { name: "timing", make: timing::of_suite, sections: timing::section::sections, words: timing::words::WORDS },
];

/// The rows of some studies are in the verdict and in the tables of rows alone.
fn no_section(_: &RunInfo, _: &[Row], _: &Overview) -> Vec<Section> {
    Vec::new()
}

/// What studies are made from.
pub struct Setup<'a> {
    /// The suite, whose tables are the studies' settings.
    pub suite: &'a Suite,
    /// Whether the engines themselves are asked.
    pub live: bool,
    /// The hash of this program.
    pub program: &'a str,
    /// Our kernels that are timed.
    pub kernels: Kernels,
    /// Evaluates reproductions of known deviations.
    pub reproduce: Reproduce,
    /// Measures a method in a process of its own.
    pub measure: Ask,
}

/// The names of all studies.
pub fn names() -> Vec<&'static str> {
    STUDIES.iter().map(|study| study.name).collect()
}

/// The studies of a suite.
///
/// # Errors
/// [`HarnessError`], naming file, line and key, when a table of the suite has an error or belongs to no study.
pub fn of_suite(setup: &Setup) -> Result<Vec<Box<dyn Study>>, HarnessError> {
    setup.suite.check_studies(&names())?;
    STUDIES.iter().filter_map(|study| (study.make)(setup).transpose()).collect()
}

/// The sections of the report of a run, study by study: of each that has rows, and of those that say that they have none.
pub fn sections(run: &RunInfo, rows: &[Row]) -> Vec<Section> {
    let overview = Overview::of(run, rows);
    let mut all = Vec::new();
    for study in STUDIES {
        let sections = (study.sections)(run, rows, &overview).into_iter();
        all.extend(sections.map(|section| Section { study: study.name, ..section }));
    }
    all
}

/// A row with the fields of its cell and robot; the study adds case, metric and value.
fn row(cell: &Cell, robot: &Robot) -> Row {
    Row {
        cell: cell.id(),
        study: cell.study.clone(),
        family: robot.family.clone(),
        robot: robot.name.clone(),
        nq: Some(robot.states.nq as u64),
        nv: Some(robot.states.nv as u64),
        bodies: Some(robot.description.bodies.len() as u64),
        depth: Some(robot.depth as u64),
        params: featherbench_results::canonical_json(&cell.params),
        engine: cell.engine.clone(),
        engine_version: cell.version.clone(),
        method: cell.method.clone(),
        precision: cell.scalar.clone(),
        quantity: cell.quantity.clone(),
        ..Row::default()
    }
}

/// Asks a cell's engine for its quantity at the robot's states.
fn evaluate(context: &Context, cell: &Cell) -> Outcome {
    let lost = |what: &str| Outcome::NoAnswer(NoAnswer::Failed(format!("there is no {what} of this cell")));
    let Some(robot) = context.robot(&cell.robot) else { return lost("robot") };
    let Some(engine) = context.engine(&cell.engine) else { return lost("engine") };
    let Some(quantity) = Quantity::parse(&cell.quantity) else { return lost("quantity") };
    asked(engine, robot, quantity, &cell.method).into()
}

/// Asks an engine for a quantity at a robot's states.
fn asked(engine: &dyn Engine, robot: &Robot, quantity: Quantity, method: &str) -> Result<Vec<f64>, NoAnswer> {
    let count = quantity.states(robot.states.count());
    let mut prepared = engine.prepare(robot, quantity, method, &robot.states)?;
    prepared.run(0..count)?;
    let (values, due) = (prepared.read().to_vec(), count * quantity.size(robot));
    // Otherwise fewer states would be compared without notice.
    if values.len() == due { Ok(values) } else { Err(NoAnswer::Failed(format!("{} numbers came, {due} are due", values.len()))) }
}
