//! Many states of one robot at once: one state per lane of a register, and groups of states over the cores.
//!
//! The kernels are those of this crate, with a register of numbers ([`Number::Lanes`]) as their scalar. So the operations on each state are
//! those of a single state. Only sine and cosine come from another library: results differ by a few roundings.
//! Frames, units and signs are those of the kernels.
//!
//! An array holds one vector per state, in one of two orders. The type of its elements says which ([`Element`]):
//!
//! - *row order*, `&[f64]`: state after state. Its length is the number of states times the length of a vector.
//! - *lane order*, `&[wide::f64x8]` for example: group after group, one register per entry of the vector. Lane l of group g is state
//!   g·[`Number::LANES`] + l. At the width of the build nothing is copied, so this is the faster one. [`to_lanes`] and [`to_rows`] change the
//!   order.
//!
//! In row order lanes without a state compute a copy of the last state, and their results are dropped. In lane order every lane is a state:
//! [`to_lanes`] fills the last group with copies, which a list of failures may name too.
//!
//! External wrenches have six numbers per compiled body, moment and then force, in the described axes
//! ([`Model::labels`](featherbench_model::Model::labels)). So a vector of wrenches has 6·bodies entries.
//!
//! Cost: that of the kernel for each group of [`Number::LANES`] states.

mod derivatives;
mod error;
mod kernels;
mod lanes;
mod motion;
mod register;
mod run;
mod samples;
mod selected;
mod width;

pub use error::{BatchError, Cause, Failure};
pub use lanes::{Element, Number, to_lanes, to_rows};
pub use samples::{Sampled, Shared, Sharing};
pub use width::{NoSuchWidth, Width};

use crate::DimensionError;
use featherbench_model::Model;
use kernels::{BiasForce, Factors, ForwardDynamics, Inlined, InverseDynamics, Kernel, MassMatrix, RefinedForwardDynamics, Solution};
use run::{Array, AsBuilt, AtItsWidth, Inputs, WRENCH, Workers};
use samples::{Models, One, Samples};
use std::borrow::Cow;
use width::Selected;

/// Computes with many states of one robot, on one core or on all.
///
/// A state that fails is reported by its index, and NaN stands in place of its results. The other states' results are those that they have
/// without it, to the bit. The results do not depend on the number of cores.
///
/// On one core a call allocates only to report failures.
///
/// ```
/// use featherbench_dynamics::{Batch, BatchError};
/// use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model};
///
/// let joint = JointDescription { kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] }, ..JointDescription::default() };
/// let bob = BodyDescription { name: "bob".into(), parent: None, mass: 1.0, com: [0.0, 0.0, -0.5], inertia: [0.0; 6], joint };
/// let pendulum = Description { gravity: [0.0, 0.0, -10.0], bodies: vec![bob], ..Description::default() };
/// let model: Model<f64> = Model::build(&pendulum)?;
///
/// // The torques that hold a pendulum of one kilogramme and half a metre, at a hundred angles.
/// let q: Vec<f64> = (0..100).map(f64::from).collect();
/// let (rest, mut tau) = (vec![0.0; 100], vec![0.0; 100]);
/// let mut batch = Batch::<f64>::new(&model).on_all_cores();
/// batch.inverse_dynamics(&q, &rest, &rest, None, &mut tau)?;
/// assert!(q.iter().zip(&tau).all(|(q, tau)| (tau - 5.0 * q.sin()).abs() < 1e-14));
///
/// // One bad state does no harm to others.
/// let mut v = rest.clone();
/// v[17] = f64::NAN;
/// let Err(BatchError::Failed { failures, .. }) = batch.forward_dynamics(&q, &v, &tau, None, &mut vec![0.0; 100]) else { panic!() };
/// assert_eq!((failures.len(), failures[0].state), (1, 17));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Cost
///
/// Per revolute joint of a chain and group of states. Every operation is one of a whole register of states: eight with AVX-512, four with AVX2.
///
/// | | inverse dynamics | forward dynamics |
/// |---|---|---|
/// | operations | 171 | 446 |
/// | divisions among these | 0 | 1 |
/// | registers used of each body | 12 | 26 |
///
/// They are those of [`Rnea`](crate::Rnea) (146) and [`Aba`](crate::Aba) (421), 21 for sine and cosine, and 4 that look for numbers that are
/// not finite. The mass matrices of a chain of 36 take 582 operations per joint. A call with fewer states than a group costs what one with a
/// group costs. Of each body few registers are used, because a register of eight `f64` is a line of the cache. Times: `docs/kernels/batches.md`.
///
/// # Width
///
/// A build has the instructions of the processor that it is compiled for: for plain x86-64 that is SSE2, without fused multiply-add. So kernels
/// are compiled with AVX2 and with AVX-512 too, if the build is narrower, and a batch takes the widest that the processor has
/// ([`Width`], [`Batch::with_width`]). Derivatives and refined forward dynamics keep the instructions of the build.
///
/// Times of the widths: `docs/kernels/batches.md`.
///
/// *How*: a register of a selected width is a type over the processor's vectors. A kernel is a part of one function with that width's
/// instructions, and all that it calls is marked to be always inlined. In a debug build it is not, and a selected width is slow there.
#[derive(Clone, Debug)]
pub struct Batch<'m, S: Number = f64, M: Sharing = Shared> {
    models: M::Models<'m, S>,
    cores: usize,
    /// Of the width of the build. A batch of another width has them from its first call of a kernel that needs them on.
    as_built: Option<Workers<S::Lanes>>,
    selected: Selected<S>,
}

