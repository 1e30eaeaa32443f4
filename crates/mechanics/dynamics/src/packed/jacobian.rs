//! The Jacobian of a body, several joints at a time: its velocity is `J v`.
//!
//! Source: the book, body Jacobians, as in [`Jacobian`](crate::Jacobian). The column of joint j on the path is `[S_ω; S_p + S_ω × d]`, with S
//! in world axes and d the displacement from the joint's origin to the body's. The sums d begin at the body. So each has the error of its
//! own length, and the robot's distance from the world's origin does not enter. Bodies off the path need no work.
//!
//! Frame: world axes [ang; lin] at the origin of the body's frame. Shapes: q has `nq` numbers; J has `nv` columns of six.
//! Units: SI. Cost: O(n). A call does not allocate.

use super::bodies::{Bodies, Body, TURNED};
use super::lanes::{LANES, Lanes};
use super::model::PackedModel;
use super::xyz::{Xyz, cross, times, vector};
use crate::DimensionError;
use crate::error::expect;
use featherbench_model::JointKind;
use featherbench_spatial::{Motion, Vec3};
use std::ops::Range;

/// The Jacobian of a body over packed joints, and its workspace.
#[derive(Clone, Debug)]
pub struct PackedJacobian {
    bodies: Bodies,
    /// The displacement from the parent's origin of each body on the path, in world axes.
    steps: Vec<Xyz>,
    /// From the body to the root.
    parts: Vec<Part>,
    columns: Vec<Motion<f64>>,
}

/// The joints of a segment that are on the path.
#[derive(Clone, Debug)]
struct Part {
    block: usize,
    segment: usize,
    lanes: Range<usize>,
}

impl PackedJacobian {
    /// A workspace for the Jacobian of a body of this model.
    pub fn new(model: &PackedModel) -> Self {
        Self {
            bodies: Bodies::new(model),
            steps: vec![Xyz::splat(0.0); model.blocks.len() * LANES],
            parts: Vec::with_capacity(model.segments.len()),
            columns: vec![Motion::zero(); model.topology.nv()],
        }
    }

    /// The Jacobian of compiled body `body` at configuration `q`: one column per dof.
    ///
    /// # Errors
    /// [`DimensionError`] when `q` or the workspace does not fit the model, or when there is no such body.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], body: usize) -> Result<&[Motion<f64>], DimensionError> {
        self.bodies.begin(model, q)?;
        expect("columns of the workspace", model.topology.nv(), self.columns.len())?;
        if body >= model.topology.bodies() {
            let found = model.topology.bodies();
            return Err(DimensionError { what: "bodies, for the one that was named", expected: body + 1, found });
        }
        self.find_parts(model, body);
        self.follow(model, q);
        self.columns.fill(Motion::zero());
        // the displacement from the joint's origin to the body's
        let mut way = Xyz::splat(0.0);
        for part in &self.parts {
            let (block, from) = (&model.blocks[part.block], part.block * LANES);
            for k in part.lanes.clone().rev() {
                let rotation = self.bodies.bodies[from + k].rotation;
                if block.is_screw[k] {
                    let ang = times(rotation, block.subspace.ang.lane(k));
                    let turned = cross(ang, way);
                    let lin = if block.slides { turned + times(rotation, block.subspace.lin.lane(k)) } else { turned };
                    self.columns[block.v[k]] = Motion::new(vector(ang), vector(lin));
                } else {
                    // S is made of unit vectors: those of the free joint's translation come first
                    let columns = &mut self.columns[block.v[k]..];
                    let turns = if model.topology.joints()[from + k].kind == JointKind::Free { 3 } else { 0 };
                    for (dof, axis) in rotation.into_iter().enumerate() {
                        if turns > 0 {
                            columns[dof] = Motion::new(Vec3::zero(), vector(axis));
                        }
                        columns[turns + dof] = Motion::new(vector(axis), vector(cross(axis, way)));
                    }
                }
                way += self.steps[from + k];
            }
        }
        Ok(&self.columns)
    }

    /// The columns of the last run; zero before the first.
    pub fn columns(&self) -> &[Motion<f64>] {
        &self.columns
    }

    #[inline(always)]
    fn find_parts(&mut self, model: &PackedModel, body: usize) {
        self.parts.clear();
        let mut next = Some(body);
        while let Some(body) = next {
            let (block, lane) = (body / LANES, body % LANES);
            let segment = model.blocks[block].segment[lane];
            self.parts.push(Part { block, segment, lanes: model.segments[segment].first..lane + 1 });
            next = model.segments[segment].parent.body(block);
        }
    }

    /// Turns the bodies on the path, from the root.
    #[inline(always)]
    fn follow(&mut self, model: &PackedModel, q: &[f64]) {
        let Self { bodies, parts, steps, .. } = self;
        let mut last = None;
        for part in parts.iter().rev() {
            if last != Some(part.block) {
                bodies.across_joints::<TURNED>(model, part.block, [q, &[], &[]]);
                last = Some(part.block);
            }
        }
        for Part { block: b, segment, lanes, .. } in parts.iter().rev() {
            let steps = &mut steps[b * LANES..][..LANES];
            let place = (*b, &model.segments[*segment], lanes.end);
            bodies.run_segment::<TURNED>(model, place, [&[], &[]], &mut |k, _: &Body, _: &Body, d| steps[k] = d);
        }
    }
}
