//! Forward dynamics of a long chain on two cores: elimination from both ends at once.
//!
//! Source: the tip side is `aba.rs`. The base side eliminates the equations of motion in the other order, as a twisted factorization of a band
//! matrix does: Meurant, *A review on the inverse of symmetric tridiagonal and block tridiagonal matrices*, 1992.
//! What it carries along is the inverse operational-space inertia: Kreutz-Delgado, Jain and Rodriguez, *Recursive formulation of operational
//! space control*, 1992.
//!
//! A body of the base side passes the force f on to the rest of the chain. Then its acceleration is `a = b − Φ f`, with Φ symmetric and positive
//! semidefinite. For the world Φ = 0, and b is gravity.
//!
//! | stage | base side, bodies 0 … m−1 | tip side, bodies m … n−1, at the same time |
//! |---|---|---|
//! | 1 | X, ω, c, p | X |
//! | 2 | Φ, b, outward | ω, c, pass 2 of the articulated-body algorithm, inward |
//! | between | joint m: both sides meet | |
//! | 3 | q̈, f, inward | q̈, a, outward |
//!
//! Across joint k and body k, with `a' = b' − Φ' f' + S q̈`, `Φ' = X Φ Xᵀ`, `b' = X b + c`, `f' = I a + p + f` and `Sᵀ f' = τ − armature q̈`:
//! `I = Σ d_i l_i l_iᵀ` is taken in six steps. Each is an elimination of one number φ, the force along l_i:
//!
//! ```text
//! w = 1 / (1 + d lᵀΦl),  φ = w (d lᵀb + o),  D += w d (lᵀs)²,  u −= (lᵀs) φ
//! b −= Φl φ,  s −= Φl w d (lᵀs),  Φ −= w d Φl (Φl)ᵀ         s begins as S, D as the armature, u as τ; Σ o_i l_i = p
//! ```
//!
//! Then the joint: `Φ += s D⁻¹ sᵀ`, `b += s D⁻¹ u`. In stage 3: `q̈ = D⁻¹ (u − sᵀ f)`, `a = b − Φ f`, and f' is the f of the body before.
//! D is positive if the body itself has inertia along S. Where it has not, [`Aba`] computes the whole chain.
//!
//! Cost per revolute joint about z, in operations as [`Counted`](featherbench_spatial::Counted) counts them: 421 on the tip side, as [`Aba`], and
//! 786 on the base side. With 0.3 of the bodies on the base side the longer side has 0.7 of the work of [`Aba`], and both together 1.26 times
//! that work. It is for chains of some 2000 joints or more: `docs/kernels/parallel.md`. A call does not allocate, but for `rayon`.
//!
//! Accuracy: the error is that of [`Aba`] within a tenth, on chains of 100 and 1000 and with tips a million times as heavy
//! (`tests/twisted.rs`). The heavy tip is on the tip side, where both algorithms are the same.
//!
//! Frames: on the base side each body's quantities are at its centre of mass, in its compiled axes. There three of the l_i are unit vectors.
//! Shapes and units: those of `aba.rs`.

use crate::aba::free::apparent_force;
use crate::aba::{Inputs, Link, OnPath, place, set_velocity};
use crate::error::Pivot;
use crate::step::{by_kind, cross_joint, expect_bodies};
use crate::{Aba, DimensionError, Error};
use bracing::Bracing;
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{ArticulatedInertia, CentralInertia, Force, Lift, Motion, Real, Sym3, Transform, Vec3};
use std::array::from_fn;

mod bracing;

/// The share of the bodies that the base side takes. There both sides take about the same time: `docs/kernels/parallel.md`.
const SHARE: f64 = 0.30;

