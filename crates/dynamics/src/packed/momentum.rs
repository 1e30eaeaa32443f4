//! Centroidal momentum, several joints at a time: angular momentum about the centre of mass, and linear momentum, without armature.
//!
//! Source: Orin, Goswami & Lee (2013), as in [`Momentum`](crate::Momentum). In world axes, with p_i from the first root body's origin o:
//! `f = Σ (m ṗ_i + ω_i × h_i)`, `n = Σ (Ī_i ω_i + h_i × ṗ_i + p_i × f_i)`, and about the centre of mass `n − (c − o) × f`. The rotational
//! inertia Ī multiplies ω in body axes. Frame: world axes, at the centre of mass. Shapes: q has `nq` numbers, v has `nv`. Units: kg·m²/s and
//! kg·m/s. Cost: O(n). A call does not allocate.

use super::kinematics::{MOVING, PackedKinematics};
use super::lanes::horizontal;
use super::model::PackedModel;
use crate::error::expect;
use crate::{CentroidalMomentum, DimensionError, MassCenter};
use featherbench_spatial::{Force, Vec3};

/// The workspace of centroidal momentum over packed joints.
#[derive(Clone, Debug)]
pub struct PackedMomentum {
    kinematics: PackedKinematics,
}

impl PackedMomentum {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        Self { kinematics: PackedKinematics::new(model) }
    }

    /// Centroidal momentum at configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], v: &[f64]) -> Result<CentroidalMomentum<f64>, DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        self.kinematics.begin(model, q)?;
        let (mut moment, mut sum) = (Vec3::zero(), Force::zero());
        for b in 0..model.blocks.len() {
            let (frame, link) = self.kinematics.step::<MOVING>(model, b, q, v, &[]);
            let (inertia, r, velocity) = (&model.blocks[b].inertia, frame.rotation, link.velocity);
            let p = self.kinematics.poses.from_first(&model.trees, b, link.from_root);
            let h = r * inertia.first_moment;
            let spin = r * (inertia.rotational * r.transpose_mul(velocity.ang));
            let f = velocity.ang.cross_add(h, velocity.lin * inertia.mass);
            moment += p.scale_add(inertia.mass, h);
            sum.lin += f;
            sum.ang += p.cross_add(f, h.cross_add(velocity.lin, spin));
        }
        let (total, lin) = (horizontal(sum.ang), horizontal(sum.lin));
        let (offset, mass) = (model.trees.center(horizontal(moment)), model.trees.mass);
        let center = MassCenter { mass, position: self.kinematics.poses.first() + offset };
        Ok(CentroidalMomentum { center, momentum: Force::new(total - offset.cross(lin), lin) })
    }
}
