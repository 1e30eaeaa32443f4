//! Inverse dynamics by the recursive Newton–Euler algorithm, several joints at a time: `τ = M(q) v̇ + h(q, v) − Σ Jᵀf`.
//!
//! Source: the book, table 5.1, as in [`Rnea`](crate::Rnea). In world axes:
//!
//! 1. R, ω, ω̇ and p̈ of each body as in `bodies.rs`, a vector in a register;
//! 2. the force f_i and moment n_i that a body needs, for a register of bodies at once. Its rotational inertia multiplies in body axes;
//! 3. F_i = Σ f over the supported bodies, N_i = n_i + Σ (N_c + d_c × F_c) over the children, τ_i = (R_i S_i)ᵀ [N_i; F_i].
//!
//! Frames: external wrenches [moment; force] are in each body's described axes, at its own origin, one per compiled body.
//! Gravity enters as an acceleration −g of every body. Armature adds `armature_k · v̇_k`.
//! Shapes: q has `nq` numbers; v, a and τ have `nv`. Units: SI, angles in radians. Cost: O(n). A call does not allocate.

use super::bodies::{ACCELERATIONS, ANGULAR_VELOCITIES, Bodies};
use super::lanes::{LANES, Lanes, Pack, store, sum_from_leaves};
use super::model::{Block, PackedModel};
use super::orientation::straightened;
use super::xyz::{Xyz, transposed};
use crate::DimensionError;
use crate::error::expect;
use crate::step::expect_wrenches;
use featherbench_spatial::{Force, Mat3, Motion, Real, Vec3};

/// The workspace of inverse dynamics over packed joints.
///
/// # Cost
///
/// A register of eight joints takes 39 operations for the rotations across them (21 for sine and cosine), 150 for the forces, and 39 for the
/// sums and the projection. The walk over the bodies takes 29 operations in registers of one vector per revolute joint. There is no division.
/// The rotations across the joints of all blocks come first, because each orientation waits for the one before. Times, and what was tried:
/// `docs/kernels/rnea.md`.
#[derive(Clone, Debug)]
pub struct PackedRnea {
    bodies: Bodies,
    /// Displacement d of each body's origin from its parent's.
    displacements: Vec<Xyz>,
    links: Vec<Link>,
    totals: Totals,
}

/// Of a block's bodies, in world axes.
#[derive(Clone, Copy, Debug)]
struct Link {
    /// The force that a body needs for its acceleration, less external wrenches.
    force: Force<Pack>,
    displacement: Vec3<Pack>,
    /// Motion subspace of each one-dof joint.
    subspace: Motion<Pack>,
}