/// The workspace of forward dynamics of a chain on two cores.
///
/// It uses two threads of the current pool of `rayon`. The answers are the same to the bit with any number of threads, and differ from
/// those of [`Aba`] by rounding.
///
/// ```
/// use featherbench_dynamics::{Twisted, forward_dynamics};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("snake:n=50")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 1);
/// let (q, v, tau) = (states.q(0), states.v(0), states.tau(0));
///
/// let mut a = vec![0.0; model.topology.nv()];
/// Twisted::new(&model.topology).ok_or("no chain")?.run(&model, q, v, tau, None, &mut a)?;
/// let serial = forward_dynamics(&model, q, v, tau)?;
/// let norm = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
/// let off = norm(&mut a.iter().zip(&serial).map(|(a, b)| a - b));
/// assert!(off < 1e-12 * norm(&mut serial.iter().copied()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Twisted<T> {
    /// The bodies of the base side.
    base: Vec<Braced<T>>,
    /// The bodies of the tip side, and their path slots: a chain has one, beside that of the world.
    tip: Vec<Link<T>>,
    path: [OnPath<T>; 2],
}

/// A body of the base side.
#[derive(Clone, Copy, Debug)]
struct Braced<T> {
    /// Placement of its centre of mass in the centre of mass of the body before.
    x: Transform<T>,
    inertia: CentralInertia<T>,
    omega: Vec3<T>,
    /// Velocity-product acceleration c.
    c: Motion<T>,
    /// Force p that velocity and wrench need.
    p: Force<T>,
    /// Φ: the rows of the linear acceleration first, so that it moves between frames as an inertia does.
    flexibility: ArticulatedInertia<T>,
    /// b.
    free: Motion<T>,
    /// s D⁻¹ and D⁻¹ u of a one-dof joint.
    s_d_inverse: Motion<T>,
    d_inverse_u: T,
}

impl<T: Real> Twisted<T> {
    /// A workspace for chains of this topology. `None` if the tree is no chain, or has other joints than one-dof joints and a free base, or
    /// has less than two one-dof joints.
    pub fn new(topology: &Topology) -> Option<Self> {
        Self::with_cut(topology, (SHARE * topology.bodies() as f64).round() as usize)
    }

    /// The same with so many bodies on the base side; at least one, and not all.
    pub fn with_cut(topology: &Topology, cut: usize) -> Option<Self> {
        let joints = topology.joints();
        let is_chain = joints.iter().enumerate().all(|(i, joint)| joint.parent == i.checked_sub(1));
        let first = usize::from(joints.first()?.kind == JointKind::Free);
        let one_dof = joints[first..].iter().all(|joint| joint.kind.nv() == 1);
        if !is_chain || !one_dof || joints.len() < first + 2 {
            return None;
        }
        let cut = cut.clamp(1, joints.len() - 1);
        Some(Self { base: vec![Braced::at_rest(); cut], tip: vec![Link::at_rest(); joints.len() - cut], path: [OnPath::at_rest(); 2] })
    }

    /// The number of bodies on the base side.
    pub fn cut(&self) -> usize {
        self.base.len()
    }

    /// The accelerations `a` at configuration `q`, velocity `v`, joint forces `tau` and external wrenches.
    ///
    /// It allocates where it takes [`Aba`] in place of its own algorithm.
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
        let inputs = Inputs { model, q, v, tau, wrenches };
        expect_bodies(model, self.base.len() + self.tip.len())?;
        inputs.expect_shapes(a)?;
        self.expect_chain(&model.topology)?;
        let Self { base, tip, path } = self;
        let side = Side { inputs, cut: base.len() };
        // One entry into the pool for all stages: from outside, each would wait for a thread to wake up.
        let braced = rayon::scope(|_| side.run(base, tip, path, a));
        if braced { Ok(()) } else { Aba::new(&model.topology).run(model, q, v, tau, wrenches, a) }
    }

    fn expect_chain(&self, topology: &Topology) -> Result<(), DimensionError> {
        let chained = topology.joints().iter().enumerate().filter(|(i, joint)| joint.parent == i.checked_sub(1)).count();
        crate::error::expect("bodies of the model in one chain", topology.bodies(), chained)?;
        let one_dof = topology.joints()[1..].iter().filter(|joint| joint.kind.nv() == 1).count();
        crate::error::expect("one-dof joints of the model behind the first", topology.bodies() - 1, one_dof)
    }
}

