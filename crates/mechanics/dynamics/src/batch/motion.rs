//! Motion in a batch: placements, velocities and accelerations of bodies, a Jacobian, and the momentum; and the inverse of M. The kernels
//! are those of single states, with a register of states as their scalar.

use super::kernels::{Kernel, Parameter, Workspace};
use super::run::Array;
use super::samples::{Models, Sharing};
use super::{Batch, BatchError, Element, Number};
use crate::error::expect;
use crate::{Crba, Error, Jacobian, Kinematics, Ltdl, Momentum};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Force, Part, Real};

/// The numbers of a body's motion: rotation, origin, velocity and acceleration.
const MOTION: usize = 9 + 3 + 6 + 6;
/// The numbers of a column of a Jacobian, and of a momentum.
const SIX: usize = 6;

/// The workspaces of motion. Each is made by the first call that needs it.
#[derive(Clone, Debug)]
pub(super) struct Motions<T> {
    kinematics: Option<Box<Kinematics<T>>>,
    jacobian: Option<Box<Jacobian<T>>>,
    momentum: Option<Box<Momentum<T>>>,
    inverse: Option<Box<(Crba<T>, Ltdl<T>)>>,
    /// The body of the Jacobian.
    pub(super) body: usize,
    result: Vec<T>,
}

impl<T: Real> Motions<T> {
    pub(super) fn new() -> Self {
        Self { kinematics: None, jacobian: None, momentum: None, inverse: None, body: 0, result: Vec::new() }
    }
}

impl<S: Number, M: Sharing> Batch<'_, S, M> {
    /// Placement, velocity and acceleration of every described body at configurations `q`, velocities `v` and accelerations `a`:
    /// [`Kinematics`] for each state.
    ///
    /// A body has 24 numbers in world axes: its rotation row by row, its origin, its velocity [ω; ṗ] and acceleration [ω̇; p̈].
    ///
    /// The first call makes a workspace for each core, and so allocates.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails. Also when each state has a model of its own, and a body's joint axis
    /// is a coordinate axis in some of them only.
    ///
    /// ```
    /// use featherbench_dynamics::Batch;
    /// use featherbench_model::Model;
    /// use featherbench_robots::{Family, StateBatch};
    ///
    /// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
    /// let states = StateBatch::random(&model, 20, 1);
    /// let mut motions = vec![0.0; 20 * 24 * model.described.len()];
    /// Batch::<f64>::new(&model).kinematics(&states.q, &states.v, &states.a, &mut motions)?;
    /// // The first body of each state is the floating base: its origin is in its configuration.
    /// let (q, base) = (states.q(19), &motions[19 * 24 * model.described.len()..]);
    /// assert!((0..3).all(|i| (base[9 + i] - q[i]).abs() < 1e-12));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn kinematics<E: Element<S>>(&mut self, q: &[E], v: &[E], a: &[E], motions: &mut [E]) -> Result<(), BatchError> {
        self.models.expect_same_labels()?;
        let (nv, bodies) = (self.nv(), self.models.described().len());
        let vectors = [self.q(q), Array::new("velocities v", v, nv), Array::new("accelerations a", a, nv)];
        self.run::<BodyMotions, E, 3>(self.inputs(vectors, None), Array::new("motions of bodies", motions, MOTION * bodies))
    }

    /// Jacobians of compiled body `body` at configurations `q`: [`Jacobian`] for each state.
    ///
    /// A state has six numbers per dof, column after column: [angular; linear] velocity of the body's origin in world axes, per unit of the dof.
    ///
    /// The first call makes a workspace for each core, and so allocates.
    ///
    /// # Errors
    /// [`BatchError`] when there is no such body, an array has the wrong length or a state fails.
    pub fn body_jacobian<E: Element<S>>(&mut self, q: &[E], body: usize, jacobians: &mut [E]) -> Result<(), BatchError> {
        let bodies = self.models.topology().bodies();
        if body >= bodies {
            expect("bodies, for the one that was named", body + 1, bodies)?;
        }
        self.workers_as_built().1.set_body(body);
        let each = SIX * self.nv();
        self.run::<BodyJacobian, E, 1>(self.inputs([self.q(q)], None), Array::new("Jacobians", jacobians, each))
    }

    /// Momenta about the centre of mass at configurations `q` and velocities `v`: [`Momentum`] for each state.
    ///
    /// A state has six numbers, [angular; linear] in world axes.
    ///
    /// The first call makes a workspace for each core, and so allocates.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn momentum<E: Element<S>>(&mut self, q: &[E], v: &[E], momenta: &mut [E]) -> Result<(), BatchError> {
        let vectors = [self.q(q), Array::new("velocities v", v, self.nv())];
        self.run::<OfMomentum, E, 2>(self.inputs(vectors, None), Array::new("momenta", momenta, SIX))
    }

    /// Inverses of the joint-space inertia matrices of configurations `q`: [`Crba`], then [`Ltdl::inverse`] for each state.
    ///
    /// A state has `nv`² numbers, row after row.
    ///
    /// The first call makes a workspace for each core, and so allocates.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    ///
    /// ```
    /// use featherbench_dynamics::Batch;
    /// use featherbench_model::Model;
    /// use featherbench_robots::{Family, StateBatch};
    ///
    /// let model: Model<f64> = Model::build(&Family::parse("chain:n=5,layout=spatial")?.generate()?)?;
    /// let states = StateBatch::random(&model, 20, 1);
    /// let (mut inverses, mut x) = (vec![0.0; 20 * 25], vec![0.0; 20 * 5]);
    /// let mut batch = Batch::<f64>::new(&model);
    /// batch.inverse_mass_matrix(&states.q, &mut inverses)?;
    /// batch.solve(&states.q, &states.tau, &mut x)?;
    /// let rows = inverses.chunks_exact(5).map(|row| row.to_vec()).zip(&x).enumerate();
    /// for (at, (row, x)) in rows {
    ///     let product: f64 = row.iter().zip(states.tau(at / 5)).map(|(n, tau)| n * tau).sum();
    ///     assert!((product - x).abs() < 1e-9 * (1.0 + x.abs()));
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inverse_mass_matrix<E: Element<S>>(&mut self, q: &[E], inverses: &mut [E]) -> Result<(), BatchError> {
        let nv = self.nv();
        self.run::<Inverse, E, 1>(self.inputs([self.q(q)], None), Array::new("inverses", inverses, nv * nv))
    }
}

