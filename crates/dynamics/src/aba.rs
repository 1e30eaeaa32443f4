//! Forward dynamics by the articulated-body algorithm: the accelerations that joint forces cause, `v̇ = M⁻¹ (τ − h + Σ Jᵀf)`.
//!
//! Source: the book, table 7.1, with classical accelerations (see `step.rs`). Armature is added to the diagonal of D.
//! Frames: each body's quantities are in its own axes, as compiled, at its own origin. External wrenches [moment; force], one per compiled
//! body, are in the described axes ([`Model::labels`]).
//! Gravity enters as an acceleration −g of the base. Shapes: q has `nq` numbers; v, τ and v̇ have `nv`. Units: SI, angles in radians.
//! Cost: O(n), with one division per one-dof joint. A call does not allocate.
//!
//! The functions of one body and the book's symbols:
//!
//! - `set_moving` (pass 1, outward): X, ω, c, Iᴬ = I, pᴬ = v ×* I v.
//! - `apparent_inertia` (pass 2, inward): U = Iᴬ S, D = Sᵀ U + armature, u = τ − Sᵀ pᴬ. It adds X* Iᵃ X⁻¹ and X* pᵃ to the parent.
//! - `joint_acceleration` (pass 3, outward): a' = X a_p + c, q̈ = D⁻¹ (u − Uᵀ a'), a = a' + S q̈.
//! - `apparent_bias_force` (pass 2 of [`Aba::solve`]): u and pᵃ = pᴬ + U D⁻¹ u, with U and D of the last run.
//!
//! In the code U is `upper_u`, because `u` is the book's u.

use crate::error::{Pivot, expect};
use crate::step::{add_joint, by_kind, cross_joint, expect_bodies, expect_wrenches, newton_euler, parent_link};
use crate::{DimensionError, Error};
use featherbench_model::{Axis, JointKind, Model, Topology};
use featherbench_spatial::{ArticulatedInertia, Force, Ldl3, Lift, Mat3, Motion, Real, Sym3, Transform, Vec3};

/// The workspace of the articulated-body algorithm.
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
            by_kind!(joint.kind, apparent_inertia, model, i, tau, &mut rest[0], parent, &mut smallest);
        }

        // outward: a' = X a_p + c,  q̈ = D⁻¹ (u − Uᵀ a'),  a_i = a' + S q̈
        for (i, joint) in joints.iter().enumerate() {
            let (before, rest) = self.links.split_at_mut(i + 1);
            let (parent, link) = (&before[parent_link(joint)], &mut rest[0]);
            by_kind!(joint.kind, joint_acceleration, model, i, parent.a, tau, a, link, &mut smallest);
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
            by_kind!(joint.kind, apparent_bias_force, model, i, f, &mut rest[0], parent);
        }

        // outward: as in a run, with v = 0
        let mut smallest = Pivot::none();
        for (i, joint) in joints.iter().enumerate() {
            let (before, rest) = self.links.split_at_mut(i + 1);
            let (parent, link) = (&before[parent_link(joint)], &mut rest[0]);
            by_kind!(joint.kind, joint_acceleration, model, i, parent.a, f, x, link, &mut smallest);
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

/// Pass 2 for one body: the apparent inertia Iᵃ (`apparent`) and force pᵃ (`force`) that its parent feels across the free joint.
///
/// `smallest` takes note of the pivots D.
#[inline(always)]
fn apparent_inertia<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    tau: &[T],
    link: &mut Link<T>,
    parent: Option<&mut Link<T>>,
    smallest: &mut Pivot,
) {
    let dof = model.topology.joints()[i].v;
    let (inertia, p) = (link.inertia, link.p);
    let (apparent, force) = match kind {
        JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => {
            let subspace = model.subspaces[i].lift();
            // U = Iᴬ S,  D = Sᵀ U + armature,  u = τ − Sᵀ pᴬ
            let (upper_u, d, s_p) = match kind {
                JointKind::Revolute(Axis::Z) => {
                    let i = inertia.rotational;
                    (Force::new(Vec3::new(i.xz, i.yz, i.zz), inertia.coupling.z), i.zz, p.ang.z)
                }
                JointKind::Prismatic(Axis::Z) => {
                    let m = inertia.translational;
                    (Force::new(inertia.coupling.column_z(), Vec3::new(m.xz, m.yz, m.zz)), m.zz, p.lin.z)
                }
                JointKind::Revolute(Axis::Skew) => {
                    let upper_u = Force::new(inertia.rotational * subspace.ang, inertia.coupling.transpose_mul(subspace.ang));
                    (upper_u, subspace.ang.dot(upper_u.ang), subspace.ang.dot(p.ang))
                }
                JointKind::Prismatic(Axis::Skew) => {
                    let upper_u = Force::new(inertia.coupling * subspace.lin, inertia.translational * subspace.lin);
                    (upper_u, subspace.lin.dot(upper_u.lin), subspace.lin.dot(p.lin))
                }
                _ => {
                    let upper_u = inertia.mul(subspace);
                    (upper_u, subspace.dot(upper_u), subspace.dot(p))
                }
            };
            let d = d + model.armature[dof].lift();
            smallest.note(dof, d.min_lane());
            let d_inverse = T::one() / d;
            let scaled = upper_u * d_inverse;
            (link.u_d_inverse, link.d_inverse) = (scaled, d_inverse);
            link.d_inverse_u = (tau[dof] - s_p) * d_inverse;
            // Iᵃ = Iᴬ − U D⁻¹ Uᵀ,  pᵃ = pᴬ + Iᵃ c + U D⁻¹ u
            let apparent = inertia.subtract_rank_one(scaled, upper_u);
            (Some(apparent), upper_u.scale_add(link.d_inverse_u, p + carry_velocity_product(kind, &apparent, link.c)))
        }
        JointKind::Spherical => {
            let (apparent, d) = eliminate_spherical(&inertia, spherical_armature(model, dof), dof, smallest);
            let d_inverse_u = d.solve(vec3(&tau[dof..]) - p.ang);
            (Some(apparent), p + apparent.mul(link.c) + inertia.mul(Motion::new(d_inverse_u, Vec3::zero())))
        }
        // S = 1 and no armature: Iᵃ = 0,  pᵃ = τ
        JointKind::Free => (None, free_force(&tau[dof..])),
    };
    if let Some(parent) = parent {
        if let Some(apparent) = apparent {
            parent.inertia += apparent.to_parent(&link.x);
        }
        parent.p += link.x.force(force);
    }
}

