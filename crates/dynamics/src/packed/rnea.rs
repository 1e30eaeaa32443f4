//! Inverse dynamics by the recursive Newton–Euler algorithm, several joints at a time: `τ = M(q) v̇ + h(q, v) − Σ Jᵀf`.
//!
//! Source: the book, table 5.1, as in [`Rnea`](crate::Rnea). In the axes of the base:
//!
//! 1. ω_i = Σ R_j S_j q̇_j over the path, and ω̇_i = Σ (R_j S_j q̈_j + ω_p(j) × R_j S_j q̇_j);
//! 2. p̈_i = −g + Σ (ω̇_p × d_j + ω_p × (ω_p × d_j)), and what sliding joints add;
//! 3. the force f_i and moment n_i that a body needs, from `step.rs`;
//! 4. F_i = Σ f over the supported bodies, N_i = n_i + Σ (N_c + d_c × F_c) over the children, τ_i = (R_i S_i)ᵀ [N_i; F_i].
//!
//! Frames: external wrenches [moment; force] are in each body's described axes, at its own origin, one per compiled body.
//! Gravity enters as an acceleration −g of the base. Armature adds `armature_k · v̇_k`.
//! Shapes: q has `nq` numbers; v, a and τ have `nv`. Units: SI, angles in radians. Cost: O(n). A call does not allocate.

use super::lanes::{Lanes, Pack, store, sum_from_leaves, sum_from_root, sum_in_segments};
use super::model::{Block, PackedModel};
use super::orientation::{Frame, Orientations, across};
use crate::DimensionError;
use crate::error::expect;
use crate::step::newton_euler;
use featherbench_spatial::{Force, Mat3, Motion, Real, RigidBodyInertia, Vec3};

/// The workspace of inverse dynamics over packed joints.
#[derive(Clone, Debug)]
pub struct PackedRnea {
    motions: Motions,
    totals: Totals,
}

impl PackedRnea {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        Self { motions: Motions::new(model), totals: Totals::new(model) }
    }

    /// The joint forces `tau` of configuration `q`, velocity `v`, acceleration `a` and external wrenches.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run(
        &mut self,
        model: &PackedModel,
        q: &[f64],
        v: &[f64],
        a: &[f64],
        wrenches: Option<&[Force<f64>]>,
        tau: &mut [f64],
    ) -> Result<(), DimensionError> {
        expect("acceleration a", model.topology.nv(), a.len())?;
        expect("joint forces tau", model.topology.nv(), tau.len())?;
        self.motions.run::<true>(model, q, v, Some(a), wrenches)?;
        self.totals.project(model, &mut self.motions, tau);
        add_armature(model, a, tau);
        Ok(())
    }

    /// The bias force `h`: inverse dynamics with v̇ = 0.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn bias(
        &mut self,
        model: &PackedModel,
        q: &[f64],
        v: &[f64],
        wrenches: Option<&[Force<f64>]>,
        h: &mut [f64],
    ) -> Result<(), DimensionError> {
        expect("bias force h", model.topology.nv(), h.len())?;
        self.motions.run::<true>(model, q, v, None, wrenches)?;
        self.totals.project(model, &mut self.motions, h);
        Ok(())
    }
}

/// τ_k += armature_k q̈_k
fn add_armature(model: &PackedModel, a: &[f64], tau: &mut [f64]) {
    for ((tau, a), armature) in tau.iter_mut().zip(a).zip(&model.armature) {
        *tau = Real::mul_add(*a, *armature, *tau);
    }
}

/// Motions of the bodies, and the force that each body needs.
#[derive(Clone, Debug)]
pub(super) struct Motions {
    pub orientations: Orientations,
    pub links: Vec<Link>,
}

/// Motions and forces of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    omega: Vec3<Pack>,
    /// ω and ω̇ of each body's parent.
    above: [Vec3<Pack>; 2],
    /// Classical acceleration [ω̇; p̈].
    pub acceleration: Motion<Pack>,
    /// The inertia of each body in the axes of the base, at its own origin; of a run without `WHOLE`.
    pub inertia: RigidBodyInertia<Pack>,
    /// The force that a body needs for its acceleration, less external wrenches.
    pub force: Force<Pack>,
}

impl Motions {
    pub fn new(model: &PackedModel) -> Self {
        let (still, massless) = (Motion::zero(), RigidBodyInertia::zero());
        let link = Link { omega: Vec3::zero(), above: [Vec3::zero(); 2], acceleration: still, inertia: massless, force: Force::zero() };
        Self { orientations: Orientations::new(model), links: vec![link; model.blocks.len()] }
    }

    /// Steps 1 to 3: the force on each body; without `a` for v̇ = 0.
    ///
    /// Without `WHOLE` the accelerations start from zero in each segment: they are relative to those of the segment's parent.
    pub fn run<const WHOLE: bool>(
        &mut self,
        model: &PackedModel,
        q: &[f64],
        v: &[f64],
        a: Option<&[f64]>,
        wrenches: Option<&[Force<f64>]>,
    ) -> Result<(), DimensionError> {
        expect("blocks of the workspace", model.blocks.len(), self.links.len())?;
        expect("segments of the workspace", model.segments.len(), self.orientations.bases.len())?;
        expect("configuration q", model.topology.nq(), q.len())?;
        expect("velocity v", model.topology.nv(), v.len())?;
        if let Some(wrenches) = wrenches {
            expect("external wrenches", model.topology.bodies(), wrenches.len())?;
        }
        self.orientations.bases.fill(-model.gravity);
        self.orientations.turn(model, q);
        for b in 0..model.blocks.len() {
            self.swing::<WHOLE>(model, b, v, a);
        }
        for b in 0..model.blocks.len() {
            self.push::<WHOLE>(model, b, v, a);
        }
        if let Some(wrenches) = wrenches {
            for (b, block) in model.blocks.iter().enumerate() {
                let (rotation, force) = (&self.orientations.frames[b].rotation, &mut self.links[b].force);
                for (k, wrench) in wrenches[block.first..block.first + block.count].iter().enumerate() {
                    let r = rotation.lane(k);
                    let wrench = model.labels[block.first + k].force_to_compiled(*wrench);
                    force.ang.set_lane(k, force.ang.lane(k) - r * wrench.ang);
                    force.lin.set_lane(k, force.lin.lane(k) - r * wrench.lin);
                }
            }
        }
        Ok(())
    }

