//! Our own derivatives as kernels of the registry.

use crate::kernel::{Kernel, kept, written};
use featherbench_bench::by_duals::{ByDuals, Columns, Point};
use featherbench_bench::{Quantity, Robot};
use featherbench_dynamics::{Coriolis, FdDerivatives, FdPartials, IdDerivatives, IdPartials, Regressor, RegressorMatrix, TreePair};
use featherbench_robots::StateBatch;

fn point(states: &StateBatch, k: usize) -> Point<'_, f64> {
    Point { q: states.q(k), v: states.v(k), a: states.a(k), tau: states.tau(k) }
}

/// A derivative by dual numbers through the kernels.
pub(crate) fn by_duals<'a>(robot: &'a Robot, states: &'a StateBatch, quantity: Quantity) -> Kernel<'a> {
    let mut duals = ByDuals::<f64>::new(robot.model.lift());
    written(quantity.size(robot), move |k, out| Ok(duals.run(quantity, point(states, k), out).map(|_| ())?))
}

/// The torque regressor, column after column.
pub(crate) fn columns<'a>(robot: &'a Robot, states: &'a StateBatch) -> Kernel<'a> {
    let mut columns = Columns::<f64>::new(robot.model.clone());
    written(Quantity::TorqueRegressor.size(robot), move |k, out| Ok(columns.run(point(states, k), out)?))
}

/// ∂ID/∂q or ∂ID/∂v; both and M are computed, as by other engines.
pub(crate) fn inverse_dynamics<'a>(robot: &'a Robot, states: &'a StateBatch, quantity: Quantity) -> Kernel<'a> {
    let model = &robot.model;
    let mut derivatives = IdDerivatives::new(&model.topology);
    let evaluate =
        move |partials: &mut IdPartials<f64>, k| Ok(derivatives.run(model, states.q(k), states.v(k), states.a(k), None, partials)?);
    let read = move |partials: &IdPartials<f64>, out: &mut [f64]| {
        let pair = if quantity == Quantity::InverseDynamicsDq { &partials.q } else { &partials.v };
        dense(pair, out);
    };
    kept(IdPartials::new(&model.topology), evaluate, read)
}

/// ∂FD/∂q or ∂FD/∂v; both and M⁻¹ are computed, as by other engines.
pub(crate) fn forward_dynamics<'a>(robot: &'a Robot, states: &'a StateBatch, quantity: Quantity) -> Kernel<'a> {
    let model = &robot.model;
    let mut derivatives = FdDerivatives::new(&model.topology);
    let evaluate =
        move |partials: &mut FdPartials<f64>, k| Ok(derivatives.run(model, states.q(k), states.v(k), states.tau(k), None, partials)?);
    let read = move |partials: &FdPartials<f64>, out: &mut [f64]| {
        out.copy_from_slice(if quantity == Quantity::ForwardDynamicsDq { &partials.q } else { &partials.v });
    };
    kept(FdPartials::new(&model.topology), evaluate, read)
}

/// The Coriolis matrix.
pub(crate) fn coriolis<'a>(robot: &'a Robot, states: &'a StateBatch) -> Kernel<'a> {
    let model = &robot.model;
    let mut coriolis = Coriolis::new(&model.topology);
    let evaluate = move |matrix: &mut TreePair<f64>, k| Ok(coriolis.run(model, states.q(k), states.v(k), matrix)?);
    kept(TreePair::new(&model.topology), evaluate, dense)
}

/// The torque regressor.
pub(crate) fn regressor<'a>(robot: &'a Robot, states: &'a StateBatch) -> Kernel<'a> {
    let model = &robot.model;
    let mut regressor = Regressor::new(&model.topology);
    let evaluate =
        move |matrix: &mut RegressorMatrix<f64>, k| Ok(regressor.torque(model, states.q(k), states.v(k), states.a(k), matrix)?);
    let read = |matrix: &RegressorMatrix<f64>, out: &mut [f64]| {
        let width = matrix.columns();
        out.iter_mut().enumerate().for_each(|(entry, x)| *x = matrix.get(entry / width, entry % width));
    };
    kept(RegressorMatrix::new(model), evaluate, read)
}

/// The whole matrix, row after row.
fn dense(pair: &TreePair<f64>, out: &mut [f64]) {
    let n = pair.size();
    out.iter_mut().enumerate().for_each(|(entry, x)| *x = pair.get(entry / n, entry % n));
}