/// `Iᵃ c` for the velocity product c of a one-dof joint. Its angular part `ω_p × ω_J` is zero along the axis, and of a joint that does not
/// turn it is zero.
#[inline(always)]
fn carry_velocity_product<T: Real>(kind: JointKind, apparent: &ArticulatedInertia<T>, c: Motion<T>) -> Force<T> {
    let ArticulatedInertia { rotational: i, coupling: h, translational: m } = apparent;
    match kind {
        JointKind::Revolute(Axis::Z) => {
            let (x, y) = (c.ang.x, c.ang.y);
            let turned = Vec3::new(i.xx.mul_add(x, i.xy * y), i.xy.mul_add(x, i.yy * y), i.xz.mul_add(x, i.yz * y));
            Force::new(h.mul_vec_add(c.lin, turned), h.x.scale_add(x, h.y.scale_add(y, *m * c.lin)))
        }
        JointKind::Prismatic(_) => Force::new(*h * c.lin, *m * c.lin),
        _ => apparent.mul(c),
    }
}

/// Pass 2 of [`Aba::solve`] for one body, whose Iᴬ, U and D are known: adds X* pᵃ, pᵃ = pᴬ + U D⁻¹ u, to the parent's pᴬ.
#[inline(always)]
fn apparent_bias_force<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    model: &Model<P>,
    i: usize,
    f: &[T],
    link: &mut Link<T>,
    parent: Option<&mut Link<T>>,
) {
    let dof = model.topology.joints()[i].v;
    let (subspace, p) = (model.subspaces[i].lift(), link.p);
    let force = match kind {
        JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => {
            // u = f − Sᵀ pᴬ
            let u = f[dof]
                - match kind {
                    JointKind::Revolute(Axis::Z) => p.ang.z,
                    JointKind::Prismatic(Axis::Z) => p.lin.z,
                    JointKind::Revolute(Axis::Skew) => subspace.ang.dot(p.ang),
                    JointKind::Prismatic(Axis::Skew) => subspace.lin.dot(p.lin),
                    _ => subspace.dot(p),
                };
            link.d_inverse_u = u * link.d_inverse;
            link.u_d_inverse.scale_add(u, p)
        }
        JointKind::Spherical => {
            let d = (link.inertia.rotational + diagonal(spherical_armature(model, dof))).factor();
            let d_inverse_u = d.solve(vec3(&f[dof..]) - p.ang);
            p + link.inertia.mul(Motion::new(d_inverse_u, Vec3::zero()))
        }
        JointKind::Free => free_force(&f[dof..]),
    };
    if let Some(parent) = parent {
        parent.p += link.x.force(force);
    }
}

