//! The kernels of a batch in one form: vectors in, one vector out, and an error that leaves the other lanes' results valid.
//!
//! An [`Inlined`] kernel is a part of the function that calls it, with all that it calls. So it has the instructions that this function is
//! compiled for, and runs at every width. The others ([`Kernel`]) run at the width of the build.

use super::derivatives::Derivatives;
use super::motion::Motions;
use crate::{Aba, Crba, Error, Ltdl, Refined, Rnea};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Compensated, Force, Lift, Part, Real};

/// The workspaces of all kernels.
#[derive(Clone, Debug)]
pub struct Workspace<T> {
    rnea: Rnea<T>,
    aba: Aba<T>,
    crba: Crba<T>,
    ltdl: Ltdl<T>,
    /// Made by the first call that needs it: it is larger than all others.
    refined: Option<Refined<Compensated<T>, T>>,
    pub(super) derivatives: Derivatives<T>,
    pub(super) motions: Motions<T>,
    /// The steps of refinement.
    pub(super) steps: usize,
    /// The result, if it has one number per dof.
    vector: Vec<T>,
}

impl<T: Real> Workspace<T> {
    pub(super) fn new(topology: &Topology) -> Self {
        Self {
            rnea: Rnea::new(topology),
            aba: Aba::new(topology),
            crba: Crba::new(topology),
            ltdl: Ltdl::new(topology),
            refined: None,
            derivatives: Derivatives::new(),
            motions: Motions::new(),
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

/// A kernel of `N` input vectors as a [`Kernel`], for registers of every width.
pub trait Inlined<const N: usize> {
    /// Runs it. The function and all that it calls are marked to be always inlined.
    fn run<'w, T: Real, P: Real + Lift<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        inputs: [&[T]; N],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>);
}

pub(super) struct InverseDynamics;

impl Inlined<3> for InverseDynamics {
    #[inline(always)]
    fn run<'w, T: Real, P: Real + Lift<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v, a]: [&[T]; 3],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let done = workspace.rnea.recurse::<P, true>(model, q, v, a, wrenches, &mut workspace.vector);
        (&workspace.vector, done.map_err(Error::from))
    }
}

pub(super) struct BiasForce;

impl Inlined<2> for BiasForce {
    #[inline(always)]
    fn run<'w, T: Real, P: Real + Lift<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v]: [&[T]; 2],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let done = workspace.rnea.recurse::<P, false>(model, q, v, &[], wrenches, &mut workspace.vector);
        (&workspace.vector, done.map_err(Error::from))
    }
}

pub(super) struct ForwardDynamics;

impl Inlined<3> for ForwardDynamics {
    #[inline(always)]
    fn run<'w, T: Real, P: Real + Lift<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v, tau]: [&[T]; 3],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let done = workspace.aba.recurse(model, q, v, tau, wrenches, &mut workspace.vector);
        (&workspace.vector, done)
    }
}

pub(super) struct MassMatrix;

impl Inlined<1> for MassMatrix {
    #[inline(always)]
    fn run<'w, T: Real, P: Real + Lift<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q]: [&[T]; 1],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let matrix = workspace.ltdl.matrix_mut();
        let done = workspace.crba.recurse::<P, true>(model, q, matrix);
        (matrix.values(), done.map_err(Error::from))
    }
}

pub(super) struct Factors;

impl Inlined<1> for Factors {
    #[inline(always)]
    fn run<'w, T: Real, P: Real + Lift<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q]: [&[T]; 1],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let Workspace { crba, ltdl, .. } = workspace;
        let done = match crba.recurse::<P, true>(model, q, ltdl.matrix_mut()) {
            Ok(()) => ltdl.factor_registers().map_err(Error::from),
            Err(error) => Err(error.into()),
        };
        (ltdl.factors().values(), done)
    }
}

pub(super) struct Solution;

impl Inlined<2> for Solution {
    #[inline(always)]
    fn run<'w, T: Real, P: Real + Lift<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, b]: [&[T]; 2],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let Workspace { crba, ltdl, vector, .. } = workspace;
        vector.copy_from_slice(b);
        let done = match crba.recurse::<P, true>(model, q, ltdl.matrix_mut()) {
            Ok(()) => {
                let factored = ltdl.factor_registers().map_err(Error::from);
                ltdl.solve_registers(vector).map_err(Error::from).and(factored)
            }
            Err(error) => Err(error.into()),
        };
        (vector, done)
    }
}