impl<T: Real> Braced<T> {
    fn at_rest() -> Self {
        Self {
            x: Transform::identity(),
            inertia: CentralInertia::zero(),
            omega: Vec3::zero(),
            c: Motion::zero(),
            p: Force::zero(),
            flexibility: ArticulatedInertia::zero(),
            free: Motion::zero(),
            s_d_inverse: Motion::zero(),
            d_inverse_u: T::zero(),
        }
    }

    /// `a = b − Φ f`.
    fn acceleration(&self, f: Force<T>) -> Motion<T> {
        let phi = &self.flexibility;
        let ang = phi.coupling.transpose_mul(f.lin) + phi.translational * f.ang;
        let lin = phi.coupling.mul_vec_add(f.ang, phi.rotational * f.lin);
        self.free - Motion::new(ang, lin)
    }
}

/// What both sides know when they have met: q̈ of joint m, a of its body, and the force on body m − 1.
struct Meeting<T> {
    rate: T,
    acceleration: Motion<T>,
    force: Force<T>,
}

/// What the stages read.
struct Side<'a, P, T> {
    inputs: Inputs<'a, P, T>,
    /// m.
    cut: usize,
}

impl<P: Real + Lift<T>, T: Real> Side<'_, P, T> {
    /// All stages; false if a pivot is not positive.
    fn run(&self, base: &mut [Braced<T>], tip: &mut [Link<T>], path: &mut [OnPath<T>; 2], a: &mut [T]) -> bool {
        rayon::join(|| self.move_base(base), || self.place_tip(tip));

        path[1].omega = base[base.len() - 1].omega;
        let (mut base_pivot, mut tip_pivot) = (Pivot::none(), Pivot::none());
        rayon::join(|| self.brace(base, &mut base_pivot), || self.eliminate_tip(tip, path, &mut tip_pivot));
        let meeting = self.meet(&base[base.len() - 1], &tip[0], &path[1].inertia, &mut base_pivot);
        if base_pivot.check().is_err() || tip_pivot.check().is_err() {
            return false;
        }

        let (a_base, a_tip) = a.split_at_mut(self.inputs.model.topology.joints()[self.cut].v);
        a_tip[0] = meeting.rate;
        path[1].a = meeting.acceleration;
        rayon::join(|| self.accelerate_base(base, meeting.force, a_base), || self.accelerate_tip(tip, path, a_tip));
        true
    }

    /// Stage 1 of the base side.
    fn move_base(&self, base: &mut [Braced<T>]) {
        let Inputs { model, wrenches, .. } = self.inputs;
        let (mut parent_omega, mut parent_com) = (Vec3::zero(), Vec3::zero());
        for (i, body) in base.iter_mut().enumerate() {
            let kind = model.topology.joints()[i].kind;
            by_kind!(T, kind, move_braced, &self.inputs, i, parent_omega, parent_com, body);
            if let Some(wrenches) = wrenches {
                let wrench = model.labels[i].force_to_compiled(wrenches[i]);
                body.p -= Force::new(wrench.ang - body.inertia.com.cross(wrench.lin), wrench.lin);
            }
            (parent_omega, parent_com) = (body.omega, body.inertia.com);
        }
    }

    /// Stage 1 of the tip side.
    fn place_tip(&self, tip: &mut [Link<T>]) {
        for (link, i) in tip.iter_mut().zip(self.cut..) {
            let _ = by_kind!(T, self.inputs.model.topology.joints()[i].kind, place, &self.inputs, i, link);
        }
    }

    /// Stage 2 of the base side.
    fn brace(&self, base: &mut [Braced<T>], smallest: &mut Pivot) {
        let Inputs { model, tau, .. } = self.inputs;
        let mut flexibility = ArticulatedInertia::zero();
        let mut free = Motion::new(Vec3::zero(), -model.gravity.lift());
        for (i, (body, joint)) in base.iter_mut().zip(model.topology.joints()).enumerate() {
            if joint.kind == JointKind::Free {
                (flexibility, free) = free_body(body, &tau[joint.v..], joint.v, smallest);
            } else {
                let subspace = at(joint.kind.column(&model.subspaces[i], 0), body.inertia.com);
                let mut bracing = Bracing::new(flexibility, &body.x, free, body.c, subspace, model.armature[joint.v].lift(), tau[joint.v]);
                bracing.add_body(&body.inertia, body.p);
                smallest.note(joint.v, bracing.d.min_lane());
                (body.s_d_inverse, body.d_inverse_u) = bracing.release();
                (flexibility, free) = (bracing.flexibility(), Motion::from_array(bracing.b));
            }
            (body.flexibility, body.free) = (flexibility, free);
        }
    }

    /// Stage 2 of the tip side. The path begins with ω of the body before, and ends with Iᴬ of body m.
    fn eliminate_tip(&self, tip: &mut [Link<T>], path: &mut [OnPath<T>; 2], smallest: &mut Pivot) {
        let model = self.inputs.model;
        for (i, link) in (self.cut..).zip(&mut *tip) {
            let kind = model.topology.joints()[i].kind;
            let x = kind.recall(&model.placements[i], &link.x);
            by_kind!(T, kind, set_velocity, &self.inputs, i, &x, path, link);
            self.inputs.subtract_wrench(i, link);
        }
        // If body m is the last, nothing is added to it.
        path[1].inertia = model.inertias[self.cut].lift::<T>().to_articulated();
        if let Some((met, behind)) = tip.split_first_mut() {
            self.inputs.inward(self.cut + 1, behind, path, Some(&mut met.p), smallest);
        }
    }

    /// Joint m between the last body of the base side and the first link of the tip side. `inertia` is Iᴬ of its body.
    fn meet(&self, base: &Braced<T>, link: &Link<T>, inertia: &ArticulatedInertia<T>, smallest: &mut Pivot) -> Meeting<T> {
        let Inputs { model, v, tau, .. } = self.inputs;
        let i = self.cut;
        let joint = &model.topology.joints()[i];
        let subspace = &model.subspaces[i];
        let at_joint = joint.kind.recall(&model.placements[i], &link.x);
        let x = Transform::new(at_joint.rotation, at_joint.translation - base.inertia.com);
        let (_, c) = cross_joint(joint.kind, &x, base.omega, None, joint.kind.motion(subspace, &v[joint.v..]));
        let axis = joint.kind.column(subspace, 0);
        let mut bracing = Bracing::new(base.flexibility, &x, base.free, c, axis, model.armature[joint.v].lift(), tau[joint.v]);
        bracing.add_articulated(inertia, link.p);
        smallest.note(joint.v, bracing.d.min_lane());
        let (_, rate) = bracing.release();
        let acceleration = Motion::from_array(bracing.b);
        Meeting { rate, acceleration, force: x.force(inertia.mul(acceleration) + link.p) }
    }

    /// Stage 3 of the base side. `force` acts on the rest of the chain, at the centre of mass of the last body.
    fn accelerate_base(&self, base: &[Braced<T>], mut force: Force<T>, a: &mut [T]) {
        let model = self.inputs.model;
        let joints = &model.topology.joints()[..base.len()];
        for (body, joint) in base.iter().zip(joints).rev() {
            let acceleration = body.acceleration(force);
            if joint.kind == JointKind::Free {
                // S q̈ = a − X a_0 − c
                let world = Motion::new(Vec3::zero(), -model.gravity.lift());
                let across = acceleration - body.x.inverse_motion(world) - body.c;
                let lin = across.lin - across.ang.cross(body.inertia.com);
                a[joint.v..joint.v + 3].copy_from_slice(&lin.to_array());
                a[joint.v + 3..joint.v + 6].copy_from_slice(&across.ang.to_array());
            } else {
                a[joint.v] = body.d_inverse_u - body.s_d_inverse.dot(force);
            }
            // f' = I a + p + f
            let CentralInertia { mass, rotational, .. } = body.inertia;
            let inertial = Force::new(rotational * acceleration.ang, acceleration.lin * mass);
            force = body.x.force(inertial + body.p + force);
        }
    }

    /// Stage 3 of the tip side, once q̈ of joint m is known and the path has a of its body.
    fn accelerate_tip(&self, tip: &[Link<T>], path: &mut [OnPath<T>; 2], a: &mut [T]) {
        let (joints, first) = (self.inputs.model.topology.joints(), self.cut + 1);
        let Some(behind) = joints.get(first) else { return };
        let a = &mut a[behind.v - joints[self.cut].v..];
        // One-dof joints note no pivots on the way out.
        self.inputs.accelerate(first, &tip[1..], path, a, &mut Pivot::none());
    }
}

