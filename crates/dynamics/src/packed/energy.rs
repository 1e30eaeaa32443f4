//! Kinetic energy `½ vᵀM v`, armature included, and potential energy `−Σ m g·c`, over packed joints.
//!
//! Source: the book, chapter 2, as in [`Energy`](crate::Energy). Twice the kinetic energy of a body is `ω·Ī ω + ṗ·(m ṗ + 2 ω × h)`, the
//! first term in body axes, the second in world axes, computed for a register of bodies at once. The potential energy follows from the
//! first moments of mass, and is zero if the centre of mass is at the world's origin.
//! Shapes: q has `nq` numbers, v has `nv`. Units: J. Cost: O(n). A call does not allocate.

use super::bodies::{Bodies, MOVING};
use super::lanes::{Pack, horizontal, load};
use super::model::{Block, PackedModel};
use crate::error::expect;
use crate::{DimensionError, Energies};
use featherbench_spatial::{Real, Vec3};

/// The workspace of energy over packed joints.
#[derive(Clone, Debug)]
pub struct PackedEnergy {
    bodies: Bodies,
}

impl PackedEnergy {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        Self { bodies: Bodies::new(model) }
    }

    /// Kinetic and potential energy at configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], v: &[f64]) -> Result<Energies<f64>, DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        self.bodies.begin(model, q)?;
        let (mut moment, mut twice_kinetic) = (Vec3::zero(), Pack::from_f64(0.0));
        for (b, block) in model.blocks.iter().enumerate() {
            self.bodies.step::<MOVING>(model, b, [q, v, &[]], |_, _, _| ());
            let (inertia, r) = (&block.inertia, self.bodies.rotation(b));
            let (omega, velocity) = (self.bodies.packed(b, |body| body.omega), self.bodies.packed(b, |body| body.velocity));
            let (h, local) = (r * inertia.first_moment, r.transpose_mul(omega));
            // m c += m p + R h
            moment += self.bodies.from_first(model, b).scale_add(inertia.mass, h);
            // 2T += ω·Ī ω + ṗ·(m ṗ + 2 ω × h) + armature q̇²
            let momentum = (omega + omega).cross_add(h, velocity * inertia.mass);
            let rate = load(block, &block.v, v);
            let own = local.dot(inertia.rotational * local) + velocity.dot(momentum);
            twice_kinetic += (rate * rate).mul_add(block.armature, own);
        }
        let twice_kinetic = twice_kinetic.reduce_add() + of_wide_armature(model, v);
        let about_world = self.bodies.first_origin().scale_add(model.trees.mass, horizontal(moment));
        Ok(Energies { kinetic: 0.5 * twice_kinetic, potential: -model.gravity.dot(about_world) })
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
