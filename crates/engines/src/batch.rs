//! Our batched kernels as a method of a quantity: a state per lane of a register, on one core.
//!
//! The arrays are in row order, as users have them: bringing states into lanes and results out of them is part of the method.

use crate::kernel::{Evaluate, Failure, Kernel};
use featherbench_bench::Quantity;
use featherbench_dynamics::{Batch, BatchError, Number};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::Lift;

/// The most bytes of the results of one call, if it is more than one group of states: they stay in the first cache, as those of single
/// states do.
const RESULTS: usize = 32 << 10;
/// The most groups of a call. A call costs some ten nanoseconds, a group some hundred and more.
const GROUPS: usize = 8;

/// A batch with its states and the results of its last call.
struct Batched<'a, S: Number> {
    batch: Batch<'a, S>,
    quantity: Quantity,
    /// q, v, and a or τ, state after state, with the numbers of each. After the last state the first ones stand again, as many as a call
    /// takes: so a call may begin at any state.
    inputs: [(Vec<S>, usize); 3],
    results: Vec<S>,
    /// The numbers of one result.
    each: usize,
    /// The states of a call.
    together: usize,
}

/// In double precision.
pub(crate) fn double<'a>(model: &'a Model<f64>, states: &'a StateBatch, quantity: Quantity) -> Kernel<'a> {
    Box::new(Batched::new(Batch::new(model), model, states, quantity))
}

/// In single precision throughout, states and parameters rounded to it before.
pub(crate) fn single<'a>(model: &'a Model<f64>, states: &'a StateBatch, quantity: Quantity) -> Kernel<'a> {
    Box::new(Batched::<f32>::new(Batch::of_model(model.lift()), model, states, quantity))
}

impl<'a, S: Number + Lift<S::Lanes>> Batched<'a, S> {
    fn new(batch: Batch<'a, S>, model: &Model<f64>, states: &StateBatch, quantity: Quantity) -> Self {
        let topology = &model.topology;
        let each = if quantity == Quantity::MassMatrixSparse { topology.stored() } else { topology.nv() };
        let group = each.max(1) * S::LANES * size_of::<S>();
        let together = S::LANES * (RESULTS / group).clamp(1, GROUPS);
        let third = if quantity == Quantity::InverseDynamics { StateBatch::a } else { StateBatch::tau };
        let row = |of: fn(&StateBatch, usize) -> &[f64], each: usize| {
            let places = (0..states.count() + together).map(|place| place % states.count());
            (places.flat_map(|k| of(states, k).iter().map(|&x| S::from_f64(x))).collect(), each)
        };
        let inputs = [row(StateBatch::q, topology.nq()), row(StateBatch::v, topology.nv()), row(third, topology.nv())];
        Self { batch, quantity, inputs, results: vec![S::zero(); each * together], each, together }
    }

    /// Evaluates `count` states from `k` on.
    fn run(&mut self, k: usize, count: usize) -> Result<(), BatchError> {
        let [q, v, third] = self.inputs.each_ref().map(|(numbers, each)| &numbers[k * each..(k + count) * each]);
        let results = &mut self.results[..count * self.each];
        match self.quantity {
            Quantity::InverseDynamics => self.batch.inverse_dynamics(q, v, third, None, results),
            Quantity::Bias => self.batch.bias_force(q, v, None, results),
            Quantity::MassMatrixSparse => self.batch.mass_matrix(q, results),
            _ => self.batch.forward_dynamics(q, v, third, None, results),
        }
    }
}

impl<S: Number + Lift<S::Lanes>> Evaluate for Batched<'_, S> {
    /// Alone, so that no other state's failure is this one's.
    fn evaluate(&mut self, k: usize) -> Result<(), Failure> {
        Ok(self.run(k, 1)?)
    }

    fn together(&self) -> usize {
        self.together
    }

    fn sweep(&mut self, k: usize) -> Result<(), Failure> {
        Ok(self.run(k, self.together)?)
    }

    fn read(&self, out: &mut [f64]) {
        out.iter_mut().zip(&self.results).for_each(|(out, x)| *out = x.min_lane());
    }
}
