//! Forward dynamics by the articulated-body algorithm: the accelerations that joint forces cause, `v̇ = M⁻¹ (τ − h + Σ Jᵀf)`.
//!
//! Source: the book, table 7.1, with classical accelerations (see `step.rs`). Armature is added to the diagonal of D.
//! Frames: each body's quantities are in its own axes, as compiled, at its own origin. External wrenches [moment; force], one per compiled
//! body, are in the described axes ([`Model::labels`]).
//! Gravity enters as an acceleration −g of the base. Shapes: q has `nq` numbers; v, τ and v̇ have `nv`. Units: SI, angles in radians.
//! Cost: O(n), with one division per one-dof joint. A call does not allocate.
//!
//! `Inputs` has the three recursions, over a tree or a sub-tree. One body's part of each is a function here:
//!
//! | pass | function | what it computes, in the book's symbols |
//! |---|---|---|
//! | 1, outward | `set_moving` | X, ω, c, pᴬ = v ×* I v |
//! | 2, inward | `pass_to_parent` | Iᴬ_p += X* Iᵃ X⁻¹, pᴬ_p += X* pᵃ |
//! | 3, outward | `accelerate` | a' = X a_p + c, q̈, a = a' + S q̈ |
//!
//! What depends on the joint is in one file per kind: `aba/one_dof.rs`, `aba/spherical.rs` and `aba/free.rs`. Each has
//!
//! - `eliminate`: U = Iᴬ S, D = Sᵀ U + armature, u = τ − Sᵀ pᴬ; then Iᵃ = Iᴬ − U D⁻¹ Uᵀ and pᵃ = pᴬ + Iᵃ c + U D⁻¹ u.
//! - `apparent_force`: pᵃ alone, with c = 0 and U and D of the last run, for [`Aba::solve`].
//! - `acceleration`: q̈ = D⁻¹ (u − Uᵀ a').
//!
//! In the code U is `upper_u`, because `u` is the book's u.

use crate::error::{Pivot, expect};
use crate::step::{add_joint, by_kind, cross_joint, expect_workspace, expect_wrenches, newton_euler};
use crate::{DimensionError, Error};
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{ArticulatedInertia, Force, Ldl3, Lift, Mat3, Motion, Real, Sym3, Transform, Vec3};

pub(crate) mod free;
mod one_dof;
pub(crate) mod spherical;

/// The workspace of the articulated-body algorithm.
///
/// # Cost
///
/// Per revolute joint about z of its body, on a chain, counted with [`Counted`](featherbench_spatial::Counted):
///
/// | | multiply-adds | products | sums | divisions | sine and cosine |
/// |---|---|---|---|---|---|
/// | [`run`](Self::run) | 268 | 107 | 45 | 1 | 1 |
/// | [`solve`](Self::solve) | 46 | 15 | 16 | 0 | 0 |
///
/// Such a joint uses 26 of the 53 numbers of a body: the six of R that turn, c, pᴬ, U D⁻¹, D⁻¹ and D⁻¹ u. Its Iᴬ, ω and a are kept for the bodies
/// on one path only, because fewer lines of the cache are faster. Times: `docs/kernels/aba.md`.
#[derive(Clone, Debug)]
pub struct Aba<T> {
    /// Of each body.
    pub(crate) links: Vec<Link<T>>,
    /// Of the bodies on the path that a pass is on, by path slot ([`Joint::slot`](featherbench_model::Joint::slot)).
    pub(crate) path: Vec<OnPath<T>>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<T> {
    /// Placement in the parent: what [`JointKind::keep`] keeps of it.
    pub(crate) x: Transform<T>,
    /// Velocity-product acceleration c.
    c: Motion<T>,
    /// Bias force pᴬ.
    pub(crate) p: Force<T>,
    /// Of a one-dof joint: U D⁻¹, D⁻¹ and D⁻¹ u.
    u_d_inverse: Force<T>,
    d_inverse: T,
    d_inverse_u: T,
    /// Of a spherical or free joint: articulated-body inertia Iᴬ.
    inertia: ArticulatedInertia<T>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct OnPath<T> {
    /// Pass 1: angular velocity ω.
    pub(crate) omega: Vec3<T>,
    /// Pass 2: articulated-body inertia Iᴬ, as far as the children have been reached.
    pub(crate) inertia: ArticulatedInertia<T>,
    /// Pass 3: classical acceleration a.
    pub(crate) a: Motion<T>,
}

impl<T: Real> Link<T> {
    /// A link without motion and inertia.
    pub(crate) fn at_rest() -> Self {
        Self {
            x: Transform::identity(),
            c: Motion::zero(),
            p: Force::zero(),
            u_d_inverse: Force::zero(),
            d_inverse: T::zero(),
            d_inverse_u: T::zero(),
            inertia: ArticulatedInertia::zero(),
        }
    }
}

impl<T: Real> OnPath<T> {
    /// A body without motion and inertia.
    pub(crate) fn at_rest() -> Self {
        Self { omega: Vec3::zero(), inertia: ArticulatedInertia::zero(), a: Motion::zero() }
    }
}

impl<T: Real> Aba<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self { links: vec![Link::at_rest(); topology.bodies()], path: vec![OnPath::at_rest(); topology.slots()] }
    }

