//! Forward dynamics by the articulated-body algorithm: the accelerations that joint forces cause, `v̇ = M⁻¹ (τ − h + Σ Jᵀf)`.
//!
//! Source: the book, table 7.1, with classical accelerations (see `step.rs`). Armature is added to the diagonal of D.
//! Frames: each body's quantities are in its own axes, as compiled, at its own origin. External wrenches [moment; force], one per compiled
//! body, are in the described axes ([`Model::labels`]).
//! Gravity enters as an acceleration −g of the base. Shapes: q has `nq` numbers; v, τ and v̇ have `nv`. Units: SI, angles in radians.
//! Cost: O(n), with one division per one-dof joint. A call does not allocate.
//!
//! [`Aba::run`] has the three recursions. One body's part of each is a function here:
//!
//! | pass | function | what it computes, in the book's symbols |
//! |---|---|---|
//! | 1, outward | `set_moving` | X, ω, c, Iᴬ = I, pᴬ = v ×* I v |
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
use crate::step::{add_joint, by_kind, cross_joint, expect_bodies, expect_wrenches, newton_euler, parent_link};
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
/// Per revolute joint about z of its body, on a chain. Words and conditions are on the [crate page](crate#cost-of-the-hot-kernels). Counted with
/// [`Counted`](featherbench_spatial::Counted):
///
/// | | multiply-adds | products | sums | divisions | sine and cosine |
/// |---|---|---|---|---|---|
/// | [`run`](Self::run) | 268 | 107 | 45 | 1 | 1 |
/// | [`solve`](Self::solve) | 46 | 15 | 16 | 0 | 0 |
///
/// In `f64` the compiler puts a part of them into registers of two or four numbers:
///
/// | `run` in `f64` | AVX-512 | AVX2 |
/// |---|---|---|
/// | operations on one, two, four numbers | 198, 32, 56 | 202, 29, 56 |
/// | shuffles | 116 | 129 |
/// | cycles | 337 | 260 |
/// | share of the limit | 0.42 | 0.55 |
/// | stack reads, writes | 39, 37 | 95, 78 |
///
/// *Bound* by latency: in pass 2 a joint waits for the one below, through U, D, the division (14 cycles), the rank one, X and the sum. A
/// register of states shares that wait: [`Batch`](crate::Batch).
///
/// *Does not pay:* registers of two and four numbers, with AVX-512. A build without them (`-C no-vectorize-slp`) took 0.86 of the time on a
/// chain of 36, and 0.88 on the humanoid.
#[derive(Clone, Debug)]
pub struct Aba<T> {
    /// Link 0 is the world; link i + 1 is body i.
    links: Vec<Link<T>>,
}

#[derive(Clone, Copy, Debug)]
struct Link<T> {
    /// Placement in the parent.
    x: Transform<T>,
    /// Angular velocity ω.
    omega: Vec3<T>,
    /// Velocity-product acceleration c.
    c: Motion<T>,
    /// Articulated-body inertia Iᴬ.
    inertia: ArticulatedInertia<T>,
    /// Bias force pᴬ.
    p: Force<T>,
    /// Of a one-dof joint: U D⁻¹, D⁻¹ and D⁻¹ u.
    u_d_inverse: Force<T>,
    d_inverse: T,
    d_inverse_u: T,
    /// Classical acceleration a.
    a: Motion<T>,
}

