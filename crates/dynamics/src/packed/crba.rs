//! The joint-space inertia matrix M(q) by the composite-rigid-body algorithm in the axes of the base, into a tree-sparse matrix.
//!
//! Source: the book, table 6.2, as in [`Crba`](crate::Crba). In the axes of the base:
//!
//! 1. First moments are sums from the leaves, `H_i = h_i + Σ (H_c + m_c d_c)`; the masses m are parameters. They give the centre of mass of
//!    each body with what it supports, and the centre c' of what it supports without itself.
//! 2. Rotational inertias E about these centres are sums from the leaves too: `E_i = e_i + μ_i P(x_i − c'_i) + Σ (E_c + m_c P(y_c − c'_i))`.
//!    The body's own e is about its own centre x, `P(r) = r² 1 − r rᵀ` is the inertia of a unit mass, `μ = m m'/(m + m')`, and y is
//!    the child's centre from the body's origin. Of an only child the last term is zero.
//! 3. The forces `F_i = Iᶜ_i S_i`, several joints at a time.
//! 4. The rows i of a segment have the same ancestors j. The forces F_i of these rows are moved together to the origin of each segment on
//!    the path to the root. There `M_ij = S_jᵀ F_i` for a register of ancestors at once, because the subspaces S_j of a segment are kept at
//!    its first joint's origin too. So no lever arm is longer than a segment.
//!
//! Armature is added to the diagonal. Shapes: q has `nq` numbers; M is `nv`×`nv`. Units: SI, angles in radians.
//! Cost: O(n + Σ d_k), d_k the depth of dof k. A call does not allocate.

use super::lanes::{LANES, Lanes, Pack, of_parents, sum_from_leaves, sum_in_segments};
use super::model::{PackedModel, Source};
use super::orientation::{Orientations, own_force};
use crate::error::expect;
use crate::{DimensionError, TreeSparse};
use featherbench_model::JointKind;
use featherbench_spatial::{CentralInertia, Force, Motion, Real, Sym3, Vec3};
use std::ops::Range;

/// The workspace of the composite-rigid-body algorithm over packed joints.
#[derive(Clone, Debug)]
pub struct PackedCrba {
    orientations: Orientations,
    composites: Vec<Composite>,
    /// What segments pass to their parents.
    first_moments: Vec<Vec3<f64>>,
    rotational: Vec<Sym3<f64>>,
}

/// Composite bodies of a block, at each joint's origin.
#[derive(Clone, Copy, Debug)]
struct Composite {
    /// Centre of mass of each body with what it supports.
    com: Vec3<Pack>,
    /// What each body supports, without the body.
    carried: CentralInertia<Pack>,
    /// F of the one-dof joints at their origins.
    force: Force<Pack>,
    /// Sᵀ F and armature of the one-dof joints.
    diagonal: Pack,
    /// Each joint's position from the first joint of its segment, and the one-dof joints' subspaces at that joint's origin.
    position: Vec3<Pack>,
    subspace: Motion<Pack>,
}

