//! The robot's mass and centre of mass, several joints at a time.
//!
//! Source: the definition, as in [`CenterOfMass`](crate::CenterOfMass). With h the first moment of a body's own mass, and m the mass of all
//! that it supports, the first moment of a tree about its root body's origin is `Σ (R_i h_i + m_i d_i)`. So no position is summed along
//! paths, and the robot's distance from the world's origin does not enter. The axes are those of the base until a block is summed.
//! Frame: world axes and origin. Shapes: q has `nq` numbers. Units: kg, m. Cost: O(n). A call does not allocate.

use super::lanes::{Pack, horizontal};
use super::model::PackedModel;
use super::orientation::{Frame, Orientations};
use super::trees::Poses;
use crate::error::expect;
use crate::{DimensionError, MassCenter};
use featherbench_spatial::Vec3;

/// The workspace of the centre of mass over packed joints.
#[derive(Clone, Debug)]
pub struct PackedCenterOfMass {
    orientations: Orientations,
    poses: Poses,
    blocks: usize,
}

impl PackedCenterOfMass {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        Self { orientations: Orientations::new(model), poses: Poses::new(&model.trees), blocks: model.blocks.len() }
    }

    /// Mass and centre of mass at configuration `q`.
    ///
    /// # Errors
    /// [`DimensionError`] when `q` or the workspace does not fit the model.
    pub fn run(&mut self, model: &PackedModel, q: &[f64]) -> Result<MassCenter<f64>, DimensionError> {
        self.begin(model, q)?;
        let mut moment = Vec3::zero();
        for b in 0..model.blocks.len() {
            moment += self.step(model, b, q).1;
        }
        let offset = model.trees.center(self.poses.about_first(&model.trees, horizontal(moment)));
        Ok(MassCenter { mass: model.trees.mass, position: self.poses.first() + offset })
    }

    /// Places the roots, before the first step.
    #[inline(always)]
    pub(super) fn begin(&mut self, model: &PackedModel, q: &[f64]) -> Result<(), DimensionError> {
        expect("blocks of the workspace", model.blocks.len(), self.blocks)?;
        expect("segments of the workspace", model.segments.len(), self.orientations.bases.len())?;
        expect("trees of the workspace", model.trees.roots.len(), self.poses.count())?;
        expect("configuration q", model.topology.nq(), q.len())?;
        self.poses.place(&model.trees, q);
        Ok(())
    }

    /// The frame of block `b`, the blocks before it done, and `R h + m d` of each joint in world axes.
    #[inline(always)]
    pub(super) fn step(&mut self, model: &PackedModel, b: usize, q: &[f64]) -> (Frame, Vec3<Pack>) {
        let (block, frame) = (&model.blocks[b], self.orientations.turn(model, b, q));
        let moved = model.trees.displacement(b, &frame) * block.supported;
        let moment = frame.rotation.mul_vec_add(block.inertia.first_moment, moved);
        (frame, self.poses.turn(&model.trees, b, moment))
    }

    /// The first moment about the world's origin, from the sum of those of the steps.
    #[inline(always)]
    pub(super) fn about_world(&self, model: &PackedModel, moment: Vec3<f64>) -> Vec3<f64> {
        self.poses.first().scale_add(model.trees.mass, self.poses.about_first(&model.trees, moment))
    }
}
