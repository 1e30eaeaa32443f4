//! Regressors: what is linear in the inertial parameters π, as a matrix times π. Joint forces, momenta, kinetic and potential energy.
//!
//! Sources: C. Atkeson, C. An & J. Hollerbach, *Estimation of inertial parameters of manipulator loads and links* (1986); the book, equation
//! of motion of a body. Order of π: as [`inertial_parameters`](crate::inertial_parameters) says. Without external wrenches
//!
//! ```text
//! ID = Y π + armature ∘ a      M v = Yₚ π + armature ∘ v      T = y_T·π + ½ v·(armature ∘ v)      V = y_V·π
//! ```
//!
//! A column of Y is `S_jᵀ` times the force that a unit parameter takes. With ω, ω̇ and the classical acceleration p̈ of the body's origin,
//! and u an axis of the body:
//!
//! | parameter | moment about the body's origin | force |
//! |---|---|---|
//! | mass | 0 | p̈ |
//! | first moment along u | u × p̈ | ω̇ × u + ω × (ω × u) |
//! | inertia E | E ω̇ + ω × E ω | 0 |
//!
//! Momenta have p̈ → ṗ, ω̇ → ω, and no products of velocities.
//!
//! Frame: one per tree, see `sweep.rs`. Shapes: q has `nq` numbers; v and a have `nv`; Y is `nv`×10·bodies. The entry of a dof and a body
//! can differ from zero only if the dof supports the body: stored are 10·Σ d_b numbers, d_b the depth of body b in dofs.
//! Units: SI. Cost: O(Σ d_b); 42 multiply-adds per stored ten. A call does not allocate.

use super::columns::{Columns, deepest, lanes};
use super::parameters::PARAMETERS;
use super::sweep::{Link, Sweep};
use crate::error::expect;
use crate::{DimensionError, State};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Force, Lift, Mat3, Motion, Real, Vec3};
use nalgebra::{DMatrix, Scalar};

/// A regressor: one row per dof, ten columns per described body.
#[derive(Clone, Debug, PartialEq)]
pub struct RegressorMatrix<T> {
    /// Body after body, parameter after parameter: the entries of the dofs from the root to the body. Some zeros stand behind.
    values: Vec<T>,
    bodies: Vec<Body>,
    nv: usize,
}

/// Where a described body's columns are.
#[derive(Clone, Debug, PartialEq)]
struct Body {
    /// Its index in the compiled model.
    compiled: usize,
    start: usize,
    /// The dofs that support it, from the root.
    dofs: Vec<usize>,
}

impl<T: Real> RegressorMatrix<T> {
    /// The zero regressor of a model.
    pub fn new<P>(model: &Model<P>) -> Self {
        let topology = &model.topology;
        let mut start = 0;
        let body = |&compiled: &usize| {
            let joint = &topology.joints()[compiled];
            let dofs = topology.row_dofs(joint.v + joint.kind.nv() - 1).to_vec();
            let body = Body { compiled, start, dofs };
            start += PARAMETERS * body.dofs.len();
            body
        };
        let bodies = model.described.iter().map(body).collect();
        Self { values: vec![T::zero(); start + lanes::<T>()], bodies, nv: topology.nv() }
    }

    /// Rows: the number of dofs.
    pub fn rows(&self) -> usize {
        self.nv
    }

    /// Columns: ten per described body.
    pub fn columns(&self) -> usize {
        PARAMETERS * self.bodies.len()
    }

    /// The stored numbers: body after body, parameter after parameter, the dofs from the root to the body.
    pub fn values(&self) -> &[T] {
        &self.values[..self.stored()]
    }

    /// Entry of a dof and a column: zero where the dof does not support the body, or where there is no such entry.
    pub fn get(&self, dof: usize, column: usize) -> T {
        let (body, parameter) = (column / PARAMETERS, column % PARAMETERS);
        let Some(body) = self.bodies.get(body) else { return T::zero() };
        match body.dofs.binary_search(&dof) {
            Ok(position) => self.values[body.start + parameter * body.dofs.len() + position],
            Err(_) => T::zero(),
        }
    }