    /// Step 1 for a block.
    #[inline(always)]
    fn swing<const WHOLE: bool>(&mut self, model: &PackedModel, b: usize, v: &[f64], a: Option<&[f64]>) {
        let (block, frame, links) = (&model.blocks[b], &self.orientations.frames[b], &mut self.links);

        // ω = Σ R S q̇
        let rate = across(model, block, frame, v);
        let before = |block: usize, lane: usize| links[block].omega.lane(lane);
        let (omega, omega_above) = sum_from_root(model, block, rate.ang, before, |_| Vec3::zero());

        // ω̇ = Σ (R S q̈ + ω_p × R S q̇)
        let mut swung = omega_above.cross(rate.ang);
        if let Some(a) = a {
            swung += across(model, block, frame, a).ang;
        }
        let before = |block: usize, lane: usize| links[block].acceleration.ang.lane(lane);
        let (alpha, alpha_above) = match WHOLE {
            true => sum_from_root(model, block, swung, before, |_| Vec3::zero()),
            false => sum_in_segments(block, swung),
        };
        let link = &mut links[b];
        (link.omega, link.acceleration.ang) = (omega, alpha);
        link.above = [omega_above, alpha_above];
    }

    /// Steps 2 and 3 for a block.
    #[inline(always)]
    fn push<const WHOLE: bool>(&mut self, model: &PackedModel, b: usize, v: &[f64], a: Option<&[f64]>) {
        let (block, frame) = (&model.blocks[b], &self.orientations.frames[b]);
        let (links, bases) = (&mut self.links, &self.orientations.bases);
        let (d, omega, [omega_above, alpha_above]) = (frame.displacement, links[b].omega, links[b].above);

        // p̈ = −g + Σ (ω̇_p × d + ω_p × (ω_p × d)  +  (ω_p + ω) × v_J + v̇_J)
        let mut moved = omega_above.cross_add(omega_above.cross(d), alpha_above.cross(d));
        if block.slides {
            moved = (omega_above + omega).cross_add(across(model, block, frame, v).lin, moved);
            if let Some(a) = a {
                moved += across(model, block, frame, a).lin;
            }
        }
        let before = |block: usize, lane: usize| links[block].acceleration.lin.lane(lane);
        let (lin, _) = match WHOLE {
            true => sum_from_root(model, block, moved, before, |s| bases[s]),
            false => sum_in_segments(block, moved),
        };

        let link = &mut links[b];
        link.acceleration.lin = lin;
        let inertia = turned_inertia(block, frame);
        link.force = newton_euler(&inertia, omega, Some(link.acceleration));
        if !WHOLE {
            link.inertia = inertia;
        }
    }
}

/// The inertia of each body in the axes of the base, at its own origin.
#[inline(always)]
pub(super) fn turned_inertia(block: &Block, frame: &Frame) -> RigidBodyInertia<Pack> {
    turned(&block.inertia, frame.rotation)
}

/// An inertia in the axes to which `r` transforms.
#[inline(always)]
pub(super) fn turned<T: Real>(inertia: &RigidBodyInertia<T>, r: Mat3<T>) -> RigidBodyInertia<T> {
    RigidBodyInertia { mass: inertia.mass, first_moment: r * inertia.first_moment, rotational: inertia.rotational.rotate(r) }
}

/// What segments pass to their parents.
#[derive(Clone, Debug)]
struct Totals {
    forces: Vec<Vec3<f64>>,
    moments: Vec<Vec3<f64>>,
}

impl Totals {
    fn new(model: &PackedModel) -> Self {
        let zeros = vec![Vec3::zero(); model.segments.len()];
        Self { forces: zeros.clone(), moments: zeros }
    }

    /// Step 4: the joint forces of the bodies' forces.
    #[inline(always)]
    fn project(&mut self, model: &PackedModel, motions: &mut Motions, tau: &mut [f64]) {
        let still = Vec3::zero();
        for (b, block) in model.blocks.iter().enumerate().rev() {
            let (frame, force) = (&motions.orientations.frames[b], motions.links[b].force);
            // F_i = Σ f,  N_i = n_i + Σ (N_c + d_c × F_c)
            let lin = sum_from_leaves(model, block, force.lin, still, &mut self.forces);
            let arm = frame.displacement.cross(lin);
            let ang = sum_from_leaves(model, block, force.ang, arm, &mut self.moments);
            // τ = Sᵀ [N; F]
            let subspace = &frame.subspace;
            let along = if block.slides { subspace.dot(Force::new(ang, lin)) } else { subspace.ang.dot(ang) };
            store(block, along, tau);
            for wide in &model.wide[block.wide.clone()] {
                let r = frame.rotation.lane(wide.lane);
                let local = Force::new(r.transpose_mul(ang.lane(wide.lane)), r.transpose_mul(lin.lane(wide.lane)));
                wide.kind.project(&Motion::<f64>::zero(), local, &mut tau[block.v[wide.lane]..]);
            }
        }
    }
}
