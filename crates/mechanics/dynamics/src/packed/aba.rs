//! Forward dynamics by the articulated-body algorithm in the axes of the base: `v̇ = M⁻¹ (τ − h + Σ Jᵀf)`.
//!
//! Source: the book, table 7.1, as in [`Aba`](crate::Aba). The symbols are the book's. In the axes of the base:
//!
//! 1. Pass 1, several joints at a time: a *reference* acceleration of each body, and the force pᴬ that the body needs for it. It is what
//!    the velocity products c of its segment add up to, when the segment's parent does not accelerate. So a segment needs c no more, and
//!    the reference of its parent enters where a segment begins. Gravity does not enter: it would cancel in a robot that falls.
//! 2. Pass 2, inward, joint by joint: U = Iᴬ S, D = Sᵀ U + armature, u = τ − Sᵀ pᴬ. The parent takes Iᴬ − U D⁻¹ Uᵀ and pᴬ + U D⁻¹ u at its
//!    own origin. Nothing is rotated.
//! 3. Pass 3, outward: q̈ = D⁻¹ (u − Uᵀ a'), where a' is the parent's acceleration less the reference. It starts from −g.
//!
//! A segment has a reference of its own, so that u is no small difference of large forces on long chains and in robots that fall
//! (`docs/kernels/aba.md`).
//!
//! Frames, shapes and units: as in [`PackedRnea`](crate::PackedRnea). Cost: O(n), with one division per one-dof joint. A call does not
//! allocate.

use super::lanes::{LANES, Lanes};
use super::model::{PackedModel, is_screw};
use super::motions::Motions;
use super::orientation::own_force;
use crate::aba::{free, spherical, vec3};
use crate::error::{Pivot, expect};
use crate::{DimensionError, Error};
use featherbench_model::JointKind;
use featherbench_spatial::{ArticulatedInertia, Force, Ldl3, Mat3, Motion, Vec3};

/// The workspace of forward dynamics over packed joints.
///
/// # Cost
///
/// Operations per revolute joint of a chain, as the compiled code has them. Pass 2 has one joint at a time, so an operation fills one lane.
///
/// | | AVX-512, joints in eights | AVX2, in fours |
/// |---|---|---|
/// | pass 1, in registers | 45 | 79 |
/// | pass 2, single numbers | 157 | 164 |
/// | pass 3, single numbers | 18 | 19 |
/// | divisions among these | 1 | 1 |
///
/// Times, and what was tried: `docs/kernels/aba.md`.
#[derive(Clone, Debug)]
pub struct PackedAba {
    motions: Motions,
    /// Per body.
    eliminated: Vec<Eliminated>,
    /// What the children of a body pass to it, but for the next body.
    passed: Vec<Passed>,
}

/// What pass 3 needs of a joint.
#[derive(Clone, Copy, Debug)]
enum Eliminated {
    /// Of a one-dof joint: U D⁻¹ at the parent's origin, and D⁻¹ u.
    Screw { u_d_inverse: Force<f64>, d_inverse_u: f64 },
    /// Of a spherical joint, in body axes: Iᴬ, the factors of D, and u.
    Spherical { inertia: ArticulatedInertia<f64>, d: Ldl3<f64>, u: Vec3<f64> },
    /// Of a free joint, in body axes: Iᴬ⁻¹ u.
    Free { motion: Motion<f64> },
}

/// Articulated inertia and force at the parent's origin.
#[derive(Clone, Copy, Debug)]
struct Passed {
    inertia: ArticulatedInertia<f64>,
    p: Force<f64>,
}