    /// The accelerations `a` at configuration `q`, velocity `v`, joint forces `tau` and external wrenches.
    ///
    /// # Errors
    /// [`Error`] when an argument or the workspace does not fit the model, or when a joint meets no inertia; `a` then means nothing.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        tau: &[T],
        wrenches: Option<&[Force<T>]>,
        a: &mut [T],
    ) -> Result<(), Error> {
        self.recurse(model, q, v, tau, wrenches, a)
    }

    /// [`Aba::run`] as a part of its caller, and so with the instructions that the caller is compiled for.
    #[inline(always)]
    pub(crate) fn recurse<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        tau: &[T],
        wrenches: Option<&[Force<T>]>,
        a: &mut [T],
    ) -> Result<(), Error> {
        let inputs = Inputs { model, q, v, tau, wrenches };
        self.expect_shapes(&inputs, a)?;
        let Self { links, path } = self;
        path[0].a.lin = -model.gravity.lift();

        let mut smallest = Pivot::none();
        inputs.outward(0, links, path);
        inputs.inward(0, links, path, None, &mut smallest);
        inputs.accelerate(0, links, path, a, &mut smallest);
        Ok(smallest.check()?)
    }

    /// The solution `x` of `M x = f`: the accelerations by joint forces alone, with v = 0 and no gravity.
    ///
    /// The configuration is that of the last successful run with this model. The articulated inertias of that run are used again. So a
    /// revolute joint takes 77 operations in place of 421.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
    pub fn solve<P: Real + Lift<T>>(&mut self, model: &Model<P>, f: &[T], x: &mut [T]) -> Result<(), DimensionError> {
        let Self { links, path } = self;
        expect_workspace(model, links.len(), path.len())?;
        expect("joint forces f", model.topology.nv(), f.len())?;
        expect("solution x", model.topology.nv(), x.len())?;
        let joints = model.topology.joints();
        path[0].a = Motion::zero();
        for link in links.iter_mut() {
            (link.p, link.c) = (Force::zero(), Motion::zero());
        }

        // inward: u = f − Sᵀ pᴬ,  pᴬ_p += X* (pᴬ + U D⁻¹ u)
        for (i, joint) in joints.iter().enumerate().rev() {
            let (before, rest) = links.split_at_mut(i);
            let parent = joint.parent.map(|parent| &mut before[parent]);
            by_kind!(T, joint.kind, pass_force_to_parent, model, i, f, &mut rest[0], parent);
        }

        // outward: as in a run, with v = 0. One that succeeded has left no pivot to judge.
        Inputs { model, q: &[], v: &[], tau: f, wrenches: None }.accelerate(0, links, path, x, &mut Pivot::none());
        Ok(())
    }

    /// The placement of body `i` in its parent, at the configuration of the last run with this model.
    #[inline(always)]
    pub(crate) fn placement<P: Real + Lift<T>>(&self, model: &Model<P>, i: usize) -> Transform<T> {
        model.topology.joints()[i].kind.recall(&model.placements[i], &self.links[i].x)
    }

    pub(crate) fn expect_shapes<P: Real>(&self, inputs: &Inputs<'_, P, T>, a: &[T]) -> Result<(), DimensionError> {
        expect_workspace(inputs.model, self.links.len(), self.path.len())?;
        inputs.expect_shapes(a)
    }
}

