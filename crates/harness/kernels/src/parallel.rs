//! Our kernels for one large robot on all threads of the current pool of `rayon`.
//!
//! `featherbench alone` measures them. Other studies do not ask them: most of their robots are too small to be divided, and their kernels run on
//! one pinned core.

use crate::kernel::{Fill, Kernel, kept, matrices, written};
use featherbench_bench::NoAnswer;
use featherbench_dynamics::{ParallelAba, ParallelCrba, ParallelLtdl, ParallelRnea, Twisted};
use featherbench_model::{Model, Topology};
use featherbench_robots::StateBatch;

/// That the method does this robot, which has two bodies on the same one, or on the world.
fn divisible(topology: &Topology) -> Result<(), NoAnswer> {
    // In depth-first order a body that is not on the one before it is beside another.
    let branches = topology.joints().iter().enumerate().any(|(body, joint)| joint.parent != body.checked_sub(1));
    branches.then_some(()).ok_or_else(|| NoAnswer::NotOffered("it divides a tree where it branches, and this one does not".into()))
}

pub(crate) fn inverse_dynamics<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    divisible(&model.topology)?;
    let mut rnea = ParallelRnea::new(&model.topology);
    Ok(written(model.topology.nv(), move |k, tau| Ok(rnea.run(model, states.q(k), states.v(k), states.a(k), None, tau)?)))
}

pub(crate) fn forward_dynamics<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    divisible(&model.topology)?;
    let mut aba = ParallelAba::new(&model.topology);
    Ok(written(model.topology.nv(), move |k, a| Ok(aba.run(model, states.q(k), states.v(k), states.tau(k), None, a)?)))
}

pub(crate) fn from_both_ends<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    let none = || NoAnswer::NotOffered("it does chains of one-dof joints, with a fixed or a free base".into());
    let mut twisted = Twisted::new(&model.topology).ok_or_else(none)?;
    Ok(written(model.topology.nv(), move |k, a| Ok(twisted.run(model, states.q(k), states.v(k), states.tau(k), None, a)?)))
}

/// The parts of the method `ltdl`, each on all threads but the solution.
pub(crate) fn by_factorization<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    let topology = &model.topology;
    divisible(topology)?;
    let (mut crba, mut rnea, mut ltdl) = (ParallelCrba::new(topology), ParallelRnea::new(topology), ParallelLtdl::new(topology));
    // The bias force is inverse dynamics without acceleration.
    let at_rest = vec![0.0; topology.nv()];
    Ok(written(topology.nv(), move |k, a| {
        crba.run(model, states.q(k), ltdl.matrix_mut())?;
        ltdl.factor()?;
        rnea.run(model, states.q(k), states.v(k), &at_rest, None, a)?;
        for (a, tau) in a.iter_mut().zip(states.tau(k)) {
            *a = tau - *a;
        }
        Ok(ltdl.factors().solve(a)?)
    }))
}

pub(crate) fn crba<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Fill<'a>, NoAnswer> {
    divisible(&model.topology)?;
    let mut crba = ParallelCrba::new(&model.topology);
    Ok(Box::new(move |matrix, k| Ok(crba.run(model, states.q(k), matrix)?)))
}

pub(crate) fn factorization<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    divisible(&model.topology)?;
    let matrices = matrices(model, states)?;
    let evaluate = move |ltdl: &mut ParallelLtdl, k: usize| {
        ltdl.matrix_mut().values_mut().copy_from_slice(&matrices[k % matrices.len()]);
        Ok(ltdl.factor()?)
    };
    Ok(kept(ParallelLtdl::new(&model.topology), evaluate, |ltdl, out| out.copy_from_slice(ltdl.factors().factors().values())))
}
