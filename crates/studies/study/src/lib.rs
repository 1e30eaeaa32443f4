//! What every study is made of: its entry in the registry, the rows of its cells, cases with known answers, and figures.
//!
//! A study is a folder in one of three crates, by the kind of its question: `comparison` (engines with each other and with the truth), `answers`
//! (where the answer is known) and `speed`. Each folder has an [`ENTRY`](Entry); the crate `registry` lists all in the order of a run.

pub mod figures;
pub mod known;
mod words;

pub use words::Words;

use featherbench_bench::alone::Ask;
use featherbench_bench::{Asked, Cell, Engine, HarnessError, NoAnswer, Outcome, Quantity, Robot, Study, Suite};
use featherbench_report::{Overview, Section};
use featherbench_results::{Row, RunInfo, Verdict, canonical_json};
use serde::de::DeserializeOwned;
use std::sync::Arc;

/// The study that a suite asks for, if it does; an error names file, line and key.
pub type Made = Result<Option<Box<dyn Study>>, HarnessError>;

/// Evaluates the reproduction of a name at the seeds from zero up to a number.
pub type Reproduce = Arc<dyn Fn(&str, u64) -> Result<Vec<f64>, NoAnswer> + Send + Sync>;

/// A study of the house.
pub struct Entry {
    /// Its name in rows and suites.
    pub name: &'static str,
    /// How it is made from a suite.
    pub make: fn(&Setup) -> Made,
    /// Its sections of the report of a run.
    pub sections: fn(&RunInfo, &[Row], &Overview) -> Vec<Section>,
    /// What its names in rows mean.
    pub words: Words,
}

/// The rows of some studies are in the verdict, in the section of another study and in the tables of rows alone.
pub fn no_section(_: &RunInfo, _: &[Row], _: &Overview) -> Vec<Section> {
    Vec::new()
}

/// The rows of a study, and the chunk of the first; `None` if the run has none.
pub fn rows_of<'a>(rows: &'a [Row], study: &str, overview: &Overview<'a>) -> Option<(Vec<&'a Row>, String)> {
    let rows: Vec<&Row> = rows.iter().filter(|row| row.study == study).collect();
    let chunk = overview.chunk_of(rows.first()?);
    Some((rows, chunk))
}

/// What studies are made from.
pub struct Setup<'a> {
    /// The suite, whose tables are the studies' settings.
    pub suite: &'a Suite,
    /// Whether the engines themselves are asked.
    pub live: bool,
    /// The hash of this program.
    pub program: &'a str,
    /// Evaluates reproductions of known deviations.
    pub reproduce: Reproduce,
    /// Measures a method in a process of its own.
    pub measure: Ask,
}

impl Setup<'_> {
    /// The study that `study` makes of a table of the suite, if the suite has the table.
    ///
    /// # Errors
    /// As [`Suite::settings`].
    pub fn made<T: DeserializeOwned, S: Study + 'static>(&self, table: &str, study: impl FnOnce(T) -> S) -> Made {
        Ok(self.suite.settings(table)?.map(|settings| Box::new(study(settings)) as _))
    }
}

/// A row with the fields of its cell and robot; the study adds case, metric and value.
pub fn row(cell: &Cell, robot: &Robot) -> Row {
    Row {
        family: robot.family.clone(),
        robot: robot.name.clone(),
        nq: Some(robot.states.nq as u64),
        nv: Some(robot.states.nv as u64),
        bodies: Some(robot.description.bodies.len() as u64),
        depth: Some(robot.depth as u64),
        ..case_row(cell)
    }
}

/// The same of a cell that is about no robot of the suite: what it is about is the row's family.
pub fn case_row(cell: &Cell) -> Row {
    Row {
        cell: cell.id(),
        study: cell.study.clone(),
        family: cell.robot.clone(),
        params: canonical_json(&cell.params),
        engine: cell.engine.clone(),
        engine_version: cell.version.clone(),
        method: cell.method.clone(),
        precision: cell.scalar.clone(),
        quantity: cell.quantity.clone(),
        ..Row::default()
    }
}

/// The row of a cell without an answer: of this verdict where the engine does not offer it, and otherwise an error.
pub fn unanswered(blank: Row, no_answer: &NoAnswer, not_offered: Verdict) -> Row {
    let verdict = if matches!(no_answer, NoAnswer::NotOffered(_)) { not_offered } else { Verdict::Error };
    blank.without_value(verdict, no_answer.to_string())
}

/// Asks a cell's engine for its quantity at the robot's states.
pub fn evaluate(asked: &Asked) -> Outcome {
    let ask = || answer(asked.engine()?, asked.robot()?, asked.quantity()?, &asked.cell.method);
    ask().into()
}

/// Asks an engine for a quantity at a robot's states: one block of numbers for each state.
///
/// # Errors
/// What the engine says instead of an answer; [`NoAnswer::Failed`] if the numbers are not as many as are due.
pub fn answer(engine: &dyn Engine, robot: &Robot, quantity: Quantity, method: &str) -> Result<Vec<f64>, NoAnswer> {
    let count = robot.asked(quantity);
    let mut prepared = engine.prepare(robot, quantity, method, &robot.states)?;
    prepared.run(0..count)?;
    let (values, due) = (prepared.read().to_vec(), count * quantity.size(robot));
    // Otherwise fewer states would be compared without notice.
    as_many(values.len(), due)?;
    Ok(values)
}

/// Compares the count of the numbers that came with the count that is due.
///
/// # Errors
/// [`NoAnswer::Failed`] with both counts.
pub fn as_many(came: usize, due: usize) -> Result<(), NoAnswer> {
    if came == due { Ok(()) } else { Err(NoAnswer::Failed(format!("{came} numbers came, {due} are due"))) }
}