/// What the recursions read.
pub(crate) struct Inputs<'a, P, T> {
    pub(crate) model: &'a Model<P>,
    pub(crate) q: &'a [T],
    pub(crate) v: &'a [T],
    pub(crate) tau: &'a [T],
    pub(crate) wrenches: Option<&'a [Force<T>]>,
}

/// The recursions over consecutive bodies: `links` are those of the bodies from `first` on. All of the tree, or a sub-tree.
///
/// They are always inlined: for all of the tree, `first` is known to be 0.
impl<P: Real + Lift<T>, T: Real> Inputs<'_, P, T> {
    /// Pass 1, outward: `v_i = X v_p + S q̇`, `c_i`, `pᴬ = v_i ×* I v_i − f_ext`. The path begins with ω of the first body's parent.
    #[inline(always)]
    pub(crate) fn outward(&self, first: usize, links: &mut [Link<T>], path: &mut [OnPath<T>]) {
        for (i, link) in (first..).zip(links) {
            by_kind!(T, self.model.topology.joints()[i].kind, set_moving, self, i, path, link);
            self.subtract_wrench(i, link);
        }
    }

    /// `pᴬ −= f_ext`.
    #[inline(always)]
    pub(crate) fn subtract_wrench(&self, i: usize, link: &mut Link<T>) {
        if let Some(wrenches) = self.wrenches {
            link.p -= self.model.labels[i].force_to_compiled(wrenches[i]);
        }
    }

    /// Pass 2, inward: `Iᵃ = Iᴬ − U D⁻¹ Uᵀ`, `pᵃ = pᴬ + Iᵃ c + U D⁻¹ u`, `Iᴬ_p += X* Iᵃ X⁻¹`, `pᴬ_p += X* pᵃ`. The pᵃ that goes to a body
    /// before the first is added to `outside`.
    #[inline(always)]
    pub(crate) fn inward(
        &self,
        first: usize,
        links: &mut [Link<T>],
        path: &mut [OnPath<T>],
        mut outside: Option<&mut Force<T>>,
        smallest: &mut Pivot,
    ) {
        let joints = &self.model.topology.joints()[first..first + links.len()];
        for (k, joint) in joints.iter().enumerate().rev() {
            let (before, rest) = links.split_at_mut(k);
            let parent = match joint.parent.map(|parent| parent.checked_sub(first)) {
                Some(Some(parent)) => Some(&mut before[parent].p),
                Some(None) => outside.as_deref_mut(),
                None => None,
            };
            by_kind!(T, joint.kind, pass_to_parent, self, first + k, &mut rest[0], parent, path, smallest);
        }
    }

    /// Pass 3, outward: `a' = X a_p + c`, `q̈ = D⁻¹ (u − Uᵀ a')`, `a_i = a' + S q̈`. The path begins with a of the first body's parent, and
    /// `a` with the dofs of the first body.
    #[inline(always)]
    pub(crate) fn accelerate(&self, first: usize, links: &[Link<T>], path: &mut [OnPath<T>], a: &mut [T], smallest: &mut Pivot) {
        let joints = &self.model.topology.joints()[first..first + links.len()];
        let Some(first_dof) = joints.first().map(|joint| joint.v) else { return };
        for ((i, joint), link) in (first..).zip(joints).zip(links) {
            by_kind!(T, joint.kind, accelerate, self, i, &mut a[joint.v - first_dof..], link, path, smallest);
        }
    }
}

