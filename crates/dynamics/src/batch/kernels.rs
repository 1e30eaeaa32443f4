//! The kernels of a batch in one form: vectors in, one vector out, and an error that leaves the other lanes' results valid.

use super::derivatives::Derivatives;
use crate::{Aba, Bias, Crba, Error, Ltdl, Refined, Rnea};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Compensated, Force, Lift, Part, Real};

/// The workspaces of all kernels.
#[derive(Clone, Debug)]
pub(super) struct Workspace<T> {
    rnea: Rnea<T>,
    bias: Bias<T>,
    aba: Aba<T>,
    crba: Crba<T>,
    ltdl: Ltdl<T>,
    /// Made by the first call that needs it: it is larger than all others.
    refined: Option<Refined<Compensated<T>, T>>,
    pub(super) derivatives: Derivatives<T>,
    /// The steps of refinement.
    pub(super) steps: usize,
    /// The result, if it has one number per dof.
    vector: Vec<T>,
}

impl<T: Part> Workspace<T> {
    pub(super) fn new(topology: &Topology) -> Self {
        Self {
            rnea: Rnea::new(topology),
            bias: Bias::new(topology),
            aba: Aba::new(topology),
            crba: Crba::new(topology),
            ltdl: Ltdl::new(topology),
            refined: None,
            derivatives: Derivatives::new(),
            steps: 0,
            vector: vec![T::zero(); topology.nv()],
        }
    }
}

/// A parameter of a model for states in `T`.
pub(super) trait Parameter<T>: Real + Lift<T> + Lift<Compensated<T>> {}

impl<T, P: Real + Lift<T> + Lift<Compensated<T>>> Parameter<T> for P {}

/// A kernel of `N` input vectors, the first of them q. External wrenches may come with them, one per body in described axes.
///
/// The result is there also with [`Error::NotPositiveDefinite`]: lanes compute without regard to others, so only that of the lane with the
/// bad pivot means nothing.
pub(super) trait Kernel<const N: usize> {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        inputs: [&[T]; N],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>);
}

pub(super) struct InverseDynamics;

impl Kernel<3> for InverseDynamics {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v, a]: [&[T]; 3],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let done = workspace.rnea.run(model, q, v, a, wrenches, &mut workspace.vector);
        (&workspace.vector, done.map_err(Error::from))
    }
}

pub(super) struct BiasForce;

impl Kernel<2> for BiasForce {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v]: [&[T]; 2],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let done = workspace.bias.run(model, q, v, wrenches, &mut workspace.vector);
        (&workspace.vector, done.map_err(Error::from))
    }
}

pub(super) struct ForwardDynamics;

impl Kernel<3> for ForwardDynamics {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v, tau]: [&[T]; 3],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let done = workspace.aba.run(model, q, v, tau, wrenches, &mut workspace.vector);
        (&workspace.vector, done)
    }
}

pub(super) struct RefinedForwardDynamics;

impl Kernel<3> for RefinedForwardDynamics {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v, tau]: [&[T]; 3],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let Workspace { refined, steps, vector, .. } = workspace;
        let refined = refined.get_or_insert_with(|| Refined::new(&model.topology, *steps));
        refined.set_steps(*steps);
        let done = refined.run(model, q, v, tau, wrenches, vector);
        (vector, done)
    }
}

pub(super) struct MassMatrix;

impl Kernel<1> for MassMatrix {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q]: [&[T]; 1],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let matrix = workspace.ltdl.matrix_mut();
        let done = workspace.crba.run(model, q, matrix);
        (matrix.values(), done.map_err(Error::from))
    }
}

pub(super) struct Factors;

impl Kernel<1> for Factors {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q]: [&[T]; 1],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let Workspace { crba, ltdl, .. } = workspace;
        let done = crba.run(model, q, ltdl.matrix_mut()).map_err(Error::from).and_then(|()| Ok(ltdl.factor()?));
        (ltdl.factors().values(), done)
    }
}

pub(super) struct Solution;

impl Kernel<2> for Solution {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, b]: [&[T]; 2],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let Workspace { crba, ltdl, vector, .. } = workspace;
        vector.copy_from_slice(b);
        let done = crba.run(model, q, ltdl.matrix_mut()).map_err(Error::from).and_then(|()| {
            let factored = ltdl.factor();
            ltdl.solve(vector)?;
            Ok(factored?)
        });
        (vector, done)
    }
}