/// Pass 3 for one body: q̈ = D⁻¹ (u − Uᵀ a') and a = a' + S q̈, where `carried` is a' = X a_p + c.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "one body's step reads the model and the inputs, and writes the outputs")]
fn joint_acceleration<T: Real, P: Real + Lift<T>>(
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
        JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical => {
            // the angular part is known first: two short sums are faster than one long sum
            a[dof] = link.d_inverse_u - link.u_d_inverse.ang.dot(carried.ang) - link.u_d_inverse.lin.dot(carried.lin);
        }
        JointKind::Spherical => {
            let d = (link.inertia.rotational + diagonal(spherical_armature(model, dof))).factor();
            let u = vec3(&tau[dof..]) - link.p.ang;
            a[dof..dof + 3].copy_from_slice(&d.solve(u - link.inertia.mul(carried).ang).to_array());
        }
        JointKind::Free => {
            // Iᴬ (a' + S q̈) + pᴬ = S τ,  S = 1:  u = τ − pᴬ
            let u = free_force(&tau[dof..]) - link.p;
            let whole = solve(&link.inertia, u, dof, smallest);
            let across = whole - carried;
            a[dof..dof + 3].copy_from_slice(&across.lin.to_array());
            a[dof + 3..dof + 6].copy_from_slice(&across.ang.to_array());
        }
    }
    link.a = add_joint(kind, carried, kind.motion(&model.subspaces[i], &a[dof..]));
}

/// The apparent inertia of a body behind a free spherical joint with diagonal armature R, and the factors of D.
///
/// S = [1; 0]: U = [I; Hᵀ],  D = I + R. The formulas form no difference of nearly equal numbers:
/// Iᵃ = R − R D⁻¹ R,  Hᵃ = R D⁻¹ H,  Mᵃ = M − Hᵀ D⁻¹ H
#[inline(always)]
pub(crate) fn eliminate_spherical<T: Real>(
    inertia: &ArticulatedInertia<T>,
    armature: Vec3<T>,
    dof: usize,
    smallest: &mut Pivot,
) -> (ArticulatedInertia<T>, Ldl3<T>) {
    let d = (inertia.rotational + diagonal(armature)).factor();
    note_pivots(smallest, dof, &d);
    let (w, translational) = schur(inertia.translational, inertia.coupling.transpose(), &d);
    let carried = w.transpose();
    let scale_rows = |m: Mat3<T>| Mat3::from_rows(m.x * armature.x, m.y * armature.y, m.z * armature.z);
    let r = diagonal(armature).to_mat3();
    let inverse = Mat3::from_rows(d.solve(r.x), d.solve(r.y), d.solve(r.z)).transpose();
    let rotational = diagonal(armature) - Sym3::from_upper(scale_rows(inverse));
    (ArticulatedInertia { rotational, coupling: scale_rows(carried), translational }, d)
}

/// `(B D⁻¹, A − B D⁻¹ Bᵀ)`; D is given by its factors.
#[inline(always)]
fn schur<T: Real>(a: Sym3<T>, b: Mat3<T>, d: &Ldl3<T>) -> (Mat3<T>, Sym3<T>) {
    let w = Mat3::from_rows(d.solve(b.x), d.solve(b.y), d.solve(b.z));
    (w, a - Sym3::from_upper(w * b.transpose()))
}

/// `Iᴬ⁻¹ f` by a blocked LDLᵀ, translation first, as the dofs of a free joint are ordered.
#[inline(always)]
pub(crate) fn solve<T: Real>(inertia: &ArticulatedInertia<T>, f: Force<T>, dof: usize, smallest: &mut Pivot) -> Motion<T> {
    let translation = inertia.translational.factor();
    note_pivots(smallest, dof, &translation);
    let (w, rotational) = schur(inertia.rotational, inertia.coupling, &translation);
    let rotation = rotational.factor();
    note_pivots(smallest, dof + 3, &rotation);
    let ang = rotation.solve(f.ang - w * f.lin);
    Motion::new(ang, translation.solve(f.lin) - w.transpose_mul(ang))
}

/// Takes note of the three pivots of a 3×3 block whose first dof is `dof`.
#[inline(always)]
fn note_pivots<T: Real>(smallest: &mut Pivot, dof: usize, factors: &Ldl3<T>) {
    for (k, pivot) in factors.pivots.to_array().into_iter().enumerate() {
        smallest.note(dof + k, pivot.min_lane());
    }
}

/// The diagonal matrix with these entries.
#[inline(always)]
fn diagonal<T: Real>(d: Vec3<T>) -> Sym3<T> {
    let zero = T::zero();
    Sym3 { xx: d.x, xy: zero, xz: zero, yy: d.y, yz: zero, zz: d.z }
}

/// The vector of the first three values.
#[inline(always)]
pub(crate) fn vec3<T: Real>(values: &[T]) -> Vec3<T> {
    Vec3::new(values[0], values[1], values[2])
}

/// The three armatures of the spherical joint whose first dof is `dof`: the diagonal of R.
#[inline(always)]
fn spherical_armature<T: Real, P: Real + Lift<T>>(model: &Model<P>, dof: usize) -> Vec3<T> {
    vec3(&model.armature[dof..]).lift()
}

/// The joint force of a free joint, in the order [force; moment].
#[inline(always)]
pub(crate) fn free_force<T: Real>(tau: &[T]) -> Force<T> {
    Force::new(vec3(&tau[3..]), vec3(tau))
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