impl PackedRnea {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        let link = Link { force: Force::zero(), displacement: Vec3::zero(), subspace: Motion::zero() };
        Self {
            bodies: Bodies::new(model),
            displacements: vec![Xyz::splat(0.0); model.blocks.len() * LANES],
            links: vec![link; model.blocks.len()],
            totals: Totals::new(model),
        }
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
        expect("velocity v", model.topology.nv(), v.len())?;
        expect("acceleration a", model.topology.nv(), a.len())?;
        expect("joint forces tau", model.topology.nv(), tau.len())?;
        self.bodies.begin(model, q)?;
        self.move_bodies(model, [q, v, a], wrenches)?;
        self.project(model, tau);
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
        expect("velocity v", model.topology.nv(), v.len())?;
        expect("bias force h", model.topology.nv(), h.len())?;
        self.bodies.begin(model, q)?;
        h.fill(0.0);
        self.move_bodies(model, [q, v, h], wrenches)?;
        self.project(model, h);
        Ok(())
    }

    /// Steps 1 and 2.
    #[inline(always)]
    fn move_bodies(&mut self, model: &PackedModel, numbers: [&[f64]; 3], wrenches: Option<&[Force<f64>]>) -> Result<(), DimensionError> {
        expect("segments of the workspace", model.segments.len(), self.totals.forces.len())?;
        expect_wrenches(&model.topology, wrenches)?;
        self.bodies.across_all_joints::<{ ANGULAR_VELOCITIES + ACCELERATIONS }>(model, numbers);
        for b in 0..model.blocks.len() {
            let displacements = &mut self.displacements[b * LANES..][..LANES];
            self.bodies
                .step::<{ ANGULAR_VELOCITIES + ACCELERATIONS }>(model, b, [numbers[1], numbers[2]], |k, _, _, d| displacements[k] = d);
        }
        for b in 0..model.blocks.len() {
            self.push(model, b);
        }
        if let Some(wrenches) = wrenches {
            for (b, (block, link)) in model.blocks.iter().zip(&mut self.links).enumerate() {
                subtract_wrenches(model, block, wrenches, |k| self.bodies.orientation(b * LANES + k), &mut link.force);
            }
        }
        Ok(())
    }

    /// Step 2 for a block. It is a function of its own: `docs/kernels/rnea.md`.
    #[inline(never)]
    fn push(&mut self, model: &PackedModel, b: usize) {
        let (block, r) = (&model.blocks[b], straightened(self.bodies.rotation(b)));
        let (omega, alpha) = (self.bodies.packed(b, |body| body.omega), self.bodies.packed(b, |body| body.alpha));
        let acceleration = self.bodies.packed(b, |body| body.acceleration) - Vec3::splat(model.gravity);
        let (inertia, own_omega) = (&block.inertia, r.transpose_mul(omega));
        // n = R (Ī ω̇ + ω × Ī ω) + h × p̈,  f = m p̈ + ω̇ × h + ω × (ω × h)
        let spin = own_omega.cross_add(inertia.rotational * own_omega, inertia.rotational * r.transpose_mul(alpha));
        let h = r * inertia.first_moment;
        let lin = omega.cross_add(omega.cross(h), alpha.cross_add(h, acceleration * inertia.mass));
        let force = Force::new(h.cross_add(acceleration, r * spin), lin);
        let own: &[Xyz; LANES] = self.displacements[b * LANES..][..LANES].try_into().expect("a block has LANES bodies");
        let sliding = if block.slides { r * block.subspace.lin } else { Vec3::zero() };
        let subspace = Motion::new(r * block.subspace.ang, sliding);
        self.links[b] = Link { force, displacement: transposed(|k| own[k]), subspace };
    }

    /// Step 3: the joint forces of the bodies' forces.
    #[inline(always)]
    fn project(&mut self, model: &PackedModel, tau: &mut [f64]) {
        let still = Vec3::zero();
        for (b, block) in model.blocks.iter().enumerate().rev() {
            let Link { force, displacement, subspace } = &self.links[b];
            // F_i = Σ f,  N_i = n_i + Σ (N_c + d_c × F_c)
            let (lin, _) = sum_from_leaves(model, block, force.lin, still, &mut self.totals.forces);
            let arm = displacement.cross(lin);
            let (ang, _) = sum_from_leaves(model, block, force.ang, arm, &mut self.totals.moments);
            // τ = Sᵀ [N; F]
            let along = if block.slides { subspace.dot(Force::new(ang, lin)) } else { subspace.ang.dot(ang) };
            store(block, along, tau);
            for wide in &model.wide[block.wide.clone()] {
                let r = self.bodies.orientation(b * LANES + wide.lane);
                let local = Force::new(r.transpose_mul(ang.lane(wide.lane)), r.transpose_mul(lin.lane(wide.lane)));
                wide.kind.project(&Motion::<f64>::zero(), local, &mut tau[block.v[wide.lane]..]);
            }
        }
    }
}

/// Subtracts the external wrenches on the bodies of a block, given in described axes, from the forces that the bodies need.
#[inline(always)]
pub(super) fn subtract_wrenches(
    model: &PackedModel,
    block: &Block,
    wrenches: &[Force<f64>],
    orientation: impl Fn(usize) -> Mat3<f64>,
    force: &mut Force<Pack>,
) {
    for (k, wrench) in wrenches[block.first..block.first + block.count].iter().enumerate() {
        let (r, wrench) = (orientation(k), model.labels[block.first + k].force_to_compiled(*wrench));
        force.ang.set_lane(k, force.ang.lane(k) - r * wrench.ang);
        force.lin.set_lane(k, force.lin.lane(k) - r * wrench.lin);
    }
}

/// τ_k += armature_k q̈_k
fn add_armature(model: &PackedModel, a: &[f64], tau: &mut [f64]) {
    for ((tau, a), armature) in tau.iter_mut().zip(a).zip(&model.armature) {
        *tau = Real::mul_add(*a, *armature, *tau);
    }
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
}
