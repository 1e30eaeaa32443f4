//! The articulated-body recursion and what differentiates it, at a known solution of forward dynamics.
//!
//! Frames: every vector is in the axes of its tree's first body, about the origin of its own body. A body's velocities are those that an observer
//! sees who moves with the velocity of that origin. So neither the distance from the base nor the speed of a limb enters a number, and no digit
//! is lost to them. A step to the parent is a translation, and a change of the observer. The axes are not those of the world: of a slender
//! floating base, whose inertia is small about one axis, turning the inertia would lose that axis' digits.
//!
//! Let dof j move its sub-tree, in q or in v. Seen from the sub-tree, all its bodies change their angular velocity by δω and their acceleration
//! by the rigid field ρ, both at j; the joints add their own δv̇ ([`Column`]). On body i acts the change `I_i δa + 2 B_i δω` of its force. B is
//! the Coriolis operator (`sweep.rs`). The articulated-body algorithm eliminates the dofs of this force as those of `Iᴬ a + pᴬ`:
//!
//! ```text
//! U = Iᴬ S    D = Sᵀ U + armature    Iᵃ = Iᴬ − U D⁻¹ Uᵀ    Bᵃ = Bᴬ − U D⁻¹ Sᵀ Bᴬ
//! δv̇ = D⁻¹ (u − Uᵀ δa' − 2 (Sᵀ Bᴬ) δω)                      u = −Sᵀ δp
//! ```
//!
//! Dofs of one joint are eliminated one by one, from the last. To its parent a joint passes `Iᵃ ρ + 2 Bᵃ δω`, and S ×* F when q moves, F =
//! Iᵃ a' + pᵃ the force across the joint. At the origin of the parent, whose observer is slower by w, Bᴬ has the additional term `Iᵃ [0; δω × w]`.
//!
//! Source: table 7.1 of the book, differentiated; the closed forms of δω, ρ and B are those of S. Singh, R. Russell & P. Wensing, *Efficient
//! analytical derivatives of rigid-body dynamics using spatial vector algebra* (2022). Units: SI. Cost: O(n). Nothing here allocates.

use super::sweep::coriolis_moment;
use crate::DimensionError;
use crate::aba::{Inputs, free};
use crate::error::{Pivot, expect};
use crate::step::{State, by_kind, expect_bodies, newton_euler, slides, turns};
use featherbench_model::{Axis, JointKind, Model, Topology};
use featherbench_spatial::{ArticulatedInertia, Force, Lift, Mat3, Motion, Real, RigidBodyInertia, Sym3, Transform, Vec3};
use std::ops::Range;

/// The bodies at one state, the rows of the dofs, and their columns.
#[derive(Clone, Debug)]
pub(super) struct Articulated<T> {
    pub(super) links: Vec<Link<T>>,
    pub(super) rows: Vec<Row<T>>,
    pub(super) columns: [Vec<Column<T>>; 2],
}

/// A body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link<T> {
    /// The axes of the body in those of its tree's first body.
    rotation: Mat3<T>,
    /// From the origin of the parent to that of the body, and the velocity of the one against the other.
    pub(super) d: Vec3<T>,
    w: Vec3<T>,
    /// 2 w.
    pub(super) twice_w: Vec3<T>,
    /// Angular velocity, the velocity products c, and the acceleration a, which of a first body is that of the world, −g, until the last pass.
    /// All accelerations are classical.
    omega: Vec3<T>,
    c: Motion<T>,
    a: Motion<T>,
    /// Iᴬ, 2 Bᴬ and pᴬ, as far as the children have been reached.
    inertia: ArticulatedInertia<T>,
    coriolis: Operator<T>,
    p: Force<T>,
}

/// A linear map from angular vectors to forces.
#[derive(Clone, Copy, Debug)]
struct Operator<T> {
    ang: Mat3<T>,
    lin: Mat3<T>,
}

/// What a dof does to a change that passes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<T> {
    /// S.
    pub(super) s: Motion<T>,
    /// U D⁻¹, D⁻¹, and D⁻¹ u of the state itself.
    pub(super) scaled: Force<T>,
    pub(super) d_inverse: T,
    d_inverse_u: T,
    /// 2 (Sᵀ Bᴬ)ᵀ D⁻¹.
    pub(super) turn: Vec3<T>,
}

