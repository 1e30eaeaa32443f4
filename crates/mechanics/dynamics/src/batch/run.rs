//! The way through a batch: groups of states are taken in turn by the workers, and a group in which a lane fails is examined.

use super::kernels::{Inlined, Kernel, Workspace};
use super::register::Register;
use super::samples::Models;
use super::{BatchError, Cause, Element, Failure, Number};
use crate::error::expect;
use crate::{DimensionError, Error};
use featherbench_model::Model;
use featherbench_spatial::{Force, Real};
use rayon::iter::{IntoParallelRefMutIterator, ParallelIterator};
use std::marker::PhantomData;
use std::sync::{Mutex, PoisonError};

/// The most groups that a worker takes at a time: taking costs some ten nanoseconds, a group some thousand and more.
const GROUPS: usize = 32;

/// Workers take a part of the states at least so often, so that none waits long for the last.
const PARTS_PER_WORKER: usize = 8;

/// The numbers of an external wrench: moment, then force.
pub(super) const WRENCH: usize = 6;

/// What one core needs.
#[derive(Clone, Debug)]
struct Worker<L> {
    workspace: Workspace<L>,
    /// The inputs of one group, if they have to be brought into lanes.
    inputs: Vec<L>,
    /// The external wrenches of one group, one per body.
    wrenches: Vec<Force<L>>,
}

/// What registers of one type need: a worker per core, and the models in lanes if each state has its own.
#[derive(Clone, Debug)]
pub(super) struct Workers<L> {
    workers: Vec<Worker<L>>,
    /// Group by group.
    packed: Vec<Model<L>>,
}

impl<L: Real> Workers<L> {
    /// For so many cores.
    pub(super) fn new<S: Number>(models: &impl Models<S>, cores: usize) -> Self
    where
        L: Register<S>,
    {
        let topology = models.topology();
        let bodies = topology.bodies();
        let inputs = vec![L::zero(); topology.nq() + 2 * topology.nv() + WRENCH * bodies];
        let worker = Worker { workspace: Workspace::new(topology), inputs, wrenches: vec![Force::zero(); bodies] };
        let mut workers = Self { workers: vec![worker], packed: models.pack() };
        workers.resize(cores);
        workers
    }

    /// Changes the number of cores.
    pub(super) fn resize(&mut self, cores: usize) {
        self.workers.truncate(cores);
        while self.workers.len() < cores {
            let worker = self.workers[0].clone();
            self.workers.push(worker);
        }
    }

    /// Refines in so many steps from now on.
    pub(super) fn set_steps(&mut self, steps: usize) {
        for worker in &mut self.workers {
            worker.workspace.steps = steps;
        }
    }

    /// Jacobians are those of this body from now on.
    pub(super) fn set_body(&mut self, body: usize) {
        for worker in &mut self.workers {
            worker.workspace.motions.body = body;
        }
    }
}

/// A kernel on registers `L`, for states that have one model and for states each of which has its own.
pub trait RunsOn<S, L, const N: usize> {
    fn run<'w>(
        workspace: &'w mut Workspace<L>,
        model: &Model<S>,
        inputs: [&[L]; N],
        wrenches: Option<&[Force<L>]>,
    ) -> (&'w [L], Result<(), Error>);

    fn run_each<'w>(
        workspace: &'w mut Workspace<L>,
        model: &Model<L>,
        inputs: [&[L]; N],
        wrenches: Option<&[Force<L>]>,
    ) -> (&'w [L], Result<(), Error>);
}

/// An [`Inlined`] kernel, with the instructions of the registers' width.
pub(super) struct AtItsWidth<K>(PhantomData<K>);

impl<S: Number, L: Register<S>, K: Inlined<N>, const N: usize> RunsOn<S, L, N> for AtItsWidth<K> {
    #[inline(always)]
    fn run<'w>(
        workspace: &'w mut Workspace<L>,
        model: &Model<S>,
        inputs: [&[L]; N],
        wrenches: Option<&[Force<L>]>,
    ) -> (&'w [L], Result<(), Error>) {
        L::run::<K, N>(workspace, model, inputs, wrenches)
    }

    #[inline(always)]
    fn run_each<'w>(
        workspace: &'w mut Workspace<L>,
        model: &Model<L>,
        inputs: [&[L]; N],
        wrenches: Option<&[Force<L>]>,
    ) -> (&'w [L], Result<(), Error>) {
        L::run_each::<K, N>(workspace, model, inputs, wrenches)
    }
}

/// A [`Kernel`], with the registers and the instructions of the build.
pub(super) struct AsBuilt<K>(PhantomData<K>);