impl<T: Real> Aba<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let rest = Link {
            x: Transform::identity(),
            omega: Vec3::zero(),
            c: Motion::zero(),
            inertia: ArticulatedInertia::zero(),
            p: Force::zero(),
            u_d_inverse: Force::zero(),
            d_inverse: T::zero(),
            d_inverse_u: T::zero(),
            a: Motion::zero(),
        };
        Self { links: vec![rest; topology.bodies() + 1] }
    }

    /// The accelerations `a` at configuration `q`, velocity `v`, joint forces `tau` and external wrenches.
    ///
    /// # Errors
    /// [`Error`] when an argument or the workspace does not fit the model, or when a joint meets no inertia; `a` then means nothing.
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        tau: &[T],
        wrenches: Option<&[Force<T>]>,
        a: &mut [T],
    ) -> Result<(), Error> {
        self.expect_shapes(model, q, v, tau, wrenches, a)?;
        let joints = model.topology.joints();
        let mut smallest = Pivot::none();

        self.links[0].a.lin = -model.gravity.lift();

        // outward: v_i = X v_p + S q̇,  c_i,  Iᴬ = I,  pᴬ = v_i ×* I v_i − f_ext
        for (i, joint) in joints.iter().enumerate() {
            let (before, rest) = self.links.split_at_mut(i + 1);
            let (parent, link) = (&before[parent_link(joint)], &mut rest[0]);
            by_kind!(joint.kind, set_moving, model, i, parent.omega, q, v, link);
            if let Some(wrenches) = wrenches {
                link.p -= model.labels[i].force_to_compiled(wrenches[i]);
            }
        }

        // inward: Iᵃ = Iᴬ − U D⁻¹ Uᵀ,  pᵃ = pᴬ + Iᵃ c + U D⁻¹ u,  Iᴬ_p += X* Iᵃ X⁻¹,  pᴬ_p += X* pᵃ
        for (i, joint) in joints.iter().enumerate().rev() {
            let (before, rest) = self.links.split_at_mut(i + 1);
            let parent = joint.parent.map(|parent| &mut before[parent + 1]);
            by_kind!(joint.kind, pass_to_parent, model, i, tau, &mut rest[0], parent, &mut smallest);
        }

        // outward: a' = X a_p + c,  q̈ = D⁻¹ (u − Uᵀ a'),  a_i = a' + S q̈
        for (i, joint) in joints.iter().enumerate() {
            let (before, rest) = self.links.split_at_mut(i + 1);
            let (parent, link) = (&before[parent_link(joint)], &mut rest[0]);
            by_kind!(joint.kind, accelerate, model, i, parent.a, tau, a, link, &mut smallest);
        }
        Ok(smallest.check()?)
    }

    /// The solution `x` of `M x = f`: the accelerations by joint forces alone, with v = 0 and no gravity, at the configuration of the last successful run with this
    /// model.
    /// It uses the articulated inertias of that run again, and so takes a third of its time.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn solve<P: Real + Lift<T>>(&mut self, model: &Model<P>, f: &[T], x: &mut [T]) -> Result<(), DimensionError> {
        expect_bodies(model, self.links.len() - 1)?;
        expect("joint forces f", model.topology.nv(), f.len())?;
        expect("solution x", model.topology.nv(), x.len())?;
        let joints = model.topology.joints();
        for link in &mut self.links {
            (link.p, link.a, link.c) = (Force::zero(), Motion::zero(), Motion::zero());
        }

        // inward: u = f − Sᵀ pᴬ,  pᴬ_p += X* (pᴬ + U D⁻¹ u)
        for (i, joint) in joints.iter().enumerate().rev() {
            let (before, rest) = self.links.split_at_mut(i + 1);
            let parent = joint.parent.map(|parent| &mut before[parent + 1]);
            by_kind!(joint.kind, pass_force_to_parent, model, i, f, &mut rest[0], parent);
        }

        // outward: as in a run, with v = 0
        let mut smallest = Pivot::none();
        for (i, joint) in joints.iter().enumerate() {
            let (before, rest) = self.links.split_at_mut(i + 1);
            let (parent, link) = (&before[parent_link(joint)], &mut rest[0]);
            by_kind!(joint.kind, accelerate, model, i, parent.a, f, x, link, &mut smallest);
        }
        Ok(())
    }

    /// The placement of body `i` in its parent, at the configuration of the last run.
    #[inline(always)]
    pub(crate) fn placement(&self, i: usize) -> &Transform<T> {
        &self.links[i + 1].x
    }

    fn expect_shapes<P: Real>(
        &self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        tau: &[T],
        wrenches: Option<&[Force<T>]>,
        a: &[T],
    ) -> Result<(), DimensionError> {
        expect_bodies(model, self.links.len() - 1)?;
        expect("configuration q", model.topology.nq(), q.len())?;
        expect("velocity v", model.topology.nv(), v.len())?;
        expect("joint forces tau", model.topology.nv(), tau.len())?;
        expect("acceleration a", model.topology.nv(), a.len())?;
        expect_wrenches(model, wrenches)
    }
}

/// Pass 1 for one body: X, ω, c, Iᴬ = I and pᴬ = v ×* I v.
#[inline(always)]
fn set_moving<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    parent_omega: Vec3<T>,
    q: &[T],
    v: &[T],
    link: &mut Link<T>,
) {
    let (joint, subspace) = (&model.topology.joints()[i], &model.subspaces[i]);
    link.x = kind.transform(&model.placements[i], subspace, &q[joint.q..]);
    let joint_velocity = kind.motion(subspace, &v[joint.v..]);
    (link.omega, link.c) = cross_joint(kind, &link.x, parent_omega, None, joint_velocity);
    let inertia = model.inertias[i].lift();
    link.inertia = inertia.to_articulated();
    link.p = newton_euler(&inertia, link.omega, None);
}

/// Pass 2 for one body: eliminates its joint, and adds Iᵃ and pᵃ to its parent. `smallest` takes note of the pivots D.
#[inline(always)]
fn pass_to_parent<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    tau: &[T],
    link: &mut Link<T>,
    parent: Option<&mut Link<T>>,
    smallest: &mut Pivot,
) {
    let dof = model.topology.joints()[i].v;
    let (inertia, force) = match kind {
        JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => {
            let (subspace, armature) = (model.subspaces[i].lift(), model.armature[dof].lift());
            let (inertia, force) = one_dof::eliminate(kind, subspace, armature, tau[dof], link, dof, smallest);
            (Some(inertia), force)
        }
        JointKind::Spherical => {
            let (inertia, force) = spherical::eliminate(armatures(model, dof), &tau[dof..], link, dof, smallest);
            (Some(inertia), force)
        }
        JointKind::Free => (None, free::apparent_force(&tau[dof..])),
    };
    if let Some(parent) = parent {
        if let Some(inertia) = inertia {
            parent.inertia += inertia.to_parent(&link.x);
        }
        parent.p += link.x.force(force);
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
        parent.p += link.x.force(force);
    }
}

/// Pass 3 for one body: q̈, and a = a' + S q̈.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "one body's step reads the model and the inputs, and writes the outputs")]
fn accelerate<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    parent_acceleration: Motion<T>,
    tau: &[T],
    a: &mut [T],
    link: &mut Link<T>,
    smallest: &mut Pivot,
) {
    let dof = model.topology.joints()[i].v;
    let carried = link.x.inverse_motion(parent_acceleration) + link.c;
    match kind {
        JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => a[dof] = one_dof::acceleration(link, carried),
        JointKind::Spherical => {
            let rate = spherical::acceleration(armatures(model, dof), &tau[dof..], link, carried);
            a[dof..dof + 3].copy_from_slice(&rate.to_array());
        }
        JointKind::Free => {
            let across = free::acceleration(&tau[dof..], link, carried, dof, smallest);
            a[dof..dof + 3].copy_from_slice(&across.lin.to_array());
            a[dof + 3..dof + 6].copy_from_slice(&across.ang.to_array());
        }
    }
    link.a = add_joint(kind, carried, kind.motion(&model.subspaces[i], &a[dof..]));
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