/// The change by one dof, in q or in v.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column<T> {
    /// ρ, of which δω is the angular part of another field.
    pub(super) field: Motion<T>,
    /// δω.
    pub(super) turn: Vec3<T>,
    /// What the joint passes to its parent, at the parent's origin.
    pub(super) push: Force<T>,
}

impl<T: Real> Operator<T> {
    fn zero() -> Self {
        Self { ang: Mat3::zero(), lin: Mat3::zero() }
    }

    #[inline(always)]
    fn mul(&self, x: Vec3<T>) -> Force<T> {
        Force::new(self.ang * x, self.lin * x)
    }

    #[inline(always)]
    fn transpose_mul(&self, s: Motion<T>) -> Vec3<T> {
        self.ang.transpose_mul(s.ang) + self.lin.transpose_mul(s.lin)
    }

    /// `self − f xᵀ`.
    #[inline(always)]
    fn subtract_outer(&self, f: Force<T>, x: Vec3<T>) -> Self {
        let rows = |m: &Mat3<T>, f: Vec3<T>| Mat3::from_rows(x.scale_add(-f.x, m.x), x.scale_add(-f.y, m.y), x.scale_add(-f.z, m.z));
        Self { ang: rows(&self.ang, f.ang), lin: rows(&self.lin, f.lin) }
    }

    /// `self + I [0; · × u]`.
    #[inline(always)]
    fn add_moving(&self, inertia: &ArticulatedInertia<T>, u: Vec3<T>) -> Self {
        // row r of M (· × u) is u × r
        let rows =
            |rows: Mat3<T>, m: &Mat3<T>| Mat3::from_rows(u.cross_add(rows.x, m.x), u.cross_add(rows.y, m.y), u.cross_add(rows.z, m.z));
        Self { ang: rows(inertia.coupling, &self.ang), lin: rows(inertia.translational.to_mat3(), &self.lin) }
    }

    /// The forces at an origin from which their own is displaced by `d`.
    #[inline(always)]
    fn translate(&self, d: Vec3<T>) -> Self {
        let (x, y, z) = (self.lin.x, self.lin.y, self.lin.z);
        let ang = Mat3::from_rows(
            z.scale_add(d.y, y.scale_add(-d.z, self.ang.x)),
            x.scale_add(d.z, z.scale_add(-d.x, self.ang.y)),
            y.scale_add(d.x, x.scale_add(-d.y, self.ang.z)),
        );
        Self { ang, lin: self.lin }
    }

    #[inline(always)]
    fn add(&self, other: &Self) -> Self {
        Self { ang: self.ang + other.ang, lin: self.lin + other.lin }
    }
}

/// A force at an origin from which its own is displaced by `d`.
#[inline(always)]
fn translated<T: Real>(f: Force<T>, d: Vec3<T>) -> Force<T> {
    Force::new(d.cross_add(f.lin, f.ang), f.lin)
}

impl<T: Real> Articulated<T> {
    pub(super) fn new(topology: &Topology) -> Self {
        let (still, zero) = (Motion::zero(), Vec3::zero());
        let rest = Link {
            rotation: Mat3::zero(),
            d: zero,
            w: zero,
            twice_w: zero,
            omega: zero,
            c: still,
            a: still,
            inertia: ArticulatedInertia::zero(),
            coriolis: Operator::zero(),
            p: Force::zero(),
        };
        let row = Row { s: still, scaled: Force::zero(), d_inverse: T::zero(), d_inverse_u: T::zero(), turn: zero };
        let column = Column { field: still, turn: zero, push: Force::zero() };
        let columns = || vec![column; topology.nv()];
        Self { links: vec![rest; topology.bodies()], rows: vec![row; topology.nv()], columns: [columns(), columns()] }
    }