    /// `y = Y π`.
    ///
    /// # Errors
    /// [`DimensionError`] when `parameters` has not ten numbers per body, or `y` not one per dof.
    pub fn mul(&self, parameters: &[T], y: &mut [T]) -> Result<(), DimensionError> {
        expect("parameters", self.columns(), parameters.len())?;
        expect("joint forces", self.nv, y.len())?;
        y.fill(T::zero());
        for (column, dofs, entries) in self.iter() {
            for (&dof, entry) in dofs.iter().zip(entries) {
                y[dof] = entry.mul_add(parameters[column], y[dof]);
            }
        }
        Ok(())
    }

    /// `x = Yᵀ τ`.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not ten numbers per body, or `tau` not one per dof.
    pub fn mul_transposed(&self, tau: &[T], x: &mut [T]) -> Result<(), DimensionError> {
        expect("parameters", self.columns(), x.len())?;
        expect("joint forces", self.nv, tau.len())?;
        for (column, dofs, entries) in self.iter() {
            x[column] = dofs.iter().zip(entries).fold(T::zero(), |sum, (&dof, entry)| entry.mul_add(tau[dof], sum));
        }
        Ok(())
    }

    /// Writes the dense matrix, row after row, into `nv`·10·bodies numbers.
    ///
    /// # Errors
    /// [`DimensionError`] when `dense` has another length.
    pub fn write_dense(&self, dense: &mut [T]) -> Result<(), DimensionError> {
        let width = self.columns();
        expect("dense regressor", self.nv * width, dense.len())?;
        dense.fill(T::zero());
        for (column, dofs, entries) in self.iter() {
            for (&dof, entry) in dofs.iter().zip(entries) {
                dense[dof * width + column] = *entry;
            }
        }
        Ok(())
    }

    /// The dense matrix; it allocates.
    pub fn to_dense(&self) -> DMatrix<T>
    where
        T: Scalar,
    {
        DMatrix::from_fn(self.nv, self.columns(), |dof, column| self.get(dof, column))
    }

    fn stored(&self) -> usize {
        self.values.len() - lanes::<T>()
    }

    /// Column after column, in the order of [`RegressorMatrix::values`]: its index, the dofs from the root to its body, and their entries.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &[usize], &[T])> {
        self.bodies.iter().enumerate().flat_map(|(b, body)| {
            let rows = self.values[body.start..].chunks_exact(body.dofs.len()).take(PARAMETERS);
            rows.enumerate().map(move |(parameter, entries)| (PARAMETERS * b + parameter, &body.dofs[..], entries))
        })
    }
}

/// The workspace of regressors.
#[derive(Clone, Debug)]
pub struct Regressor<T> {
    sweep: Sweep<T>,
    /// S of the dofs on the path to the root.
    path: Columns<T>,
}

