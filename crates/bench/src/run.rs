//! Runs a plan: accuracy cells on all cores, then exclusive ones alone. Each outcome is stored when it is known.

use crate::study::{Context, Finished, Study, by_robot};
use crate::{Cell, HarnessError, NoAnswer, Outcome, OutcomeStore};
use featherbench_results::Row;
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Shows the progress of a run.
pub trait Progress: Sync {
    /// `count` cells are about to be evaluated.
    fn begin(&self, phase: &str, count: usize);
    /// A cell begins.
    fn cell(&self, cell: &Cell);
    /// A cell is done.
    fn done(&self, cell: &Cell, outcome: &Outcome);
    /// The phase ends.
    fn end(&self);
}

/// Shows nothing.
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &str, _: usize) {}
    fn cell(&self, _: &Cell) {}
    fn done(&self, _: &Cell, _: &Outcome) {}
    fn end(&self) {}
}

/// The cells of a study that a filter accepts. If there are any, the cells that belong to no robot come with them.
pub fn plan(study: &dyn Study, context: &Context, keep: &(dyn Fn(&Cell) -> bool + Sync)) -> Vec<Cell> {
    let kept: Vec<Cell> = study.plan(context).into_iter().filter(|cell| keep(cell) || study.is_common(cell)).collect();
    if kept.iter().all(|cell| study.is_common(cell) && !keep(cell)) { Vec::new() } else { kept }
}

/// Evaluates the unfinished cells of a study, and returns all of them with their outcomes, in plan order.
///
/// # Errors
/// Only when an outcome cannot be stored. An engine that fails, or panics, is an outcome.
pub fn evaluate(
    study: &dyn Study,
    context: &Context,
    cells: Vec<Cell>,
    store: &OutcomeStore,
    progress: &dyn Progress,
) -> Result<Vec<Finished>, HarnessError> {
    let missing: Vec<&Cell> = cells.iter().filter(|cell| !store.contains(&cell.id())).collect();
    progress.begin(study.name(), missing.len());
    // One group per robot and engine, so that a process behind an engine builds each robot once.
    let mut groups: Vec<Vec<&Cell>> = Vec::new();
    for cell in missing {
        match groups.last_mut() {
            Some(group) if group[0].robot == cell.robot && group[0].engine == cell.engine => group.push(cell),
            _ => groups.push(vec![cell]),
        }
    }
    let work = |group: &Vec<&Cell>| -> Result<(), HarnessError> {
        for cell in group {
            progress.cell(cell);
            let outcome = guarded(study, context, cell);
            progress.done(cell, &outcome);
            store.insert(cell, outcome)?;
        }
        Ok(())
    };
    if study.exclusive() {
        groups.iter().try_for_each(work)?
    } else {
        groups.par_iter().with_max_len(1).try_for_each(work)?
    }
    progress.end();
    Ok(cells
        .into_iter()
        .map(|cell| {
            let lost = || Outcome::NoAnswer(NoAnswer::Failed("the outcome was not kept".into()));
            let outcome = store.get(&cell.id()).unwrap_or_else(lost);
            (cell, outcome)
        })
        .collect())
}

/// A panic in an engine or study is a failure of that cell alone.
fn guarded(study: &dyn Study, context: &Context, cell: &Cell) -> Outcome {
    catch_unwind(AssertUnwindSafe(|| study.evaluate(context, cell))).unwrap_or_else(|panic| {
        let message = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        Outcome::NoAnswer(NoAnswer::Failed(format!("internal error: {}", message.unwrap_or("panic without a message"))))
    })
}

/// Turns outcomes into rows: first those of no robot, then robot by robot on all cores, in the order of the robots.
pub fn compare(study: &dyn Study, context: &Context, finished: Vec<Finished>) -> Vec<Row> {
    let together = study.compare_all(context, &finished);
    let groups = by_robot(finished);
    let compared: Vec<Vec<Row>> = context
        .robots
        .par_iter()
        .map(|robot| groups.get(&robot.name).map_or_else(Vec::new, |group| study.compare(context, robot, group)))
        .collect();
    together.into_iter().chain(compared.into_iter().flatten()).collect()
}