    /// The accelerations `a`, and what rows and columns need.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model. What is returned are the pivots D.
    pub(super) fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, at: State<'_, T>, a: &mut [T]) -> Result<Pivot, DimensionError> {
        expect_bodies(model, self.links.len())?;
        let State { q, v, given: tau, wrenches } = at;
        let inputs = Inputs { model, q, v, tau, wrenches };
        inputs.expect_shapes(a)?;
        expect("rows of the workspace", model.topology.nv(), self.rows.len())?;
        let mut smallest = Pivot::none();
        let joints = model.topology.joints();
        let Self { links, rows, columns } = self;
        // outward: placements, velocities, and the changes by each dof as far as velocities make them
        for (i, joint) in joints.iter().enumerate() {
            let (before, rest) = links.split_at_mut(i);
            let parent = joint.parent.map(|parent| &before[parent]);
            by_kind!(T, joint.kind, place, &inputs, i, parent, &mut rest[0], rows, columns);
        }
        // inward: each dof is eliminated, and what remains is passed to the parent
        for (i, joint) in joints.iter().enumerate().rev() {
            let (before, rest) = links.split_at_mut(i);
            let parent = joint.parent.map(|parent| &mut before[parent]);
            by_kind!(T, joint.kind, eliminate, &inputs, i, &mut rest[0], parent, rows, &mut smallest);
        }
        // outward: accelerations, the changes by them, and what each joint passes to its parent
        for (i, joint) in joints.iter().enumerate() {
            let (before, rest) = links.split_at_mut(i);
            let parent = joint.parent.map(|parent| &before[parent]);
            let dofs = joint.v..joint.v + joint.kind.nv();
            by_kind!(T, joint.kind, accelerate, parent, &mut rest[0], dofs, rows, columns, a);
        }
        Ok(smallest)
    }
}

/// `R m`, m across a joint of this kind.
#[inline(always)]
fn turned<T: Real>(kind: JointKind, r: &Mat3<T>, m: Motion<T>) -> Motion<T> {
    match kind {
        JointKind::Revolute(Axis::Z) => Motion::new(r.column_z() * m.ang.z, m.lin),
        JointKind::Prismatic(Axis::Z) => Motion::new(m.ang, r.column_z() * m.lin.z),
        _ => Motion::new(if turns(kind) { *r * m.ang } else { m.ang }, if slides(kind) { *r * m.lin } else { m.lin }),
    }
}

/// The first outward step of one body.
#[inline(always)]
fn place<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    inputs: &Inputs<'_, P, T>,
    i: usize,
    parent: Option<&Link<T>>,
    link: &mut Link<T>,
    rows: &mut [Row<T>],
    columns: &mut [Vec<Column<T>>; 2],
) {
    let Inputs { model, q, v, wrenches, .. } = *inputs;
    let (joint, subspace) = (&model.topology.joints()[i], &model.subspaces[i]);
    let x: Transform<T> = kind.transform(&model.placements[i], subspace, &q[joint.q..]);
    link.rotation = parent.map_or(Mat3::identity(), |parent| parent.rotation * x.rotation);
    if parent.is_none() {
        link.a = Motion::new(Vec3::zero(), x.rotation.transpose_mul(-model.gravity.lift()));
    }
    let across = turned(kind, &link.rotation, kind.motion(subspace, &v[joint.v..]));
    let parent_omega = parent.map_or(Vec3::zero(), |parent| parent.omega);
    // v = v_p + S q̇: about the body's origin, and seen from it, v has no linear part, and v_p has that of −S q̇
    link.omega = if turns(kind) { parent_omega + across.ang } else { parent_omega };
    let (velocity, parent_v) = (Motion::new(link.omega, Vec3::zero()), Motion::new(parent_omega, -across.lin));
    // c = v × S q̇ + [0; ω_p × w]
    link.c = crossed(kind, velocity, across);
    if let Some(parent) = parent {
        link.d = parent.rotation * x.translation;
        let swing = parent_omega.cross(link.d);
        link.w = if slides(kind) { swing + across.lin } else { swing };
        link.twice_w = link.w + link.w;
        link.c.lin = parent_omega.cross_add(link.w, link.c.lin);
    }

    let own: RigidBodyInertia<T> = model.inertias[i].lift();
    let first_moment = link.rotation * own.first_moment;
    let own = RigidBodyInertia { mass: own.mass, first_moment, rotational: own.rotational.rotate(link.rotation) };
    link.inertia = own.to_articulated();
    // 2 B x = [2 D x; x × 2 l], l = ω × h
    let d = coriolis_moment(&own, velocity);
    let l = link.omega.cross(first_moment);
    link.coriolis = Operator { ang: d + d, lin: Mat3::skew(-(l + l)) };
    link.p = newton_euler(&own, link.omega, None);
    if let Some(wrenches) = wrenches {
        let f = model.labels[i].force_to_compiled(wrenches[i]);
        link.p -= Force::new(link.rotation * f.ang, link.rotation * f.lin);
    }

    let [by_q, by_v] = columns;
    for k in 0..kind.nv() {
        let dof = joint.v + k;
        let s = turned(kind, &link.rotation, kind.column(subspace, k));
        rows[dof].s = s;
        // Ψ̇ = v_p × S,  and Φ̇ = v × S, which is Ψ̇ where one column spans the joint
        let psi = crossed(kind, parent_v, s);
        let phi = if kind.nv() == 1 { psi } else { crossed(kind, velocity, s) };
        (by_q[dof].turn, by_q[dof].field) = (psi.ang, parent_v.cross_motion(psi));
        (by_v[dof].turn, by_v[dof].field) = (s.ang, psi + phi);
    }
}

