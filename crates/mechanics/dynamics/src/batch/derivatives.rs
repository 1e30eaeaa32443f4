//! Derivatives in a batch: the kernels of `derivatives/` with a register of states as their scalar.
//!
//! A kernel of a batch has one vector as its result. So the parts of a derivative stand one after the other.

use super::kernels::{Kernel, Parameter, Workspace};
use super::run::Array;
use super::samples::{Models, Sharing};
use super::{Batch, BatchError, Element, Number};
use crate::{Coriolis, Error, FdDerivatives, IdDerivatives, IdPartials, PARAMETERS, Regressor, RegressorMatrix, TreePair};
use featherbench_model::Model;
use featherbench_spatial::{Force, Part, Real};

/// The workspaces of derivatives. Each is made by the first call that needs it: together they are larger than all others.
#[derive(Clone, Debug)]
pub(super) struct Derivatives<T> {
    id: Option<Box<(IdDerivatives<T>, IdPartials<T>)>>,
    fd: Option<Box<FdDerivatives<T>>>,
    coriolis: Option<Box<(Coriolis<T>, TreePair<T>)>>,
    regressor: Option<Box<(Regressor<T>, RegressorMatrix<T>)>>,
    /// The parts of a result, one after the other.
    parts: Vec<T>,
}

impl<T: Real> Derivatives<T> {
    pub(super) fn new() -> Self {
        Self { id: None, fd: None, coriolis: None, regressor: None, parts: Vec::new() }
    }

    /// Puts the parts together.
    fn join(&mut self, parts: &[&[T]]) {
        self.parts.clear();
        for part in parts {
            self.parts.extend_from_slice(part);
        }
    }
}

impl<S: Number, M: Sharing> Batch<'_, S, M> {
    /// Derivatives of inverse dynamics at configurations `q`, velocities `v`, accelerations `a` and external wrenches:
    /// [`IdDerivatives`](crate::IdDerivatives) for each state.
    ///
    /// A state has five times [`Topology::stored`](featherbench_model::Topology::stored) numbers: the lower and the upper triangle of ∂τ/∂q,
    /// those of ∂τ/∂v ([`TreePair::lower`](crate::TreePair::lower)), and M.
    ///
    /// The first call makes a workspace for each core, and so allocates.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn id_derivatives<E: Element<S>>(
        &mut self,
        q: &[E],
        v: &[E],
        a: &[E],
        wrenches: Option<&[E]>,
        partials: &mut [E],
    ) -> Result<(), BatchError> {
        let (nv, stored) = (self.nv(), self.models.topology().stored());
        let vectors = [self.q(q), Array::new("velocities v", v, nv), Array::new("accelerations a", a, nv)];
        self.run::<OfInverseDynamics, E, 3>(self.inputs(vectors, wrenches), Array::new("derivatives", partials, 5 * stored))
    }

    /// Derivatives of forward dynamics at configurations `q`, velocities `v`, joint forces `tau` and external wrenches:
    /// [`FdDerivatives`](crate::FdDerivatives) for each state.
    ///
    /// A state has `nv` + 3·`nv`² numbers: v̇, and ∂v̇/∂q, ∂v̇/∂v and ∂v̇/∂τ row after row.
    ///
    /// The first call makes a workspace for each core, and so allocates.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn fd_derivatives<E: Element<S>>(
        &mut self,
        q: &[E],
        v: &[E],
        tau: &[E],
        wrenches: Option<&[E]>,
        partials: &mut [E],
    ) -> Result<(), BatchError> {
        let nv = self.nv();
        let vectors = [self.q(q), Array::new("velocities v", v, nv), Array::new("joint forces tau", tau, nv)];
        self.run::<OfForwardDynamics, E, 3>(self.inputs(vectors, wrenches), Array::new("derivatives", partials, nv + 3 * nv * nv))
    }

    /// Coriolis matrices of configurations `q` and velocities `v`: [`Coriolis`](crate::Coriolis) for each state.
    ///
    /// A state has twice [`Topology::stored`](featherbench_model::Topology::stored) numbers: the lower and the upper triangle.
    ///
    /// The first call makes a workspace for each core, and so allocates.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails.
    pub fn coriolis_matrix<E: Element<S>>(&mut self, q: &[E], v: &[E], matrices: &mut [E]) -> Result<(), BatchError> {
        let (nv, stored) = (self.nv(), self.models.topology().stored());
        let vectors = [self.q(q), Array::new("velocities v", v, nv)];
        self.run::<CoriolisMatrix, E, 2>(self.inputs(vectors, None), Array::new("matrices", matrices, 2 * stored))
    }

    /// Torque regressors of configurations `q`, velocities `v` and accelerations `a`: [`Regressor`](crate::Regressor) for each state.
    ///
    /// A state has the numbers of [`RegressorMatrix::values`](crate::RegressorMatrix::values).
    ///
    /// The first call makes a workspace for each core, and so allocates.
    ///
    /// # Errors
    /// [`BatchError`] when an array has the wrong length or a state fails. Also when each state has a model of its own, and a body's joint axis
    /// is a coordinate axis in some of them only.
    pub fn torque_regressor<E: Element<S>>(&mut self, q: &[E], v: &[E], a: &[E], regressors: &mut [E]) -> Result<(), BatchError> {
        self.models.expect_same_labels()?;
        let topology = self.models.topology();
        let depth = |&body: &usize| {
            let joint = &topology.joints()[body];
            topology.dof_depth(joint.v + joint.kind.nv() - 1)
        };
        let each = PARAMETERS * self.models.described().iter().map(depth).sum::<usize>();
        let nv = self.nv();
        let vectors = [self.q(q), Array::new("velocities v", v, nv), Array::new("accelerations a", a, nv)];
        self.run::<TorqueRegressor, E, 3>(self.inputs(vectors, None), Array::new("regressors", regressors, each))
    }
}