impl<'m, S: Number> Batch<'m, S, Shared> {
    /// States of one model, on one core, at the widest width. The precision `S` is that of the model: [`Model::lift`] makes a `Model<f32>`.
    pub fn new(model: &'m Model<S>) -> Self {
        Self::of(One(Cow::Borrowed(model)))
    }

    /// The same of a model that the batch keeps.
    pub fn of_model(model: Model<S>) -> Self {
        Self::of(One(Cow::Owned(model)))
    }
}

impl<'m, S: Number> Batch<'m, S, Sampled> {
    /// States of which each has a model of its own: state k is one of `samples[k]`. All have one topology. On one core.
    ///
    /// # Errors
    /// [`DimensionError`] when there is no sample, or the samples have not one topology.
    pub fn of_samples(samples: &'m [Model<S>]) -> Result<Self, DimensionError> {
        Ok(Self::of(Samples::new(samples)?))
    }
}

impl<'m, S: Number, M: Sharing> Batch<'m, S, M> {
    fn of(models: M::Models<'m, S>) -> Self {
        let mut batch = Self { models, cores: 1, as_built: None, selected: Selected::AsBuilt };
        // Without the widest width, which is there, the batch would have that of the build.
        batch.selected = Selected::new(Width::widest(), &batch.models, 1).unwrap_or(Selected::AsBuilt);
        batch.with_workers()
    }

    /// The same on all cores: with the threads that the current pool of `rayon` has now. Calls then allocate a little.
    #[must_use]
    pub fn on_all_cores(mut self) -> Self {
        self.cores = rayon::current_num_threads().max(1);
        self.selected.resize(self.cores);
        if let Some(workers) = &mut self.as_built {
            workers.resize(self.cores);
        }
        self
    }

    /// The same with the instructions of this width.
    ///
    /// Derivatives and refined forward dynamics have those of the build at every width.
    ///
    /// # Errors
    /// [`NoSuchWidth`] when this build or this processor does not have the width.
    ///
    /// ```
    /// use featherbench_dynamics::{Batch, Width};
    /// use featherbench_model::Model;
    /// use featherbench_robots::{Family, StateBatch};
    ///
    /// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
    /// let states = StateBatch::random(&model, 9, 1);
    /// assert_eq!(Batch::new(&model).width(), Width::widest());
    /// for width in Width::available() {
    ///     let mut tau = vec![0.0; states.v.len()];
    ///     Batch::new(&model).with_width(width)?.inverse_dynamics(&states.q, &states.v, &states.a, None, &mut tau)?;
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_width(mut self, width: Width) -> Result<Self, NoSuchWidth> {
        self.selected = Selected::new(width, &self.models, self.cores)?;
        Ok(self.with_workers())
    }

    /// The width of the batch.
    pub fn width(&self) -> Width {
        self.selected.width()
    }

    /// Makes the workers of the width of the build, if the batch has that width.
    fn with_workers(mut self) -> Self {
        if self.width() == Width::AsBuilt && self.as_built.is_none() {
            self.as_built = Some(Workers::new(&self.models, self.cores));
        }
        self
    }