impl PackedAba {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        let bodies = model.topology.bodies();
        let screw = Eliminated::Screw { u_d_inverse: Force::zero(), d_inverse_u: 0.0 };
        let nothing = Passed { inertia: ArticulatedInertia::zero(), p: Force::zero() };
        Self { motions: Motions::new(model), eliminated: vec![screw; bodies], passed: vec![nothing; bodies] }
    }

    /// The accelerations `a` at configuration `q`, velocity `v`, joint forces `tau` and external wrenches.
    ///
    /// # Errors
    /// [`Error`] when an argument or the workspace does not fit the model, or when a joint meets no inertia; `a` then means nothing.
    pub fn run(
        &mut self,
        model: &PackedModel,
        q: &[f64],
        v: &[f64],
        tau: &[f64],
        wrenches: Option<&[Force<f64>]>,
        a: &mut [f64],
    ) -> Result<(), Error> {
        self.expect_shapes(model, tau, a)?;
        self.motions.run(model, q, v, wrenches)?;
        let mut smallest = Pivot::none();
        self.inward(model, tau, &mut smallest);
        self.outward(model, a);
        Ok(smallest.check()?)
    }

    fn expect_shapes(&self, model: &PackedModel, tau: &[f64], a: &[f64]) -> Result<(), DimensionError> {
        expect("bodies of the workspace", model.topology.bodies(), self.eliminated.len())?;
        expect("joint forces tau", model.topology.nv(), tau.len())?;
        expect("acceleration a", model.topology.nv(), a.len())
    }

    /// Pass 2.
    #[inline(never)]
    fn inward(&mut self, model: &PackedModel, tau: &[f64], smallest: &mut Pivot) {
        let Self { motions, eliminated, passed } = self;
        let nothing = Passed { inertia: ArticulatedInertia::zero(), p: Force::zero() };
        for (passed, fork) in passed.iter_mut().zip(&model.forks) {
            if *fork {
                *passed = nothing;
            }
        }
        // what the next body passes to this one
        let mut below = nothing;
        let mut own = Force::zero();
        for (i, joint) in model.topology.joints().iter().enumerate().rev() {
            let (b, k) = (i / LANES, i % LANES);
            let (link, frame) = (&motions.links[b], &motions.orientations.frames[b]);
            if k + 1 == model.blocks[b].count {
                own = own_force(&model.blocks[b], frame);
            }
            if model.forks[i] {
                below = Passed { inertia: below.inertia + passed[i].inertia, p: below.p + passed[i].p };
            }
            let rigid = link.inertia.lane(k).to_articulated();
            let p = link.force.lane(k) + below.p;
            let d = frame.displacement.lane(k);
            let up = if is_screw(joint.kind) {
                let subspace = frame.subspace.lane(k);
                let alone = (own.lane(k), model.blocks[b].subspace_inertia.lane(k) + model.blocks[b].armature.lane(k));
                let whole = Passed { inertia: rigid + below.inertia, p };
                let (up, screw) = eliminate_screw(joint.kind, &whole, &below.inertia, alone, subspace, tau[joint.v], d, joint.v, smallest);
                eliminated[i] = screw;
                up
            } else {
                let rotation = frame.rotation.lane(k);
                let (up, wide) = eliminate_wide(
                    joint.kind,
                    &Passed { inertia: rigid + below.inertia, p },
                    rotation,
                    &model.armature[joint.v..],
                    &tau[joint.v..],
                    joint.v,
                    smallest,
                );
                eliminated[i] = wide;
                Passed { inertia: up.inertia.translate(d), p: translated(up.p, d) }
            };
            let mut up = up;
            if let Some(parent) = joint.parent
                && model.blocks[b].begins[k]
            {
                // the parent's reference: Iᵃ a'_p + pᵃ
                let reference = motions.links[parent / LANES].acceleration.lane(parent % LANES);
                up.p += up.inertia.mul(reference);
            }
            below = nothing;
            match joint.parent {
                Some(parent) if parent + 1 == i => below = up,
                Some(parent) => {
                    let into = &mut passed[parent];
                    *into = Passed { inertia: into.inertia + up.inertia, p: into.p + up.p };
                }
                None => {}
            }
        }
    }

    /// Pass 3.
    #[inline(never)]
    fn outward(&mut self, model: &PackedModel, a: &mut [f64]) {
        let Self { motions, eliminated, passed } = self;
        let mut last = Motion::zero();
        for (i, joint) in model.topology.joints().iter().enumerate() {
            let (b, k) = (i / LANES, i % LANES);
            let frame = &motions.orientations.frames[b];
            let above = match joint.parent {
                Some(parent) => {
                    let added = if parent + 1 == i { last } else { added(&passed[parent]) };
                    if model.blocks[b].begins[k] { added + motions.links[parent / LANES].acceleration.lane(parent % LANES) } else { added }
                }
                None => Motion::new(Vec3::zero(), motions.orientations.bases[model.blocks[b].segment[k]]),
            };
            let carried = Motion::new(above.ang, above.ang.cross_add(frame.displacement.lane(k), above.lin));
            last = match &eliminated[i] {
                Eliminated::Screw { u_d_inverse, d_inverse_u } => {
                    // two short sums: the angular part is known first (docs/kernels/aba.md)
                    let rate = d_inverse_u - u_d_inverse.ang.dot(above.ang) - u_d_inverse.lin.dot(above.lin);
                    a[joint.v] = rate;
                    let subspace = frame.subspace.lane(k);
                    match joint.kind {
                        JointKind::Revolute(_) => Motion::new(subspace.ang.scale_add(rate, carried.ang), carried.lin),
                        _ => subspace.scale_add(rate, carried),
                    }
                }
                Eliminated::Spherical { inertia, d, u } => {
                    let r = frame.rotation.lane(k);
                    let local = Motion::new(r.transpose_mul(carried.ang), r.transpose_mul(carried.lin));
                    let rate = d.solve(*u - inertia.mul(local).ang);
                    a[joint.v..joint.v + 3].copy_from_slice(&rate.to_array());
                    Motion::new(carried.ang + r * rate, carried.lin)
                }
                Eliminated::Free { motion } => {
                    let r = frame.rotation.lane(k);
                    let local = Motion::new(r.transpose_mul(carried.ang), r.transpose_mul(carried.lin));
                    let across = *motion - local;
                    a[joint.v..joint.v + 3].copy_from_slice(&across.lin.to_array());
                    a[joint.v + 3..joint.v + 6].copy_from_slice(&across.ang.to_array());
                    Motion::new(r * motion.ang, r * motion.lin)
                }
            };
            if model.forks[i] {
                passed[i].p = Force::new(last.ang, last.lin);
            }
        }
    }
}