/// `m × s`, s across a joint of this kind.
#[inline(always)]
fn crossed<T: Real>(kind: JointKind, m: Motion<T>, s: Motion<T>) -> Motion<T> {
    match (turns(kind), slides(kind)) {
        (true, true) => m.cross_motion(s),
        (true, false) => Motion::new(m.ang.cross(s.ang), m.lin.cross(s.ang)),
        (false, _) => Motion::new(Vec3::zero(), m.ang.cross(s.lin)),
    }
}

/// The inward step of one body.
#[inline(always)]
fn eliminate<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    inputs: &Inputs<'_, P, T>,
    i: usize,
    link: &mut Link<T>,
    parent: Option<&mut Link<T>>,
    rows: &mut [Row<T>],
    smallest: &mut Pivot,
) {
    let Inputs { model, tau, .. } = *inputs;
    let first = model.topology.joints()[i].v;
    for dof in (first..first + kind.nv()).rev() {
        let row = &mut rows[dof];
        let u = match (turns(kind), slides(kind)) {
            (true, true) => link.inertia.mul(row.s),
            (true, false) => Force::new(link.inertia.rotational * row.s.ang, link.inertia.coupling.transpose_mul(row.s.ang)),
            (false, _) => Force::new(link.inertia.coupling * row.s.lin, link.inertia.translational * row.s.lin),
        };
        let d = along(kind, row.s, u) + model.armature[dof].lift();
        smallest.note(dof, d.min_lane());
        row.d_inverse = T::one() / d;
        row.scaled = u * row.d_inverse;
        let turn = link.coriolis.transpose_mul(row.s);
        row.turn = turn * row.d_inverse;
        let force = tau[dof] - along(kind, row.s, link.p);
        row.d_inverse_u = force * row.d_inverse;
        link.p = row.scaled.scale_add(force, link.p);
        link.inertia = link.inertia.subtract_rank_one(row.scaled, u);
        link.coriolis = link.coriolis.subtract_outer(row.scaled, turn);
        let free = row.d_inverse * model.armature[dof].lift();
        let turning = if kind == JointKind::Free { dof - first >= 3 } else { turns(kind) };
        clear(turning, row.s, u * free, turn * free, tau[dof] - force * free, link);
    }
    let Some(parent) = parent else { return };
    if kind == JointKind::Free {
        // The parent feels the joint's force alone, which turns with the body.
        let f = free::apparent_force(&tau[first..]);
        (link.inertia, link.coriolis) = (ArticulatedInertia::zero(), Operator::zero());
        link.p = Force::new(link.rotation * f.ang, link.rotation * f.lin);
    }
    let carried = link.coriolis.add_moving(&link.inertia, link.twice_w).translate(link.d);
    parent.coriolis = parent.coriolis.add(&carried);
    parent.inertia += link.inertia.translate(link.d);
    parent.p += translated(link.p + link.inertia.mul(link.c), link.d);
}

