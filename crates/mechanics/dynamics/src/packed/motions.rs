//! Motions of the bodies at given velocities, and the forces that they need, by sums along the path over registers of joints: pass 1 of
//! forward dynamics.

use super::lanes::{Lanes, Pack, sum_from_root, sum_in_segments};
use super::model::{Block, PackedModel};
use super::orientation::{Frame, Orientations, across};
use super::rnea::subtract_wrenches;
use crate::DimensionError;
use crate::error::expect;
use crate::step::{expect_wrenches, newton_euler};
use featherbench_spatial::{Force, Mat3, Motion, Real, RigidBodyInertia, Vec3};

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
    /// The inertia of each body in the axes of the base, at its own origin.
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

    /// The force on each body for v̇ = 0.
    ///
    /// Accelerations start from zero in each segment: they are relative to those of the segment's parent.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], v: &[f64], wrenches: Option<&[Force<f64>]>) -> Result<(), DimensionError> {
        expect("blocks of the workspace", model.blocks.len(), self.links.len())?;
        expect("segments of the workspace", model.segments.len(), self.orientations.bases.len())?;
        expect("configuration q", model.topology.nq(), q.len())?;
        expect("velocity v", model.topology.nv(), v.len())?;
        expect_wrenches(&model.topology, wrenches)?;
        self.orientations.bases.fill(-model.gravity);
        self.orientations.turn(model, q);
        for b in 0..model.blocks.len() {
            self.swing(model, b, v);
        }
        for b in 0..model.blocks.len() {
            self.push(model, b, v);
        }
        if let Some(wrenches) = wrenches {
            for (b, block) in model.blocks.iter().enumerate() {
                let rotation = &self.orientations.frames[b].rotation;
                subtract_wrenches(model, block, wrenches, |k| rotation.lane(k), &mut self.links[b].force);
            }
        }
        Ok(())
    }

    /// Angular velocities and accelerations of a block.
    #[inline(always)]
    fn swing(&mut self, model: &PackedModel, b: usize, v: &[f64]) {
        let (block, frame, links) = (&model.blocks[b], &self.orientations.frames[b], &mut self.links);

        // ω = Σ R S q̇
        let rate = across(model, block, frame, v);
        let before = |block: usize, lane: usize| links[block].omega.lane(lane);
        let (omega, omega_above) = sum_from_root(model, block, rate.ang, before);

        // ω̇ = Σ ω_p × R S q̇
        let (alpha, alpha_above) = sum_in_segments(block, omega_above.cross(rate.ang));
        let link = &mut links[b];
        (link.omega, link.acceleration.ang) = (omega, alpha);
        link.above = [omega_above, alpha_above];
    }

    /// Linear accelerations and forces of a block.
    #[inline(always)]
    fn push(&mut self, model: &PackedModel, b: usize, v: &[f64]) {
        let (block, frame, link) = (&model.blocks[b], &self.orientations.frames[b], &mut self.links[b]);
        let (d, omega, [omega_above, alpha_above]) = (frame.displacement, link.omega, link.above);

        // p̈ = Σ (ω̇_p × d + ω_p × (ω_p × d)  +  (ω_p + ω) × v_J)
        let mut moved = omega_above.cross_add(omega_above.cross(d), alpha_above.cross(d));
        if block.slides {
            moved = (omega_above + omega).cross_add(across(model, block, frame, v).lin, moved);
        }
        (link.acceleration.lin, _) = sum_in_segments(block, moved);
        link.inertia = turned_inertia(block, frame);
        link.force = newton_euler(&link.inertia, omega, Some(link.acceleration));
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
