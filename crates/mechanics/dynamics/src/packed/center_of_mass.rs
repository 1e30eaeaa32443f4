//! The robot's mass and centre of mass over packed joints.
//!
//! Source: the definition, as in [`CenterOfMass`](crate::CenterOfMass). With h the first moment of a body's own mass, and m the mass of all
//! that it supports, the first moment of a tree about its root body's origin is `Σ (R_i h_i + m_i d_i)`. So no position is summed along
//! paths, and the robot's distance from the world's origin does not enter.
//! Frame: world axes and origin. Shapes: q has `nq` numbers. Units: kg, m. Cost: O(n). A call does not allocate.

use super::bodies::{Bodies, Body, TURNED};
use super::lanes::Lanes;
use super::model::{Block, PackedModel};
use super::xyz::{Xyz, times, vector};
use crate::{DimensionError, MassCenter};

/// The workspace of the centre of mass over packed joints.
#[derive(Clone, Debug)]
pub struct PackedCenterOfMass {
    bodies: Bodies,
}

impl PackedCenterOfMass {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        Self { bodies: Bodies::new(model) }
    }

    /// Mass and centre of mass at configuration `q`.
    ///
    /// # Errors
    /// [`DimensionError`] when `q` or the workspace does not fit the model.
    pub fn run(&mut self, model: &PackedModel, q: &[f64]) -> Result<MassCenter<f64>, DimensionError> {
        self.bodies.begin(model, q)?;
        let mut moment = Xyz::splat(0.0);
        self.bodies.across_all_joints::<TURNED>(model, [q, &[], &[]]);
        for (b, block) in model.blocks.iter().enumerate() {
            let mut first_moment = FirstMoment::zero();
            self.bodies.step::<TURNED>(model, b, [&[], &[]], |k, _, body, d| first_moment.add(block, k, body, d));
            moment += first_moment.total();
        }
        let offset = model.trees.center(self.bodies.about_first(model, vector(moment)));
        Ok(MassCenter { mass: model.trees.mass, position: self.bodies.first_origin() + offset })
    }
}

/// The first moment of mass of a block, about the root bodies' origins.
pub(super) struct FirstMoment {
    /// Σ R h.
    own: Xyz,
    /// Σ m d.
    moved: Xyz,
}

impl FirstMoment {
    #[inline(always)]
    pub(super) fn zero() -> Self {
        Self { own: Xyz::splat(0.0), moved: Xyz::splat(0.0) }
    }

    /// Adds the body in lane k and what it supports.
    #[inline(always)]
    pub(super) fn add(&mut self, block: &Block, k: usize, body: &Body, d: Xyz) {
        self.own += times(body.rotation, block.inertia.first_moment.lane(k));
        self.moved = d.mul_add(Xyz::splat(block.supported.lane(k)), self.moved);
    }

    #[inline(always)]
    pub(super) fn total(self) -> Xyz {
        self.own + self.moved
    }
}