/// Stage 1 of one body of the base side.
#[inline(always)]
fn move_braced<T: Real, P: Real + Lift<T>>(
    kind: JointKind,
    inputs: &Inputs<'_, P, T>,
    i: usize,
    parent_omega: Vec3<T>,
    parent_com: Vec3<T>,
    body: &mut Braced<T>,
) {
    let Inputs { model, q, v, .. } = *inputs;
    let (joint, subspace) = (&model.topology.joints()[i], &model.subspaces[i]);
    let inertia = model.inertias[i].lift::<T>().central();
    let Transform { rotation, translation } = kind.transform(&model.placements[i], subspace, &q[joint.q..]);
    let x = Transform::new(rotation, translation - parent_com);
    let (omega, c) = cross_joint(kind, &x, parent_omega, None, kind.motion(subspace, &v[joint.v..]));
    // From the body's origin to its centre of mass: p̈ += ω̇ × r + ω × (ω × r)
    let swing = omega.cross_add(omega.cross(inertia.com), c.ang.cross(inertia.com));
    body.x = Transform::new(rotation, x.point(inertia.com));
    (body.omega, body.c) = (omega, Motion::new(c.ang, c.lin + swing));
    body.p = Force::new(omega.cross(inertia.rotational * omega), Vec3::zero());
    body.inertia = inertia;
}