impl<S: Number, K: Kernel<N>, const N: usize> RunsOn<S, S::Lanes, N> for AsBuilt<K> {
    #[inline(always)]
    fn run<'w>(
        workspace: &'w mut Workspace<S::Lanes>,
        model: &Model<S>,
        inputs: [&[S::Lanes]; N],
        wrenches: Option<&[Force<S::Lanes>]>,
    ) -> (&'w [S::Lanes], Result<(), Error>) {
        K::run(workspace, model, inputs, wrenches)
    }

    #[inline(always)]
    fn run_each<'w>(
        workspace: &'w mut Workspace<S::Lanes>,
        model: &Model<S::Lanes>,
        inputs: [&[S::Lanes]; N],
        wrenches: Option<&[Force<S::Lanes>]>,
    ) -> (&'w [S::Lanes], Result<(), Error>) {
        K::run(workspace, model, inputs, wrenches)
    }
}

/// An array of vectors of `each` entries, with its name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Array<A> {
    name: &'static str,
    numbers: A,
    each: usize,
}

impl<A> Array<A> {
    pub(super) fn new(name: &'static str, numbers: A, each: usize) -> Self {
        Self { name, numbers, each }
    }
}

/// What a kernel of `N` vectors is given.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<A, const N: usize> {
    pub(super) vectors: [A; N],
    /// External wrenches: [`WRENCH`] numbers per body.
    pub(super) wrenches: Option<A>,
}

impl<A, const N: usize> Inputs<A, N> {
    /// The same in another form.
    #[inline(always)]
    fn map<B>(self, mut form: impl FnMut(A) -> B) -> Inputs<B, N> {
        Inputs { vectors: self.vectors.map(&mut form), wrenches: self.wrenches.map(form) }
    }

    /// The vectors, then the wrenches.
    #[inline(always)]
    fn iter(&self) -> impl Iterator<Item = &A> {
        self.vectors.iter().chain(&self.wrenches)
    }
}

impl<T, const N: usize> Inputs<Vec<T>, N> {
    fn as_slices(&self) -> Inputs<&[T], N> {
        Inputs { vectors: self.vectors.each_ref().map(|vector| &vector[..]), wrenches: self.wrenches.as_deref() }
    }
}

impl<L: Real> Workers<L> {
    /// Runs a kernel on every state.
    pub(super) fn run<S: Number, K: RunsOn<S, L, N>, E: Element<S>, const N: usize>(
        &mut self,
        models: &impl Models<S>,
        inputs: Inputs<Array<&[E]>, N>,
        output: Array<&mut [E]>,
    ) -> Result<(), BatchError>
    where
        L: Register<S>,
    {
        let Self { workers, packed } = self;
        let states = count(models, &inputs, &output)?;

        let group_len = (output.each * L::LANES / E::STATES).max(1);
        let groups = states.div_ceil(L::LANES);
        let part = groups.div_ceil(PARTS_PER_WORKER * workers.len()).clamp(1, GROUPS);
        let parts = Mutex::new(output.numbers.chunks_mut(part * group_len).enumerate());
        let job = Job { models, packed: &packed[..], inputs, output: (output.name, output.each), states };
        let work = |worker: &mut Worker<L>| -> Result<Vec<Failure>, DimensionError> {
            let mut failures = Vec::new();
            loop {
                let next = parts.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some((index, results)) = next else { return Ok(failures) };
                for (k, results) in results.chunks_mut(group_len).enumerate() {
                    job.run_group::<S, K>(worker, index * part + k, results, &mut failures)?;
                }
            }
        };

        let failures = match &mut workers[..] {
            [worker] => work(worker)?,
            workers => side_by_side(workers, &work)?,
        };
        if failures.is_empty() { Ok(()) } else { Err(BatchError::Failed { failures: in_order(failures), states }) }
    }
}

/// What a worker does: groups, until none is left. The states that fail come back.
type Work<'a, L> = dyn Fn(&mut Worker<L>) -> Result<Vec<Failure>, DimensionError> + Sync + 'a;

/// Some work of all workers at once. It is compiled once for all kernels.
fn side_by_side<L: Real>(workers: &mut [Worker<L>], work: &Work<'_, L>) -> Result<Vec<Failure>, DimensionError> {
    let join = |mut a: Vec<Failure>, mut b| {
        a.append(&mut b);
        Ok(a)
    };
    workers.par_iter_mut().map(work).try_reduce(Vec::new, join)
}

fn in_order(mut failures: Vec<Failure>) -> Vec<Failure> {
    failures.sort_unstable_by_key(|failure| failure.state);
    failures
}

