//! The Jacobian of a body, several joints at a time: its velocity is `J v`.
//!
//! Source: the book, body Jacobians, as in [`Jacobian`](crate::Jacobian). The column of joint j on the path is `[S_ω; S_p + S_ω × d]`, with S
//! in world axes and d the displacement from the joint's origin to the body's. The sums d begin at the body. So each has the error of its
//! own length, and the robot's distance from the world's origin does not enter. Bodies off the path need no work.
//!
//! Frame: world axes [ang; lin] at the origin of the body's frame. Shapes: q has `nq` numbers; J has `nv` columns of six.
//! Units: SI. Cost: O(n). A call does not allocate.

use super::bodies::{Bodies, Body, TURNED, across_joints};
use super::lanes::{LANES, Lanes};
use super::model::{PackedModel, Source};
use super::xyz::{Xyz, cross, times, vector};
use crate::DimensionError;
use crate::error::expect;
use featherbench_spatial::Motion;

/// The Jacobian of a body over packed joints, and its workspace.
#[derive(Clone, Debug)]
pub struct PackedJacobian {
    bodies: Bodies,
    /// Block, segment and last joint of each part of the path, from the body to the root.
    parts: Vec<[usize; 3]>,
    /// From the root to the body.
    path: Vec<Link>,
    columns: Vec<Motion<f64>>,
}

/// A body on the path, in world axes.
#[derive(Clone, Copy, Debug)]
struct Link {
    body: usize,
    rotation: [Xyz; 3],
    /// The displacement from the parent's origin.
    step: Xyz,
}

impl PackedJacobian {
    /// A workspace for the Jacobian of a body of this model.
    pub fn new(model: &PackedModel) -> Self {
        Self {
            bodies: Bodies::new(model),
            parts: Vec::with_capacity(model.segments.len()),
            path: Vec::with_capacity(model.topology.bodies()),
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
        for Link { body, rotation, step } in self.path.iter().rev() {
            let (block, k) = (&model.blocks[body / LANES], body % LANES);
            if block.is_screw[k] {
                let ang = times(*rotation, block.subspace.ang.lane(k));
                let turned = cross(ang, way);
                let lin = if block.slides { turned + times(*rotation, block.subspace.lin.lane(k)) } else { turned };
                self.columns[block.v[k]] = Motion::new(vector(ang), vector(lin));
            } else {
                let kind = model.topology.joints()[*body].kind;
                for (column, k) in self.columns[block.v[k]..].iter_mut().zip(0..kind.nv()) {
                    let local: Motion<f64> = kind.column(&Motion::<f64>::zero(), k);
                    let ang = times(*rotation, local.ang);
                    *column = Motion::new(vector(ang), vector(cross(ang, way) + times(*rotation, local.lin)));
                }
            }
            way += *step;
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
        let (mut block, mut lane) = (body / LANES, body % LANES);
        loop {
            let segment = model.blocks[block].segment[lane];
            self.parts.push([block, segment, lane]);
            (block, lane) = match model.segments[segment].parent {
                Source::Root => break,
                Source::Before { block, lane } => (block, lane),
                Source::Within { lane } => (block, lane),
            };
        }
    }

    /// Turns the bodies on the path, from the root.
    #[inline(always)]
    fn follow(&mut self, model: &PackedModel, q: &[f64]) {
        let Self { bodies, parts, path, .. } = self;
        path.clear();
        let mut parts = parts.iter().rev().peekable();
        while let Some([b, ..]) = parts.peek() {
            let (b, local) = (*b, across_joints::<TURNED>(model, *b, [q, &[], &[]]));
            while let Some([_, segment, last]) = parts.next_if(|part| part[0] == b) {
                let mut visit = |k, body: &Body, step| {
                    path.push(Link { body: b * LANES + k, rotation: body.rotation, step });
                };
                bodies.run_segment::<TURNED>(model, (b, &model.segments[*segment], last + 1), &local, [&[], &[]], &mut visit);
            }
        }
    }
}