/// Takes rounding out of the direction S of an eliminated dof, with r the armature over D:
///
/// ```text
/// Iᵃ S = r U    Sᵀ Bᵃ = r Sᵀ Bᴬ    Sᵀ pᵃ = τ − r u
/// ```
///
/// Iᴬ − U D⁻¹ Uᵀ has these up to a rounding of Iᴬ. That would be much, where the joint before moves a light body nearly along S too: wrists, and
/// Euler angles near their singularity. In body axes with S along z (`aba.rs`) such a joint mixes in little of the z direction.
#[inline(always)]
fn clear<T: Real>(turning: bool, s: Motion<T>, inertia: Force<T>, coriolis: Vec3<T>, force: T, link: &mut Link<T>) {
    // t · S = 1
    let (zero, half) = (Vec3::zero(), T::from_f64(0.5));
    let t = if turning { Force::new(s.ang, zero) } else { Force::new(zero, s.lin) };
    // Iᵃ − w tᵀ − t wᵀ, with w = x − ½ (Sᵀx) t and x = Iᵃ S − r U
    let x = link.inertia.mul(s) - inertia;
    let w = t.scale_add(-(s.dot(x) * half), x);
    let ArticulatedInertia { rotational, coupling, translational } = &mut link.inertia;
    *rotational = *rotational - twice_symmetric(w.ang, t.ang);
    *translational = *translational - twice_symmetric(w.lin, t.lin);
    let outer = |a: Vec3<T>, b: Vec3<T>| Mat3::from_rows(b * a.x, b * a.y, b * a.z);
    *coupling = *coupling - (outer(w.ang, t.lin) + outer(t.ang, w.lin));
    link.coriolis = link.coriolis.subtract_outer(t, link.coriolis.transpose_mul(s) - coriolis);
    link.p = t.scale_add(force - s.dot(link.p), link.p);
}

/// `a bᵀ + b aᵀ`.
#[inline(always)]
fn twice_symmetric<T: Real>(a: Vec3<T>, b: Vec3<T>) -> Sym3<T> {
    let two = |x: T, y: T| x.mul_add(y, x * y);
    let sum = |a: T, b: T, c: T, d: T| a.mul_add(b, c * d);
    Sym3 {
        xx: two(a.x, b.x),
        xy: sum(a.x, b.y, a.y, b.x),
        xz: sum(a.x, b.z, a.z, b.x),
        yy: two(a.y, b.y),
        yz: sum(a.y, b.z, a.z, b.y),
        zz: two(a.z, b.z),
    }
}

/// `S · f`, S a column of a joint of this kind.
#[inline(always)]
fn along<T: Real>(kind: JointKind, s: Motion<T>, f: Force<T>) -> T {
    match (turns(kind), slides(kind)) {
        (true, true) => s.dot(f),
        (true, false) => s.ang.dot(f.ang),
        (false, _) => s.lin.dot(f.lin),
    }
}

/// The second outward step of one body, whose joint has these dofs.
#[inline(always)]
fn accelerate<T: Real>(
    kind: JointKind,
    parent: Option<&Link<T>>,
    link: &mut Link<T>,
    dofs: Range<usize>,
    rows: &[Row<T>],
    columns: &mut [Vec<Column<T>>; 2],
    a: &mut [T],
) {
    // a_p as the observer at this body's origin sees it, and a' = X a_p + c
    let (observed, carried) = match parent {
        Some(parent) => {
            let moved = Motion::new(parent.a.ang, parent.a.ang.cross_add(link.d, parent.a.lin));
            (Motion::new(moved.ang, parent.omega.cross_add(link.w, moved.lin)), moved + link.c)
        }
        None => {
            let world = link.a;
            (world, world + link.c)
        }
    };
    // F = Iᵃ a' + pᵃ. A sum of the bodies' forces would have the rounding of v̇ in it, times their whole inertia.
    let force = link.inertia.mul(carried) + link.p;
    link.a = carried;
    let [by_q, by_v] = columns;
    for dof in dofs {
        let row = &rows[dof];
        a[dof] = row.d_inverse_u - row.scaled.ang.dot(link.a.ang) - row.scaled.lin.dot(link.a.lin);
        link.a = row.s.scale_add(a[dof], link.a);
        // Ψ̈ = a_p × S + v_p × Ψ̇
        by_q[dof].field += crossed(kind, observed, row.s);
        if parent.is_some() {
            let pushed = |column: &Column<T>| link.inertia.mul(column.field) + link.coriolis.mul(column.turn);
            by_q[dof].push = translated(pushed(&by_q[dof]) + row.s.cross_force(force), link.d);
            by_v[dof].push = translated(pushed(&by_v[dof]), link.d);
        }
    }
}