/// The motion that pass 3 leaves where pass 2 kept a force.
fn added(passed: &Passed) -> Motion<f64> {
    Motion::new(passed.p.ang, passed.p.lin)
}

/// The same force at an origin from which its own is displaced by `d`.
#[inline(always)]
fn translated(f: Force<f64>, d: Vec3<f64>) -> Force<f64> {
    Force::new(d.cross_add(f.lin, f.ang), f.lin)
}

/// Pass 2 for a one-dof joint: what its parent takes, and what pass 3 needs.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "one joint's numbers, each of its own kind")]
fn eliminate_screw(
    kind: JointKind,
    whole: &Passed,
    below: &ArticulatedInertia<f64>,
    (own, own_inertia): (Force<f64>, f64),
    subspace: Motion<f64>,
    tau: f64,
    displacement: Vec3<f64>,
    dof: usize,
    smallest: &mut Pivot,
) -> (Passed, Eliminated) {
    let Passed { inertia, p } = whole;
    // U = Iᴬ S,  D = Sᵀ U + armature,  u = τ − Sᵀ pᴬ; of the body alone I S and Sᵀ I S are known
    let (along, d, s_p) = if matches!(kind, JointKind::Revolute(_)) {
        let along = Force::new(below.rotational * subspace.ang, below.coupling.transpose_mul(subspace.ang));
        (along, subspace.ang.dot(along.ang), subspace.ang.dot(p.ang))
    } else {
        let along = below.mul(subspace);
        (along, subspace.dot(along), subspace.dot(*p))
    };
    let (upper_u, d) = (along + own, d + own_inertia);
    smallest.note(dof, d);
    let d_inverse = 1.0 / d;
    let d_inverse_u = (tau - s_p) * d_inverse;
    // at the parent's origin
    let inertia = inertia.subtract_rank_one(upper_u * d_inverse, upper_u).translate(displacement);
    let up = Passed { inertia, p: translated(upper_u.scale_add(d_inverse_u, *p), displacement) };
    let upper_u = translated(upper_u, displacement);
    (up, Eliminated::Screw { u_d_inverse: upper_u * d_inverse, d_inverse_u })
}

/// Pass 2 for a spherical or free joint, in body axes: what its parent takes, still at the joint's origin, and what pass 3 needs.
fn eliminate_wide(
    kind: JointKind,
    own: &Passed,
    r: Mat3<f64>,
    armature: &[f64],
    tau: &[f64],
    dof: usize,
    smallest: &mut Pivot,
) -> (Passed, Eliminated) {
    let inertia = own.inertia.rotate(r.transpose());
    let p = Force::new(r.transpose_mul(own.p.ang), r.transpose_mul(own.p.lin));
    let turned = |f: Force<f64>| Force::new(r * f.ang, r * f.lin);
    if kind == JointKind::Spherical {
        let (apparent, d) = spherical::apparent_inertia(&inertia, vec3(armature), dof, smallest);
        let u = vec3(tau) - p.ang;
        let force = p + inertia.mul(Motion::new(d.solve(u), Vec3::zero()));
        (Passed { inertia: apparent.rotate(r), p: turned(force) }, Eliminated::Spherical { inertia, d, u })
    } else {
        // S = 1 and no armature: Iᵃ = 0,  pᵃ = τ
        let force = free::apparent_force(tau);
        let motion = free::solve(&inertia, force - p, dof, smallest);
        (Passed { inertia: ArticulatedInertia::zero(), p: turned(force) }, Eliminated::Free { motion })
    }
}