impl<P: Real, T: Real> Inputs<'_, P, T> {
    /// An error if an argument does not fit the model.
    pub(crate) fn expect_shapes(&self, a: &[T]) -> Result<(), DimensionError> {
        let topology = &self.model.topology;
        expect("configuration q", topology.nq(), self.q.len())?;
        expect("velocity v", topology.nv(), self.v.len())?;
        expect("joint forces tau", topology.nv(), self.tau.len())?;
        expect("acceleration a", topology.nv(), a.len())?;
        expect_wrenches(topology, self.wrenches)
    }
}

/// Pass 1 for one body: X, which is returned.
#[inline(always)]
pub(crate) fn place<T: Real, P: Real + Lift<T>>(kind: JointKind, inputs: &Inputs<'_, P, T>, i: usize, link: &mut Link<T>) -> Transform<T> {
    let Inputs { model, q, .. } = *inputs;
    let x = kind.transform(&model.placements[i], &model.subspaces[i], &q[model.topology.joints()[i].q..]);
    kind.keep(&x, &mut link.x);
    x
}

/// Pass 1 for one body that is placed at `x` in its parent: ω, c and pᴬ = v ×* I v.
#[inline(always)]
pub(crate) fn set_velocity<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    inputs: &Inputs<'_, P, T>,
    i: usize,
    x: &Transform<T>,
    path: &mut [OnPath<T>],
    link: &mut Link<T>,
) {
    let Inputs { model, v, .. } = *inputs;
    let (joint, subspace) = (&model.topology.joints()[i], &model.subspaces[i]);
    let joint_velocity = kind.motion(subspace, &v[joint.v..]);
    let (omega, c) = cross_joint(kind, x, path[joint.parent_slot].omega, None, joint_velocity);
    link.c = c;
    link.p = newton_euler(&model.inertias[i].lift(), omega, None);
    path[joint.slot].omega = omega;
}

/// Pass 1 for one body: X, ω, c and pᴬ = v ×* I v.
#[inline(always)]
fn set_moving<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    inputs: &Inputs<'_, P, T>,
    i: usize,
    path: &mut [OnPath<T>],
    link: &mut Link<T>,
) {
    let x = place(kind, inputs, i, link);
    set_velocity(kind, inputs, i, &x, path, link);
}

/// Pass 2 for one body: eliminates its joint, and adds Iᵃ to its parent's on the path and pᵃ to its parent's pᴬ, `parent_p`. `smallest` takes
/// note of the pivots D.
#[inline(always)]
fn pass_to_parent<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    inputs: &Inputs<'_, P, T>,
    i: usize,
    link: &mut Link<T>,
    parent_p: Option<&mut Force<T>>,
    path: &mut [OnPath<T>],
    smallest: &mut Pivot,
) {
    let Inputs { model, tau, .. } = *inputs;
    let joints = model.topology.joints();
    let (joint, dof) = (&joints[i], joints[i].v);
    // Iᴬ is complete: the children have been reached
    let is_leaf = joints.get(i + 1).is_none_or(|next| next.parent != Some(i));
    if is_leaf {
        path[joint.slot].inertia = own_inertia(model, i);
    }
    let inertia = &path[joint.slot].inertia;
    let (apparent, force) = match kind {
        JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => {
            let (subspace, armature) = (model.subspaces[i].lift(), model.armature[dof].lift());
            let (apparent, force, d) = one_dof::eliminate(kind, subspace, armature, tau[dof], inertia, link);
            smallest.note(dof, d.min_lane());
            (Some(apparent), force)
        }
        JointKind::Spherical => {
            link.inertia = *inertia;
            let (apparent, force) = spherical::eliminate(armatures(model, dof), &tau[dof..], link, dof, smallest);
            (Some(apparent), force)
        }
        JointKind::Free => {
            link.inertia = *inertia;
            (None, free::apparent_force(&tau[dof..]))
        }
    };
    if let (Some(parent), Some(parent_p)) = (joint.parent, parent_p) {
        let x = kind.recall(&model.placements[i], &link.x);
        let sum = &mut path[joint.parent_slot].inertia;
        // the last child comes first
        let before_it = if joint.slot == joint.parent_slot { own_inertia(model, parent) } else { *sum };
        *sum = match apparent {
            Some(apparent) => before_it + apparent.to_parent(&x),
            None => before_it,
        };
        *parent_p += x.force(force);
    }
}