impl<T: Real> Regressor<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self { sweep: Sweep::new(topology), path: Columns::new(deepest(topology)) }
    }

    /// The regressor of joint forces: `ID(q, v, a) = Y π + armature ∘ a`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument, the workspace or `regressor` does not fit the model.
    #[inline(never)]
    pub fn torque<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        a: &[T],
        regressor: &mut RegressorMatrix<T>,
    ) -> Result<(), DimensionError> {
        self.sweep.run::<P, true, true>(model, State { q, v, given: a, wrenches: None })?;
        self.fill(model, regressor, |link, axes, _| torque_columns(link, axes))
    }

    /// The regressor of momenta: `M(q) v = Yₚ π + armature ∘ v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument, the workspace or `regressor` does not fit the model.
    #[inline(never)]
    pub fn momentum<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        regressor: &mut RegressorMatrix<T>,
    ) -> Result<(), DimensionError> {
        self.sweep.run::<P, true, false>(model, State { q, v, given: &[], wrenches: None })?;
        self.fill(model, regressor, momentum_columns)
    }

    /// The regressors of energy: `T = y_T·π + ½ v·(armature ∘ v)` and `V = y_V·π`, each with ten numbers per described body.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
    pub fn energy<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        kinetic: &mut [T],
        potential: &mut [T],
    ) -> Result<(), DimensionError> {
        let columns = PARAMETERS * model.described.len();
        expect("regressor of kinetic energy", columns, kinetic.len())?;
        expect("regressor of potential energy", columns, potential.len())?;
        self.sweep.run::<P, true, false>(model, State { q, v, given: &[], wrenches: None })?;
        let (mut origin, mut drift) = (Vec3::zero(), Vec3::zero());
        let (zero, half, g) = (T::zero(), T::from_f64(0.5), model.gravity.lift());
        let (mut kinetic, mut potential) = (kinetic.chunks_exact_mut(PARAMETERS), potential.chunks_exact_mut(PARAMETERS));
        let mut described = model.described.iter().peekable();
        for (i, joint) in model.topology.joints().iter().enumerate() {
            let link = &self.sweep.links[i];
            if joint.parent.is_none() {
                (origin, drift) = (model.joint_transform(i, q).translation, -link.parent_v.lin);
            }
            if described.next_if(|&&body| body == i).is_none() {
                continue;
            }
            let r = model.labels[i].rotation_to_described(link.place.rotation);
            let (p, omega) = (link.place.translation, r.transpose_mul(link.v.ang));
            let velocity = link.v.lin + link.v.ang.cross(p) + drift;
            // 2T = m ṗ·ṗ + 2 h·(ṗ × ω) + ω·Ī ω, in the axes of the body
            let swing = r.transpose_mul(velocity).cross(omega);
            let Vec3 { x, y, z } = omega;
            let values =
                [half * velocity.dot(velocity), swing.x, swing.y, swing.z, half * x * x, x * y, x * z, half * y * y, y * z, half * z * z];
            kinetic.next().into_iter().flatten().zip(values).for_each(|(slot, value)| *slot = value);
            // V = −m g·p − g·R h
            let fall = r.transpose_mul(g);
            let values = [-g.dot(origin + p), -fall.x, -fall.y, -fall.z, zero, zero, zero, zero, zero, zero];
            potential.next().into_iter().flatten().zip(values).for_each(|(slot, value)| *slot = value);
        }
        Ok(())
    }

    /// Fills a regressor with `S_jᵀ` times ten forces per body, that `columns` makes of the body, its described axes, and the velocity of
    /// its tree's frame.
    #[inline(always)]
    fn fill<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        regressor: &mut RegressorMatrix<T>,
        columns: impl Fn(&Link<T>, Mat3<T>, Vec3<T>) -> [Force<T>; PARAMETERS],
    ) -> Result<(), DimensionError> {
        let agreeing = regressor.bodies.iter().zip(&model.described).filter(|(body, compiled)| body.compiled == **compiled).count();
        expect("described bodies of the regressor", model.described.len(), regressor.bodies.len())?;
        expect("described bodies of the regressor that are the model's", model.described.len(), agreeing)?;
        expect("dofs of the regressor", model.topology.nv(), regressor.nv)?;
        let mut drift = Vec3::zero();
        let mut described = regressor.bodies.iter().peekable();
        for (i, joint) in model.topology.joints().iter().enumerate() {
            let link = &self.sweep.links[i];
            if joint.parent.is_none() {
                drift = -link.parent_v.lin;
            }
            let top = model.topology.dof_depth(joint.v) - 1;
            for k in 0..joint.kind.nv() {
                let s: Motion<T> = joint.kind.column(&model.subspaces[i], k);
                self.path.set(top + k, link.in_frame(joint.kind, s));
            }
            let Some(body) = described.next_if(|body| body.compiled == i) else { continue };
            expect("dofs that support a body of the regressor", top + joint.kind.nv(), body.dofs.len())?;
            let axes = model.labels[i].rotation_to_described(link.place.rotation);
            let (depth, padded) = (body.dofs.len(), body.dofs.len().next_multiple_of(lanes::<T>()));
            for (parameter, force) in columns(link, axes, drift).into_iter().enumerate() {
                // Whole registers: what is written behind a row belongs to later rows, or to the zeros at the end.
                let row = &mut regressor.values[body.start + parameter * depth..][..padded];
                if parameter < 4 { self.path.dot(force, row) } else { self.path.ang.dot(force.ang, row) }
            }
        }
        let stored = regressor.stored();
        regressor.values[stored..].fill(T::zero());
        Ok(())
    }
}

