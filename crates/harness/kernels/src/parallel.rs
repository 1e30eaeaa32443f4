//! Our kernels for one large robot on all threads of the current pool of `rayon`.
//!
//! `featherbench alone` measures them. Other studies do not ask them: most of their robots are too small to be divided, and their kernels run on
//! one pinned core.

use crate::kernel::{Kernel, kept, matrices, written};
use featherbench_bench::{NoAnswer, Quantity, Robot};
use featherbench_dynamics::{ParallelAba, ParallelCrba, ParallelLtdl, ParallelRnea, TreeSparse, Twisted};
use featherbench_model::{Model, Topology};
use featherbench_robots::StateBatch;

/// The method that divides a chain.
const TWISTED: &str = "twisted";

/// The methods of each quantity.
pub(crate) fn methods(quantity: Quantity) -> &'static [&'static str] {
    match quantity {
        Quantity::InverseDynamics => &["rnea_parallel"],
        Quantity::ForwardDynamics => &["aba_parallel", TWISTED, "ltdl_parallel"],
        Quantity::MassMatrixSparse => &["crba_parallel"],
        Quantity::Factorization => &["ltdl_parallel"],
        _ => &[],
    }
}

/// The kernel of a quantity and method, of [`methods`].
///
/// # Errors
/// [`NoAnswer::NotOffered`] when the method does not do this robot, and [`NoAnswer::Failed`] when it has no mass matrix.
pub(crate) fn kernel<'a>(robot: &'a Robot, quantity: Quantity, method: &str, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    let model = &robot.model;
    if method != TWISTED && !branches(&model.topology) {
        return Err(NoAnswer::NotOffered("it divides a tree where it branches, and this one does not".into()));
    }
    match (quantity, method) {
        (Quantity::InverseDynamics, "rnea_parallel") => Ok(inverse_dynamics(model, states)),
        (Quantity::ForwardDynamics, "aba_parallel") => Ok(forward_dynamics(model, states)),
        (Quantity::ForwardDynamics, TWISTED) => from_both_ends(model, states),
        (Quantity::ForwardDynamics, "ltdl_parallel") => Ok(by_factorization(model, states)),
        (Quantity::MassMatrixSparse, "crba_parallel") => Ok(mass_matrix(model, states)),
        (Quantity::Factorization, "ltdl_parallel") => factorization(model, states),
        _ => Err(NoAnswer::NotOffered(format!("there is no own method of {} by {method}", quantity.name()))),
    }
}

/// Whether two bodies are on the same one, or on the world.
fn branches(topology: &Topology) -> bool {
    // In depth-first order a body that is not on the one before it is beside another.
    topology.joints().iter().enumerate().any(|(body, joint)| joint.parent != body.checked_sub(1))
}

fn inverse_dynamics<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let mut rnea = ParallelRnea::new(&model.topology);
    written(model.topology.nv(), move |k, tau| Ok(rnea.run(model, states.q(k), states.v(k), states.a(k), None, tau)?))
}

fn forward_dynamics<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let mut aba = ParallelAba::new(&model.topology);
    written(model.topology.nv(), move |k, a| Ok(aba.run(model, states.q(k), states.v(k), states.tau(k), None, a)?))
}

fn from_both_ends<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    let none = || NoAnswer::NotOffered("it does chains of one-dof joints, with a fixed or a free base".into());
    let mut twisted = Twisted::new(&model.topology).ok_or_else(none)?;
    Ok(written(model.topology.nv(), move |k, a| Ok(twisted.run(model, states.q(k), states.v(k), states.tau(k), None, a)?)))
}

/// The parts of the method `ltdl`, each on all threads but the solution.
fn by_factorization<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let topology = &model.topology;
    let (mut crba, mut rnea, mut ltdl) = (ParallelCrba::new(topology), ParallelRnea::new(topology), ParallelLtdl::new(topology));
    // The bias force is inverse dynamics without acceleration.
    let at_rest = vec![0.0; topology.nv()];
    written(topology.nv(), move |k, a| {
        crba.run(model, states.q(k), ltdl.matrix_mut())?;
        ltdl.factor()?;
        rnea.run(model, states.q(k), states.v(k), &at_rest, None, a)?;
        for (a, tau) in a.iter_mut().zip(states.tau(k)) {
            *a = tau - *a;
        }
        Ok(ltdl.factors().solve(a)?)
    })
}

fn mass_matrix<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Kernel<'a> {
    let mut crba = ParallelCrba::new(&model.topology);
    let evaluate = move |matrix: &mut TreeSparse<f64>, k: usize| Ok(crba.run(model, states.q(k), matrix)?);
    kept(TreeSparse::new(&model.topology), evaluate, |matrix, out| out.copy_from_slice(matrix.values()))
}

fn factorization<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    let matrices = matrices(model, states)?;
    let evaluate = move |ltdl: &mut ParallelLtdl, k: usize| {
        ltdl.matrix_mut().values_mut().copy_from_slice(&matrices[k % matrices.len()]);
        Ok(ltdl.factor()?)
    };
    Ok(kept(ParallelLtdl::new(&model.topology), evaluate, |ltdl, out| out.copy_from_slice(ltdl.factors().factors().values())))
}
