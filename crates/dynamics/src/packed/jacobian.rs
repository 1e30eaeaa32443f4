//! The Jacobian of a body, several joints at a time: its velocity is `J v`.
//!
//! Source: the book, body Jacobians, as in [`Jacobian`](crate::Jacobian). The column of joint j on the path is `[S_ω; S_p + S_ω × d]`, with S
//! in the axes of the base and d the displacement from the joint's origin to the body's. The sums d begin at the body. So each has the error
//! of its own length, and the robot's distance from the world's origin does not enter. Then the base's axes are turned to the world's.
//! Blocks off the path need no work.
//!
//! Frame: world axes [ang; lin] at the origin of the body's frame. Shapes: q has `nq` numbers; J has six rows of `nv` numbers, row after row.
//! Units: SI. Cost: O(n). A call does not allocate.

use super::lanes::{LANES, Lanes, Pack, STEPS, from_lanes};
use super::model::{Block, PackedModel, Source};
use super::orientation::{Frame, Orientations};
use super::rotate::rotate_down;
use crate::DimensionError;
use crate::error::expect;
use featherbench_spatial::{Mat3, Motion, Real, Vec3};
use std::ops::Range;

/// The Jacobian of a body over packed joints, and its workspace.
#[derive(Clone, Debug)]
pub struct PackedJacobian {
    orientations: Orientations,
    /// From the body to the root.
    path: Vec<Part>,
    rows: Vec<f64>,
    bodies: usize,
}

/// The joints of a segment that are on the path.
#[derive(Clone, Debug)]
struct Part {
    block: usize,
    lanes: Range<usize>,
    /// Whether they are one-dof joints.
    plain: bool,
}

impl PackedJacobian {
    /// A workspace for the Jacobian of a body of this model.
    pub fn new(model: &PackedModel) -> Self {
        Self {
            orientations: Orientations::new(model),
            path: Vec::with_capacity(model.segments.len()),
            rows: vec![0.0; 6 * model.topology.nv()],
            bodies: model.topology.bodies(),
        }
    }

    /// The Jacobian of compiled body `body` at configuration `q`: six rows of `nv` numbers.
    ///
    /// # Errors
    /// [`DimensionError`] when `q` or the workspace does not fit the model, or when there is no such body.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], body: usize) -> Result<&[f64], DimensionError> {
        expect("bodies of the workspace", model.topology.bodies(), self.bodies)?;
        expect("segments of the workspace", model.segments.len(), self.orientations.bases.len())?;
        expect("rows of the workspace", 6 * model.topology.nv(), self.rows.len())?;
        expect("configuration q", model.topology.nq(), q.len())?;
        if body >= self.bodies {
            return Err(DimensionError { what: "bodies, for the one that was named", expected: body + 1, found: self.bodies });
        }
        self.find_path(model, body);
        self.rows.fill(0.0);
        let mut turned = None;
        for Part { block, .. } in self.path.iter().rev() {
            if turned != Some(*block) {
                self.orientations.turn(model, *block, q);
                turned = Some(*block);
            }
        }
        let world = model.trees.roots[model.trees.of_body[body]].pose(q).rotation;
        // the displacement from the last joint's origin to the body's
        let mut way = Vec3::zero();
        for Part { block, lanes, plain } in &self.path {
            let (frame, block) = (&self.orientations.frames[*block], &model.blocks[*block]);
            if *plain {
                way = fill_columns(block, frame, lanes.clone(), way, &world, &mut self.rows);
            } else {
                let v = block.v[lanes.start];
                let kind = model.topology.joints()[block.first + lanes.start].kind;
                let r = frame.rotation.lane(lanes.start);
                for k in 0..kind.nv() {
                    let local: Motion<f64> = kind.column(&Motion::<f64>::zero(), k);
                    let ang = r * local.ang;
                    let lin = ang.cross_add(way, r * local.lin);
                    let column = Motion::new(world * ang, world * lin).to_array();
                    for (row, entry) in self.rows.chunks_exact_mut(model.topology.nv()).zip(column) {
                        row[v + k] = entry;
                    }
                }
                way += frame.displacement.lane(lanes.start);
            }
        }
        Ok(&self.rows)
    }

    /// The Jacobian of the last run; zero before the first.
    pub fn rows(&self) -> &[f64] {
        &self.rows
    }

    #[inline(always)]
    fn find_path(&mut self, model: &PackedModel, body: usize) {
        self.path.clear();
        let (mut block, mut lane) = (body / LANES, body % LANES);
        loop {
            let segment = &model.segments[model.blocks[block].segment[lane]];
            self.path.push(Part { block, lanes: segment.first..lane + 1, plain: segment.plain });
            (block, lane) = match segment.parent {
                Source::Root => break,
                Source::Before { block, lane } => (block, lane),
                Source::Within { lane } => (block, lane),
            };
        }
    }
}

/// Writes the columns of one-dof joints, and adds their displacements to the way from the last of them to the body.
#[inline(always)]
fn fill_columns(block: &Block, frame: &Frame, lanes: Range<usize>, way: Vec3<f64>, world: &Mat3<f64>, rows: &mut [f64]) -> Vec3<f64> {
    // Σ d_j over the joints below in these lanes: other lanes may hold what was left by a run before
    let index = from_lanes(|k| k as f64);
    let above_last = index.simd_ge(Pack::splat(lanes.start as f64)) & index.simd_lt(Pack::splat((lanes.end - 1) as f64));
    let mut below = frame.displacement.map(|d| above_last.select(rotate_down::<1>(d), Pack::zero()));
    below = below.map(rotate_down::<1>).scale_add(block.descendant[0], below);
    below = below.map(rotate_down::<2>).scale_add(block.descendant[1], below);
    if LANES > 4 {
        below = below.map(rotate_down::<{ LANES / 2 }>).scale_add(block.descendant[STEPS - 1], below);
    }

    // [S_ω; S_p + S_ω × d]
    let axis = frame.subspace.ang;
    let lin = axis.cross(Vec3::splat(way) + below);
    let lin = if block.slides { lin + frame.subspace.lin } else { lin };
    let world = Mat3::splat(*world);
    let columns = Motion::new(world * axis, world * lin).to_array();
    let nv = rows.len() / 6;
    for (row, column) in rows.chunks_exact_mut(nv).zip(columns) {
        let column = column.to_array();
        match row[block.v[lanes.start]..].first_chunk_mut() {
            Some(whole) if lanes.len() == LANES => *whole = column,
            _ => row[block.v[lanes.start]..][..lanes.len()].copy_from_slice(&column[lanes.clone()]),
        }
    }
    way + below.lane(lanes.start) + frame.displacement.lane(lanes.start)
}
