//! Centroidal momentum over packed joints: angular momentum about the centre of mass, and linear momentum, without armature.
//!
//! Source: Orin, Goswami & Lee (2013), as in [`Momentum`](crate::Momentum). In world axes, with p_i from the first root body's origin o:
//! `f = Σ (m ṗ_i + ω_i × h_i)`, `n = Σ (Ī_i ω_i + h_i × ṗ_i + p_i × f_i)`, and about the centre of mass `n − (c − o) × f`. The rotational
//! inertia Ī multiplies ω in body axes. The terms are computed for a register of bodies at once, and summed at the end.
//! Frame: world axes, at the centre of mass. Shapes: q has `nq` numbers, v has `nv`. Units: kg·m²/s and kg·m/s. Cost: O(n). A call does not
//! allocate.

use super::bodies::{Bodies, MOVING};
use super::lanes::horizontal;
use super::model::PackedModel;
use crate::error::expect;
use crate::{CentroidalMomentum, DimensionError, MassCenter};
use featherbench_spatial::{Force, Vec3};

/// The workspace of centroidal momentum over packed joints.
#[derive(Clone, Debug)]
pub struct PackedMomentum {
    bodies: Bodies,
}

impl PackedMomentum {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        Self { bodies: Bodies::new(model) }
    }

    /// Centroidal momentum at configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], v: &[f64]) -> Result<CentroidalMomentum<f64>, DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        self.bodies.begin(model, q)?;
        let (mut moment, mut sum) = (Vec3::zero(), Force::zero());
        self.bodies.across_all_joints::<MOVING>(model, [q, v, &[]]);
        for (b, block) in model.blocks.iter().enumerate() {
            self.bodies.step::<MOVING>(model, b, [v, &[]], |_, _, _, _| ());
            let (inertia, r) = (&block.inertia, self.bodies.rotation(b));
            let (omega, velocity) = (self.bodies.packed(b, |body| body.omega), self.bodies.packed(b, |body| body.velocity));
            let p = self.bodies.seen_from_first(model, b);
            let h = r * inertia.first_moment;
            let spin = r * (inertia.rotational * r.transpose_mul(omega));
            let f = omega.cross_add(h, velocity * inertia.mass);
            moment += p.scale_add(inertia.mass, h);
            sum.lin += f;
            sum.ang += p.cross_add(f, h.cross_add(velocity, spin));
        }
        let (ang, lin) = (horizontal(sum.ang), horizontal(sum.lin));
        let (offset, mass) = (model.trees.center(horizontal(moment)), model.trees.mass);
        let center = MassCenter { mass, position: self.bodies.first_origin() + offset };
        Ok(CentroidalMomentum { center, momentum: Force::new(ang - offset.cross(lin), lin) })
    }
}