/// The number of states. Each array has one vector for each.
fn count<S: Number, E: Element<S>, const N: usize>(
    models: &impl Models<S>,
    inputs: &Inputs<Array<&[E]>, N>,
    output: &Array<&mut [E]>,
) -> Result<usize, DimensionError> {
    let q = &inputs.vectors[0];
    let vectors = match models.count() {
        Some(samples) => samples.div_ceil(E::STATES),
        None => q.numbers.len().div_ceil(q.each.max(1)),
    };
    for array in inputs.iter() {
        expect(array.name, vectors * array.each, array.numbers.len())?;
    }
    expect(output.name, vectors * output.each, output.numbers.len())?;
    Ok(models.count().unwrap_or(vectors * E::STATES))
}

/// A run of a kernel on many states.
struct Job<'a, M, L, E, const N: usize> {
    models: &'a M,
    /// The models in lanes, if each state has its own.
    packed: &'a [Model<L>],
    inputs: Inputs<Array<&'a [E]>, N>,
    /// The name of the output, and the entries of its vectors.
    output: (&'static str, usize),
    states: usize,
}

impl<M, L, E, const N: usize> Job<'_, M, L, E, N> {
    /// Runs the kernel on one group.
    fn run_group<S: Number, K: RunsOn<S, L, N>>(
        &self,
        worker: &mut Worker<L>,
        group: usize,
        results: &mut [E],
        failures: &mut Vec<Failure>,
    ) -> Result<(), DimensionError>
    where
        M: Models<S>,
        L: Register<S>,
        E: Element<S>,
    {
        let Worker { workspace, inputs, wrenches } = worker;
        let inputs = L::with_instructions(|| {
            let mut rest = &mut inputs[..];
            self.inputs.map(|array| {
                let (buffer, others) = std::mem::take(&mut rest).split_at_mut(array.each);
                rest = others;
                E::load(array.numbers, array.each, group, buffer)
            })
        });
        let (found, done) = self.models.run::<K, L, N>(self.packed, group, workspace, inputs, wrenches);
        if let Err(Error::Dimension(error)) = done {
            return Err(error);
        }
        L::with_instructions(|| E::store(found, results));
        if done.is_err() || !inputs.iter().all(|input| L::are_finite(input)) || !L::are_finite(found) {
            self.examine::<S, K>(workspace, wrenches, group, inputs, results, failures);
        }
        Ok(())
    }

    /// Finds the states of a group that fail, each alone: as copies of itself in all lanes, so that its operations are the same.
    #[cold]
    #[inline(never)]
    fn examine<S: Number, K: RunsOn<S, L, N>>(
        &self,
        workspace: &mut Workspace<L>,
        wrenches: &mut [Force<L>],
        group: usize,
        inputs: Inputs<&[L], N>,
        results: &mut [E],
        failures: &mut Vec<Failure>,
    ) where
        M: Models<S>,
        L: Register<S>,
        E: Element<S>,
    {
        let first = group * L::LANES;
        for state in first..(first + L::LANES).min(self.states) {
            let lane = state - first;
            let copies = inputs.map(|input| input.iter().map(|x| L::pack(|_| x.lanes()[lane])).collect::<Vec<_>>());
            let (found, done) = self.models.run_copies::<K, L, N>(state, workspace, copies.as_slices(), wrenches);
            let mut given = self.inputs.iter().zip(copies.iter());
            let bad_input = given.find_map(|(array, input)| {
                let (entry, value) = not_finite(input)?;
                Some(Cause::Input { array: array.name, entry, value })
            });
            let bad_pivot = match done {
                Err(Error::NotPositiveDefinite(pivot)) => Some(Cause::from(pivot)),
                _ => None,
            };
            let bad_result = || not_finite(found).map(|(entry, value)| Cause::Result { array: self.output.0, entry, value });
            if let Some(cause) = bad_input.or(bad_pivot).or_else(bad_result) {
                failures.push(Failure { state, cause });
                E::erase(results, self.output.1, lane);
            }
        }
    }
}

/// Whether all numbers in all lanes are finite: zero times a number is zero then, and NaN otherwise.
///
/// There are four sums, because additions to one wait for each other.
#[inline(always)]
pub(super) fn are_finite<T: Real>(registers: &[T]) -> bool {
    let zero = T::zero();
    let (fours, rest) = registers.as_chunks::<4>();
    let mut sums = [zero; 4];
    for four in fours {
        for (sum, x) in sums.iter_mut().zip(four) {
            *sum = x.mul_add(zero, *sum);
        }
    }
    let [a, b, c, d] = sums;
    let mut sum = (a + b) + (c + d);
    for x in rest {
        sum = x.mul_add(zero, sum);
    }
    !sum.min_lane().is_nan()
}

/// The first entry that is not finite, in registers with the same number in all lanes.
fn not_finite<T: Real>(registers: &[T]) -> Option<(usize, f64)> {
    registers.iter().map(|x| x.min_lane()).enumerate().find(|(_, value)| !value.is_finite())
}