/// Pass 2 of [`Aba::solve`] for one body, whose Iᴬ, U and D are known: adds pᵃ to its parent.
#[inline(always)]
fn pass_force_to_parent<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    f: &[T],
    link: &mut Link<T>,
    parent: Option<&mut Link<T>>,
) {
    let dof = model.topology.joints()[i].v;
    let force = match kind {
        JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => {
            one_dof::apparent_force(kind, model.subspaces[i].lift(), f[dof], link)
        }
        JointKind::Spherical => spherical::apparent_force(armatures(model, dof), &f[dof..], link),
        JointKind::Free => free::apparent_force(&f[dof..]),
    };
    if let Some(parent) = parent {
        parent.p += kind.recall(&model.placements[i], &link.x).force(force);
    }
}

/// Pass 3 for one body: q̈ into the first numbers of `a`, and a = a' + S q̈.
#[inline(always)]
fn accelerate<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    inputs: &Inputs<'_, P, T>,
    i: usize,
    a: &mut [T],
    link: &Link<T>,
    path: &mut [OnPath<T>],
    smallest: &mut Pivot,
) {
    let Inputs { model, tau, .. } = *inputs;
    let (joint, dof) = (&model.topology.joints()[i], model.topology.joints()[i].v);
    let carried = kind.recall(&model.placements[i], &link.x).inverse_motion(path[joint.parent_slot].a) + link.c;
    match kind {
        JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => a[0] = one_dof::acceleration(link, carried),
        JointKind::Spherical => {
            let rate = spherical::acceleration(armatures(model, dof), &tau[dof..], link, carried);
            a[..3].copy_from_slice(&rate.to_array());
        }
        JointKind::Free => {
            let across = free::acceleration(&tau[dof..], link, carried, dof, smallest);
            a[..3].copy_from_slice(&across.lin.to_array());
            a[3..6].copy_from_slice(&across.ang.to_array());
        }
    }
    path[joint.slot].a = add_joint(kind, carried, kind.motion(&model.subspaces[i], a));
}

/// The inertia of body `i` alone, as an articulated one.
#[inline(always)]
fn own_inertia<T: Real, P: Real + Lift<T>>(model: &Model<P>, i: usize) -> ArticulatedInertia<T> {
    model.inertias[i].lift().to_articulated()
}

/// The three armatures of the spherical joint whose first dof is `dof`.
#[inline(always)]
fn armatures<T: Real, P: Real + Lift<T>>(model: &Model<P>, dof: usize) -> Vec3<T> {
    vec3(&model.armature[dof..]).lift()
}

/// `(B D⁻¹, A − B D⁻¹ Bᵀ)`; D is given by its factors.
#[inline(always)]
fn schur<T: Real>(a: Sym3<T>, b: Mat3<T>, d: &Ldl3<T>) -> (Mat3<T>, Sym3<T>) {
    let w = Mat3::from_rows(d.solve(b.x), d.solve(b.y), d.solve(b.z));
    (w, a - Sym3::from_upper(w * b.transpose()))
}

/// Takes note of the three pivots of a 3×3 block whose first dof is `dof`.
#[inline(always)]
fn note_pivots<T: Real>(smallest: &mut Pivot, dof: usize, factors: &Ldl3<T>) {
    for (k, pivot) in factors.pivots.to_array().into_iter().enumerate() {
        smallest.note(dof + k, pivot.min_lane());
    }
}

/// The vector of the first three values.
#[inline(always)]
pub(crate) fn vec3<T: Real>(values: &[T]) -> Vec3<T> {
    Vec3::new(values[0], values[1], values[2])
}

/// Forward dynamics that makes its own workspace, without external wrenches; it allocates.
///
/// # Errors
/// [`Error`] when an argument does not fit the model, or a joint meets no inertia.
pub fn forward_dynamics<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], v: &[T], tau: &[T]) -> Result<Vec<T>, Error> {
    let mut a = vec![T::zero(); model.topology.nv()];
    Aba::new(&model.topology).run(model, q, v, tau, None, &mut a)?;
    Ok(a)
}