/// The forces that unit parameters take, in the tree's frame at its origin.
#[inline(always)]
fn torque_columns<T: Real>(link: &Link<T>, axes: Mat3<T>) -> [Force<T>; PARAMETERS] {
    let (p, omega, alpha) = (link.place.translation, link.v.ang, link.a.ang);
    // p̈ = a + ω̇ × p + ω × ṗ
    let velocity = omega.cross_add(p, link.v.lin);
    let acceleration = omega.cross_add(velocity, alpha.cross_add(p, link.a.lin));
    let swing = |u: Vec3<T>| omega.cross_add(omega.cross(u), alpha.cross(u));
    let (in_body, turn) = (axes.transpose_mul(alpha), axes.transpose_mul(omega));
    columns(axes, p, acceleration, swing, |e| turn.cross_add(e(turn), e(in_body)))
}

/// The momenta of unit parameters, in the tree's frame at its origin, at the velocity seen from the world.
#[inline(always)]
fn momentum_columns<T: Real>(link: &Link<T>, axes: Mat3<T>, drift: Vec3<T>) -> [Force<T>; PARAMETERS] {
    let (p, omega) = (link.place.translation, link.v.ang);
    let velocity = omega.cross_add(p, link.v.lin) + drift;
    let turn = axes.transpose_mul(omega);
    columns(axes, p, velocity, |u| omega.cross(u), |e| e(turn))
}

/// Ten columns: `rate` is that of the body's origin, `swing` the rate of a vector fixed in the body; `moment` is given a matrix E in body axes
/// as a function, and answers in body axes.
#[inline(always)]
fn columns<T: Real>(
    axes: Mat3<T>,
    p: Vec3<T>,
    rate: Vec3<T>,
    swing: impl Fn(Vec3<T>) -> Vec3<T>,
    moment: impl Fn(&dyn Fn(Vec3<T>) -> Vec3<T>) -> Vec3<T>,
) -> [Force<T>; PARAMETERS] {
    let (zero, turned) = (T::zero(), axes.transpose());
    let first = |u: Vec3<T>| {
        let force = swing(u);
        Force::new(p.cross_add(force, u.cross(rate)), force)
    };
    let inertia = |e: &dyn Fn(Vec3<T>) -> Vec3<T>| Force::new(axes * moment(e), Vec3::zero());
    [
        Force::new(p.cross(rate), rate),
        first(turned.x),
        first(turned.y),
        first(turned.z),
        inertia(&|w| Vec3::new(w.x, zero, zero)),
        inertia(&|w| Vec3::new(w.y, w.x, zero)),
        inertia(&|w| Vec3::new(w.z, zero, w.x)),
        inertia(&|w| Vec3::new(zero, w.y, zero)),
        inertia(&|w| Vec3::new(zero, w.z, w.y)),
        inertia(&|w| Vec3::new(zero, zero, w.z)),
    ]
}

/// The torque regressor in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn torque_regressor<T: Real, P: Real + Lift<T>>(
    model: &Model<P>,
    q: &[T],
    v: &[T],
    a: &[T],
) -> Result<RegressorMatrix<T>, DimensionError> {
    let mut regressor = RegressorMatrix::new(model);
    Regressor::new(&model.topology).torque(model, q, v, a, &mut regressor)?;
    Ok(regressor)
}