/// A motion at a frame's origin, at the point `r`.
#[inline(always)]
fn at<T: Real>(m: Motion<T>, r: Vec3<T>) -> Motion<T> {
    Motion::new(m.ang, m.ang.cross_add(r, m.lin))
}

/// A body on a free joint: `Φ = I⁻¹`, `b = I⁻¹ (τ − p)`.
fn free_body<T: Real>(body: &Braced<T>, tau: &[T], dof: usize, smallest: &mut Pivot) -> (ArticulatedInertia<T>, Motion<T>) {
    let CentralInertia { mass, com, rotational } = body.inertia;
    let factors = rotational.factor();
    for (k, pivot) in [mass, mass, mass].into_iter().chain(factors.pivots.to_array()).enumerate() {
        smallest.note(dof + k, pivot.min_lane());
    }
    let unit = |k: usize| Vec3::from_array(from_fn(|i| if i == k { T::one() } else { T::zero() }));
    let [x, y, z] = [0, 1, 2].map(|k| factors.solve(unit(k)));
    let mut flexibility = ArticulatedInertia::zero();
    flexibility.translational = Sym3 { xx: x.x, xy: x.y, xz: x.z, yy: y.y, yz: y.z, zz: z.z };
    flexibility.rotational = Sym3::scalar(T::one() / mass);

    let joint_force = apparent_force(tau);
    let f = Force::new(joint_force.ang - com.cross(joint_force.lin), joint_force.lin) - body.p;
    (flexibility, Motion::new(flexibility.translational * f.ang, f.lin * (T::one() / mass)))
}