impl PackedCrba {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        let still = Motion::zero();
        let composite = Composite {
            com: Vec3::zero(),
            carried: CentralInertia::zero(),
            force: Force::zero(),
            diagonal: Pack::zero(),
            position: Vec3::zero(),
            subspace: still,
        };
        Self {
            orientations: Orientations::new(model),
            composites: vec![composite; model.blocks.len()],
            first_moments: vec![Vec3::zero(); model.segments.len()],
            rotational: vec![Sym3::zero(); model.segments.len()],
        }
    }

    /// The joint-space inertia matrix `matrix` of configuration `q`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], matrix: &mut TreeSparse<f64>) -> Result<(), DimensionError> {
        expect("blocks of the workspace", model.blocks.len(), self.composites.len())?;
        expect("segments of the workspace", model.segments.len(), self.rotational.len())?;
        expect("configuration q", model.topology.nq(), q.len())?;
        matrix.expect_topology(&model.topology)?;

        self.orientations.turn(model, q);
        for b in (0..model.blocks.len()).rev() {
            self.find_centers(model, b);
        }
        for b in (0..model.blocks.len()).rev() {
            self.compose(model, b);
        }
        for b in 0..model.blocks.len() {
            for s in model.blocks[b].segments.clone() {
                self.fill_rows(model, b, s, matrix);
            }
        }
        Ok(())
    }

    /// Step 1 for a block; the blocks after it are done.
    #[inline(always)]
    fn find_centers(&mut self, model: &PackedModel, b: usize) {
        let (block, frame, composite) = (&model.blocks[b], &self.orientations.frames[b], &mut self.composites[b]);
        let own = frame.rotation * block.inertia.first_moment;
        let moved = frame.displacement * block.supported;
        let (first_moment, carried) = sum_from_leaves(model, block, own, moved, &mut self.first_moments);
        composite.com = first_moment * block.inverse_supported;
        (composite.carried.mass, composite.carried.com) = (block.carried, carried * block.inverse_carried);
    }

    /// Steps 2 and 3 for a block; the blocks after it are done.
    #[inline(always)]
    fn compose(&mut self, model: &PackedModel, b: usize) {
        let (block, frame) = (&model.blocks[b], &self.orientations.frames[b]);
        let (r, d) = (frame.rotation, frame.displacement);
        let Composite { com, mut carried, .. } = self.composites[b];

        let apart = r * block.central.com - carried.com;
        let own = block.central.rotational.rotate(r) + Sym3::point_mass(block.reduced, apart);
        let passed = if block.shares {
            let centers = of_parents(model, block, carried.com, |block, lane| self.composites[block].carried.com.lane(lane));
            Sym3::point_mass(block.supported, com + d - centers)
        } else {
            Sym3::zero()
        };
        (_, carried.rotational) = sum_from_leaves(model, block, own, passed, &mut self.rotational);

        let (position, _) = sum_in_segments(block, d.map(|d| d * block.ancestor[0]));
        let axis = frame.subspace.ang;
        // F = I S of the body alone and of what it supports
        let (along, lin) = if block.slides {
            (carried.mul(frame.subspace), position.cross_add(axis, frame.subspace.lin))
        } else {
            let lin = axis.cross(carried.com) * carried.mass;
            (Force::new(carried.com.cross_add(lin, carried.rotational * axis), lin), position.cross(axis))
        };
        let force = along + own_force(block, frame);
        let diagonal = frame.subspace.dot(along) + block.subspace_inertia + block.armature;
        self.composites[b] = Composite { com, carried, force, diagonal, position, subspace: Motion::new(axis, lin) };
    }

    /// Step 4 for the rows of a segment.
    #[inline(always)]
    fn fill_rows(&self, model: &PackedModel, b: usize, s: usize, matrix: &mut TreeSparse<f64>) {
        let (block, segment, composite) = (&model.blocks[b], &model.segments[s], &self.composites[b]);
        let (rows, values) = matrix.parts_mut();
        if segment.plain {
            let lanes = segment.first..segment.end;
            let starts = std::array::from_fn(|k| if lanes.contains(&k) { rows[block.v[k]].start } else { 0 });
            let mut forces = Rows { lanes: lanes.clone(), starts, force: composite.force };
            forces.move_by(composite.position);
            for k in lanes {
                let along = forces.project(k, &composite.subspace);
                put(values, starts[k] + block.depth[segment.first], along, segment.first..k + 1, segment.roomy);
                values[starts[k] + block.depth[k]] = composite.diagonal.lane(k);
            }
            self.climb(model, b, s, forces, values);
        } else {
            let lane = segment.first;
            let (r, kind) = (self.orientations.frames[b].rotation.lane(lane), model.topology.joints()[block.first + lane].kind);
            // in body axes: the body's own inertia as it is, and what it supports
            let (own, carried) = (block.inertia.lane(lane), composite.carried.lane(lane));
            let turned =
                CentralInertia { com: r.transpose_mul(carried.com), rotational: carried.rotational.rotate(r.transpose()), ..carried };
            // three columns of the wide joint at a time
            for first in (0..kind.nv()).step_by(3) {
                let mut force = Force::zero();
                let mut starts = [0; LANES];
                for column in 0..3 {
                    let axis = kind.column(&Motion::<f64>::zero(), first + column);
                    let local = own.mul(axis) + turned.mul(axis);
                    force.set_lane(column, Force::new(r * local.ang, r * local.lin));
                    starts[column] = rows[block.v[lane] + first + column].start;
                    let entries = &mut values[starts[column] + block.depth[lane]..];
                    put_wide(kind, local, first + column + 1, entries);
                    entries[first + column] += model.armature[block.v[lane] + first + column];
                }
                self.climb(model, b, s, Rows { lanes: 0..3, starts, force }, values);
            }
        }
    }

    /// The entries of rows in the columns of all segments above segment s of block b.
    #[inline(always)]
    fn climb(&self, model: &PackedModel, b: usize, s: usize, mut forces: Rows, values: &mut [f64]) {
        let (mut b, mut s) = (b, s);
        loop {
            let d = self.orientations.frames[b].displacement.lane(model.segments[s].first);
            let last;
            (b, last) = match model.segments[s].parent {
                Source::Root => break,
                Source::Before { block, lane } => (block, lane),
                Source::Within { lane } => (b, lane),
            };
            let (block, composite) = (&model.blocks[b], &self.composites[b]);
            s = block.segment[last];
            let segment = &model.segments[s];
            // from the origin of the segment below to that of this segment
            forces.move_by(Vec3::splat(d + composite.position.lane(last)));
            let depth = block.depth[segment.first];
            if segment.plain {
                let roomy = segment.roomy && last + 1 == LANES;
                for k in forces.lanes.clone() {
                    put(values, forces.starts[k] + depth, forces.project(k, &composite.subspace), segment.first..last + 1, roomy);
                }
            } else {
                let kind = model.topology.joints()[block.first + last].kind;
                let r = self.orientations.frames[b].rotation.lane(last);
                for k in forces.lanes.clone() {
                    let force = forces.force.lane(k);
                    let local = Force::new(r.transpose_mul(force.ang), r.transpose_mul(force.lin));
                    put_wide(kind, local, kind.nv(), &mut values[forces.starts[k] + depth..]);
                }
            }
        }
    }
}