struct OfInverseDynamics;

impl Kernel<3> for OfInverseDynamics {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v, a]: [&[T]; 3],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let all = &mut workspace.derivatives;
        let make = || Box::new((IdDerivatives::new(&model.topology), IdPartials::new(&model.topology)));
        let mut own = all.id.take().unwrap_or_else(make);
        let (kernel, partials) = &mut *own;
        let done = kernel.run(model, q, v, a, wrenches, partials);
        all.join(&[partials.q.lower(), partials.q.upper(), partials.v.lower(), partials.v.upper(), partials.a.values()]);
        all.id = Some(own);
        (&all.parts, done.map_err(Error::from))
    }
}

struct OfForwardDynamics;

impl Kernel<3> for OfForwardDynamics {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v, tau]: [&[T]; 3],
        wrenches: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let all = &mut workspace.derivatives;
        let nv = model.topology.nv();
        let kernel = all.fd.get_or_insert_with(|| Box::new(FdDerivatives::new(&model.topology)));
        all.parts.resize(nv + 3 * nv * nv, T::zero());
        let (a, squares) = all.parts.split_at_mut(nv);
        let (by_q, squares) = squares.split_at_mut(nv * nv);
        let (by_v, by_tau) = squares.split_at_mut(nv * nv);
        let done = kernel.write(model, q, v, tau, wrenches, [a, by_q, by_v, by_tau]);
        (&all.parts, done)
    }
}

struct CoriolisMatrix;

impl Kernel<2> for CoriolisMatrix {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v]: [&[T]; 2],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let all = &mut workspace.derivatives;
        let make = || Box::new((Coriolis::new(&model.topology), TreePair::new(&model.topology)));
        let mut own = all.coriolis.take().unwrap_or_else(make);
        let (kernel, matrix) = &mut *own;
        let done = kernel.run(model, q, v, matrix);
        all.join(&[matrix.lower(), matrix.upper()]);
        all.coriolis = Some(own);
        (&all.parts, done.map_err(Error::from))
    }
}

struct TorqueRegressor;

impl Kernel<3> for TorqueRegressor {
    fn run<'w, T: Part, P: Parameter<T>>(
        workspace: &'w mut Workspace<T>,
        model: &Model<P>,
        [q, v, a]: [&[T]; 3],
        _: Option<&[Force<T>]>,
    ) -> (&'w [T], Result<(), Error>) {
        let make = || Box::new((Regressor::new(&model.topology), RegressorMatrix::new(model)));
        let (kernel, matrix) = &mut **workspace.derivatives.regressor.get_or_insert_with(make);
        let done = kernel.torque(model, q, v, a, matrix);
        (matrix.values(), done.map_err(Error::from))
    }
}
