//! Other engines that factorize: what fills their factors, and how far these and their solutions are from M.
//!
//! The measures are those of `factor.rs`, and M is that of our own kernel. A library of linear algebra is given this M. An engine with
//! robots makes its own, so that its error has the difference of the two in it.

use super::{What, factor, tree};
use featherbench_bench::{Asked, Cell, Context, Engine, NoAnswer, Quantity, Robot};
use featherbench_results::Row;
use featherbench_study::as_many;

/// What other engines are asked.
const QUANTITIES: [Quantity; 3] = [Quantity::FactorEntries, Quantity::Factorization, Quantity::Solve];

/// The cells of the engines on a robot: each quantity by each method.
pub(super) fn cells<'a>(engines: &'a [&dyn Engine], study: &'a str, robot: &'a Robot) -> impl Iterator<Item = Cell> + 'a {
    engines.iter().flat_map(move |engine| {
        QUANTITIES.into_iter().flat_map(move |quantity| {
            let cell = move |method: String| Cell::new(study, robot, engine.identity(), quantity.name(), &method, What::Others);
            engine.methods(quantity).into_iter().map(cell)
        })
    })
}

/// The value of a cell at the robot's first state: fill-in, or an error.
///
/// # Errors
/// [`NoAnswer`] of the engine.
pub(super) fn value(asked: &Asked, robot: &Robot) -> Result<f64, NoAnswer> {
    let quantity = asked.quantity()?;
    let mut prepared = asked.engine()?.prepare(robot, quantity, &asked.cell.method, &robot.states)?;
    prepared.run(0..1)?;
    let answer = prepared.read();
    as_many(answer.len(), quantity.size(robot))?;
    match quantity {
        Quantity::FactorEntries => Ok(answer[0] - robot.model.topology.stored() as f64),
        Quantity::Factorization => factor::error_of_factors(robot, answer).map_err(NoAnswer::Failed),
        _ => factor::error_of_solution(robot, answer).map_err(NoAnswer::Failed),
    }
}

/// The row of a value; errors are per dof, as ours are.
pub(super) fn row(context: &Context, blank: Row, dofs: f64, value: f64) -> Row {
    let metric = |metric: &str| Row { metric: metric.into(), reference: super::rows::TRUTH.into(), ..blank.clone() };
    match Quantity::parse(&blank.quantity) {
        Some(Quantity::Factorization) => context.gates.judge(metric("factor_error_per_dof"), value / dofs, 1.0),
        Some(Quantity::Solve) => context.gates.judge(metric("solution_error_per_dof"), value / dofs, 1.0),
        _ => Row { reference: String::new(), ..metric("fill_in") }.informed(value),
    }
}

/// The engines of the settings that are there.
pub(super) fn engines<'a>(context: &'a Context, names: &[String]) -> Vec<&'a dyn Engine> {
    names.iter().filter_map(|name| context.engine(name)).collect()
}

/// A cell without an answer has the sizes of its robot.
pub(super) fn blank(context: &Context, cell: &Cell) -> Row {
    let sizes = context.robot(&cell.robot).map(tree::sizes);
    tree::row(context, cell, sizes.as_ref().map(|sizes| sizes.as_slice()))
}