/// The forces F of several rows, a row per lane, at one origin, and where these rows begin.
struct Rows {
    lanes: Range<usize>,
    starts: [usize; LANES],
    force: Force<Pack>,
}

impl Rows {
    /// Moves the forces to an origin from which theirs are displaced by `d`.
    #[inline(always)]
    fn move_by(&mut self, d: Vec3<Pack>) {
        self.force.ang = d.cross_add(self.force.lin, self.force.ang);
    }

    /// `S_jᵀ F` of row k for the joints j of a block.
    #[inline(always)]
    fn project(&self, k: usize, subspace: &Motion<Pack>) -> Pack {
        subspace.dot(Force::splat(self.force.lane(k)))
    }
}

/// Writes the first numbers of `Sᵀ F` for a wide joint, from a force in its body's axes at its origin.
#[inline(always)]
fn put_wide(kind: JointKind, force: Force<f64>, count: usize, entries: &mut [f64]) {
    let mut along = [0.0; 6];
    kind.project(&Motion::<f64>::zero(), force, &mut along);
    for (entry, along) in entries.iter_mut().zip(&along[..count.min(kind.nv())]) {
        *entry = *along;
    }
}

/// Writes some lanes of a register; `place` is where the first of them goes.
///
/// With `roomy` the whole register is written where it fits. What is overwritten is written later: entries of ancestors above, and rows below.
#[inline(always)]
fn put(values: &mut [f64], place: usize, along: Pack, lanes: Range<usize>, roomy: bool) {
    let along = along.to_array();
    if roomy && let Some(whole) = values.get_mut(place - lanes.start..place - lanes.start + LANES) {
        whole.copy_from_slice(&along);
    } else {
        for (value, along) in values[place..].iter_mut().zip(&along[lanes]) {
            *value = *along;
        }
    }
}