    /// Joint forces `tau` of configurations `q`, velocities `v`, accelerations `a` and external wrenches: [`Rnea`](crate::Rnea) for each
    /// state.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn inverse_dynamics<E: Element<S>>(
        &mut self,
        q: &[E],
        v: &[E],
        a: &[E],
        wrenches: Option<&[E]>,
        tau: &mut [E],
    ) -> Result<(), BatchError> {
        let nv = self.nv();
        let vectors = [self.q(q), Array::new("velocities v", v, nv), Array::new("accelerations a", a, nv)];
        self.run_at_width::<InverseDynamics, E, 3>(self.inputs(vectors, wrenches), Array::new("joint forces tau", tau, nv))
    }

    /// Bias forces `h` of configurations `q` and velocities `v`: [`Bias`](crate::Bias) for each state. External wrenches enter as `−Σ Jᵀf`.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn bias_force<E: Element<S>>(&mut self, q: &[E], v: &[E], wrenches: Option<&[E]>, h: &mut [E]) -> Result<(), BatchError> {
        let nv = self.nv();
        let vectors = [self.q(q), Array::new("velocities v", v, nv)];
        self.run_at_width::<BiasForce, E, 2>(self.inputs(vectors, wrenches), Array::new("bias forces h", h, nv))
    }

    /// Accelerations `a` at configurations `q`, velocities `v`, joint forces `tau` and external wrenches: [`Aba`](crate::Aba) for each state.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn forward_dynamics<E: Element<S>>(
        &mut self,
        q: &[E],
        v: &[E],
        tau: &[E],
        wrenches: Option<&[E]>,
        a: &mut [E],
    ) -> Result<(), BatchError> {
        let nv = self.nv();
        let vectors = [self.q(q), Array::new("velocities v", v, nv), Array::new("joint forces tau", tau, nv)];
        self.run_at_width::<ForwardDynamics, E, 3>(self.inputs(vectors, wrenches), Array::new("accelerations a", a, nv))
    }

    /// The same to the last digit, by refinement in so many steps: [`Refined`](crate::Refined) for each state, with the residual in
    /// [`Compensated`](featherbench_spatial::Compensated) numbers of the precision `S`.
    ///
    /// The first call makes a workspace for each core, and so allocates.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn refined_forward_dynamics<E: Element<S>>(
        &mut self,
        q: &[E],
        v: &[E],
        tau: &[E],
        wrenches: Option<&[E]>,
        steps: usize,
        a: &mut [E],
    ) -> Result<(), BatchError> {
        let nv = self.nv();
        self.workers_as_built().1.set_steps(steps);
        let vectors = [self.q(q), Array::new("velocities v", v, nv), Array::new("joint forces tau", tau, nv)];
        self.run::<RefinedForwardDynamics, E, 3>(self.inputs(vectors, wrenches), Array::new("accelerations a", a, nv))
    }

    /// Joint-space inertia matrices of configurations `q`: [`Crba`](crate::Crba) for each state.
    ///
    /// A matrix has [`Topology::stored`](featherbench_model::Topology::stored) numbers, in the order of
    /// [`TreeSparse::values`](crate::TreeSparse::values).
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn mass_matrix<E: Element<S>>(&mut self, q: &[E], matrices: &mut [E]) -> Result<(), BatchError> {
        let stored = self.models.topology().stored();
        self.run_at_width::<MassMatrix, E, 1>(self.inputs([self.q(q)], None), Array::new("matrices", matrices, stored))
    }

    /// Factors LᵀDL of the joint-space inertia matrices of configurations `q`: [`Crba`](crate::Crba) and [`Ltdl`](crate::Ltdl) for each state.
    ///
    /// They have the shape of the matrices: L below the diagonal, D on it.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn factors<E: Element<S>>(&mut self, q: &[E], factors: &mut [E]) -> Result<(), BatchError> {
        let stored = self.models.topology().stored();
        self.run_at_width::<Factors, E, 1>(self.inputs([self.q(q)], None), Array::new("factors", factors, stored))
    }

    /// Solutions `x` of `M(q) x = b` by these factors, for configurations `q` and right-hand sides `b`.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn solve<E: Element<S>>(&mut self, q: &[E], b: &[E], x: &mut [E]) -> Result<(), BatchError> {
        let nv = self.nv();
        let vectors = [self.q(q), Array::new("right-hand sides b", b, nv)];
        self.run_at_width::<Solution, E, 2>(self.inputs(vectors, None), Array::new("solutions x", x, nv))
    }

    /// Runs a kernel on every state, at the width of the batch.
    fn run_at_width<K: Inlined<N>, E: Element<S>, const N: usize>(
        &mut self,
        inputs: Inputs<Array<&[E]>, N>,
        output: Array<&mut [E]>,
    ) -> Result<(), BatchError> {
        let models = &self.models;
        match &mut self.selected {
            Selected::AsBuilt => {
                let (models, workers) = self.workers_as_built();
                workers.run::<S, AtItsWidth<K>, E, N>(models, inputs, output)
            }
            Selected::Avx2(workers) => workers.run::<S, AtItsWidth<K>, E, N>(models, inputs, output),
            Selected::Avx512(workers) => workers.run::<S, AtItsWidth<K>, E, N>(models, inputs, output),
        }
    }

    /// Runs a kernel on every state, at the width of the build.
    fn run<K: Kernel<N>, E: Element<S>, const N: usize>(
        &mut self,
        inputs: Inputs<Array<&[E]>, N>,
        output: Array<&mut [E]>,
    ) -> Result<(), BatchError> {
        let (models, workers) = self.workers_as_built();
        workers.run::<S, AsBuilt<K>, E, N>(models, inputs, output)
    }

    /// The models, and the workers of the width of the build.
    fn workers_as_built(&mut self) -> (&M::Models<'m, S>, &mut Workers<S::Lanes>) {
        let Self { models, cores, as_built, .. } = self;
        let workers = as_built.get_or_insert_with(|| Workers::new(models, *cores));
        (models, workers)
    }

    fn nv(&self) -> usize {
        self.models.topology().nv()
    }

    fn q<'a, E>(&self, q: &'a [E]) -> Array<&'a [E]> {
        Array::new("configurations q", q, self.models.topology().nq())
    }

    fn inputs<'a, E, const N: usize>(&self, vectors: [Array<&'a [E]>; N], wrenches: Option<&'a [E]>) -> Inputs<Array<&'a [E]>, N> {
        let each = WRENCH * self.models.topology().bodies();
        Inputs { vectors, wrenches: wrenches.map(|wrenches| Array::new("external wrenches", wrenches, each)) }
    }
}
