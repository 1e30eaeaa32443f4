//! Kinetic energy `½ vᵀM v`, armature included, and potential energy `−Σ m g·c`, several joints at a time.
//!
//! Source: the book, chapter 2, as in [`Energy`](crate::Energy). Twice the kinetic energy of a body is `ω·Ī ω + ṗ·(m ṗ + 2 ω × h)`, in the
//! axes of the base, and the first term in body axes. The potential energy follows from the centre of mass, and is zero if that is at the
//! world's origin. Shapes: q has `nq` numbers, v has `nv`. Units: J. Cost: O(n). A call does not allocate.

use super::center_of_mass::PackedCenterOfMass;
use super::lanes::{Lanes, Pack, horizontal, load, sum_from_root};
use super::model::{Block, PackedModel};
use super::orientation::{Frame, across};
use crate::error::expect;
use crate::{DimensionError, Energies};
use featherbench_spatial::{Motion, Real, Vec3};

/// The workspace of energy over packed joints.
#[derive(Clone, Debug)]
pub struct PackedEnergy {
    center: PackedCenterOfMass,
    /// Velocity [ω; ṗ] of each body's origin, in the axes of the base.
    velocities: Vec<Motion<Pack>>,
}

impl PackedEnergy {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        Self { center: PackedCenterOfMass::new(model), velocities: vec![Motion::zero(); model.blocks.len()] }
    }

    /// Kinetic and potential energy at configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], v: &[f64]) -> Result<Energies<f64>, DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        self.center.begin(model, q)?;
        let (mut moment, mut twice_kinetic) = (Vec3::zero(), Pack::zero());
        for b in 0..model.blocks.len() {
            let (frame, own) = self.center.step(model, b, q);
            moment += own;
            twice_kinetic += self.twice_kinetic(model, b, &frame, v);
        }
        let twice_kinetic = twice_kinetic.reduce_add() + of_wide_armature(model, v);
        let potential = -model.gravity.dot(self.center.about_world(model, horizontal(moment)));
        Ok(Energies { kinetic: 0.5 * twice_kinetic, potential })
    }

    /// Twice the kinetic energy of each body and one-dof joint of a block, the blocks before it done.
    #[inline(always)]
    fn twice_kinetic(&mut self, model: &PackedModel, b: usize, frame: &Frame, v: &[f64]) -> Pack {
        let (block, velocities) = (&model.blocks[b], &mut self.velocities);
        let rate = across(model, block, frame, v);
        // ω = Σ R S q̇,  ṗ = Σ (ω_p × d + v_J)
        let before = |block: usize, lane: usize| velocities[block].ang.lane(lane);
        let (omega, above) = sum_from_root(model, block, rate.ang, before, |_| Vec3::zero());
        let swing = above.cross(frame.displacement);
        let carried = if block.slides { swing + rate.lin } else { swing };
        let before = |block: usize, lane: usize| velocities[block].lin.lane(lane);
        let (lin, _) = sum_from_root(model, block, carried, before, |_| Vec3::zero());
        velocities[b] = Motion::new(omega, lin);

        // 2T = ω·Ī ω + ṗ·(m ṗ + 2 ω × h) + armature q̇²
        let inertia = &block.inertia;
        let local = frame.rotation.transpose_mul(omega);
        let h = frame.rotation * inertia.first_moment;
        let momentum = (omega + omega).cross_add(h, lin * inertia.mass);
        let rate = load(block, &block.v, v);
        (rate * rate).mul_add(block.armature, local.dot(inertia.rotational * local) + lin.dot(momentum))
    }
}

/// `Σ armature_k q̇_k²` over the dofs of wide joints.
#[inline(always)]
fn of_wide_armature(model: &PackedModel, v: &[f64]) -> f64 {
    let of_block = |block: &Block| {
        let dofs = model.wide[block.wide.clone()].iter().flat_map(|wide| (0..wide.kind.nv()).map(|k| block.v[wide.lane] + k));
        dofs.fold(0.0, |sum, k| Real::mul_add(model.armature[k] * v[k], v[k], sum))
    };
    model.blocks.iter().map(of_block).sum()
}