/// The workspace of a first call.
fn made<'w, W>(place: &'w mut Option<Box<W>>, topology: &Topology, new: impl FnOnce(&Topology) -> W) -> &'w mut W {
    place.get_or_insert_with(|| Box::new(new(topology)))
}

struct BodyMotions;

impl Kernel<3> for BodyMotions {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v, a]: [&[T]; 3],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let Motions { kinematics, result, .. } = &mut workspace.motions;
        let kinematics = made(kinematics, &model.topology, Kinematics::new);
        let done = kinematics.run(model, q, v, a);
        result.clear();
        for motion in model.described.iter().filter_map(|&body| kinematics.body(body)) {
            result.extend_from_slice(&motion.placement.rotation.to_array());
            result.extend_from_slice(&motion.placement.translation.to_array());
            result.extend_from_slice(&motion.velocity.to_array());
            result.extend_from_slice(&motion.acceleration.to_array());
        }
        (result, done.map_err(Error::from))
    }
}

struct BodyJacobian;

impl Kernel<1> for BodyJacobian {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q]: [&[T]; 1],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let Motions { jacobian, result, body, .. } = &mut workspace.motions;
        let jacobian = made(jacobian, &model.topology, Jacobian::new);
        let done = jacobian.run(model, q, *body).map(|_| ());
        result.resize(SIX * jacobian.columns().len(), T::zero());
        for (numbers, column) in result.as_chunks_mut().0.iter_mut().zip(jacobian.columns()) {
            *numbers = column.to_array();
        }
        (result, done.map_err(Error::from))
    }
}

struct OfMomentum;

impl Kernel<2> for OfMomentum {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v]: [&[T]; 2],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let Motions { momentum, result, .. } = &mut workspace.motions;
        let done = made(momentum, &model.topology, Momentum::new).recurse(model, q, v);
        result.clear();
        match done {
            Ok(found) => {
                result.extend_from_slice(&found.momentum.to_array());
                (result, Ok(()))
            }
            Err(error) => (result, Err(error.into())),
        }
    }
}

struct Inverse;

impl Kernel<1> for Inverse {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q]: [&[T]; 1],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let Motions { inverse, result, .. } = &mut workspace.motions;
        let (crba, ltdl) = made(inverse, &model.topology, |topology| (Crba::new(topology), Ltdl::new(topology)));
        result.resize(model.topology.nv() * model.topology.nv(), T::zero());
        let done = crba.run(model, q, ltdl.matrix_mut()).map_err(Error::from).and_then(|()| {
            let factored = ltdl.factor();
            ltdl.inverse(result)?;
            Ok(factored?)
        });
        (result, done)
    }
}
