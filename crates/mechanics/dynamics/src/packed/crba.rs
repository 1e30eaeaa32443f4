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
use super::rotate::store_lanes;
use crate::error::expect;
use crate::{DimensionError, TreeSparse};
use featherbench_model::JointKind;
use featherbench_spatial::{CentralInertia, Force, Mat3, Motion, Real, RigidBodyInertia, Sym3, Vec3};
use std::ops::Range;

/// The workspace of the composite-rigid-body algorithm over packed joints.
///
/// # Cost
///
/// Steps 1 to 3 take 55 operations per joint where all lanes are full (joints in eights), whatever the depth. Step 4 takes 6 operations per row
/// and register of ancestors, and 6 per register of rows and segment above it. There is no division. Times, and what was tried:
/// `docs/kernels/crba.md`.
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

    /// Step 1 for a block; the blocks after it are done. Each step is a function of its own: `docs/kernels/crba.md`.
    #[inline(never)]
    fn find_centers(&mut self, model: &PackedModel, b: usize) {
        let (block, frame, composite) = (&model.blocks[b], &self.orientations.frames[b], &mut self.composites[b]);
        let own = frame.rotation * block.inertia.first_moment;
        let moved = frame.displacement * block.supported;
        let (first_moment, carried) = sum_from_leaves(model, block, own, moved, &mut self.first_moments);
        composite.com = first_moment * block.inverse_supported;
        (composite.carried.mass, composite.carried.com) = (block.carried, carried * block.inverse_carried);
    }

    /// Steps 2 and 3 for a block; the blocks after it are done.
    #[inline(never)]
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
    #[inline(never)]
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
                put(values, starts[k] + block.depth[segment.first], along, segment.first..k + 1);
                values[starts[k] + block.depth[k]] = composite.diagonal.lane(k);
            }
            self.climb(model, b, s, forces, values);
        } else {
            let lane = segment.first;
            let (r, kind) = (self.orientations.frames[b].rotation.lane(lane), model.topology.joints()[block.first + lane].kind);
            // in body axes: the body's own inertia as it is, and what it supports
            let carried = composite.carried.lane(lane);
            let com = r.transpose_mul(carried.com);
            let about_com = carried.rotational.rotate(r.transpose());
            let inertia = block.inertia.lane(lane) + RigidBodyInertia::from_com(carried.mass, com, about_com);
            let forces = wide_forces(kind, &inertia);
            for (column, force) in forces.iter().enumerate().take(kind.nv()) {
                let entries = &mut values[rows[block.v[lane] + column].start + block.depth[lane]..];
                put_wide(kind, force, &mut entries[..column + 1]);
                entries[column] += model.armature[block.v[lane] + column];
            }
            if segment.parent == Source::Root {
                return;
            }
            // three columns at a time
            for first in (0..kind.nv()).step_by(3) {
                let mut climbing = Rows { lanes: 0..3, starts: [0; LANES], force: Force::zero() };
                for column in 0..3 {
                    let local = forces[first + column];
                    climbing.force.set_lane(column, Force::new(r * local.ang, r * local.lin));
                    climbing.starts[column] = rows[block.v[lane] + first + column].start;
                }
                self.climb(model, b, s, climbing, values);
            }
        }
    }

    /// The entries of rows in the columns of all segments above segment s of block b.
    #[inline(never)]
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
                for k in forces.lanes.clone() {
                    put(values, forces.starts[k] + depth, forces.project(k, &composite.subspace), segment.first..last + 1);
                }
            } else {
                let kind = model.topology.joints()[block.first + last].kind;
                let r = Mat3::splat(self.orientations.frames[b].rotation.lane(last).transpose());
                let local = Force::new(r * forces.force.ang, r * forces.force.lin);
                for k in forces.lanes.clone() {
                    put_wide(kind, &local.lane(k), &mut values[forces.starts[k] + depth..][..kind.nv()]);
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

/// `I S` of a wide joint, a force per dof, from an inertia in its body's axes at its origin.
#[inline(always)]
fn wide_forces(kind: JointKind, inertia: &RigidBodyInertia<f64>) -> [Force<f64>; 6] {
    let RigidBodyInertia { mass, first_moment: h, rotational: i } = *inertia;
    // h × of each axis
    let crosses = [Vec3::new(0.0, h.z, -h.y), Vec3::new(-h.z, 0.0, h.x), Vec3::new(h.y, -h.x, 0.0)];
    let turning = [Vec3::new(i.xx, i.xy, i.xz), Vec3::new(i.xy, i.yy, i.yz), Vec3::new(i.xz, i.yz, i.zz)];
    let moving = [Vec3::new(mass, 0.0, 0.0), Vec3::new(0.0, mass, 0.0), Vec3::new(0.0, 0.0, mass)];
    let angular = |k: usize| Force::new(turning[k], -crosses[k]);
    let linear = |k: usize| Force::new(crosses[k], moving[k]);
    match kind {
        JointKind::Free => [linear(0), linear(1), linear(2), angular(0), angular(1), angular(2)],
        _ => [angular(0), angular(1), angular(2), Force::zero(), Force::zero(), Force::zero()],
    }
}

/// Writes the first numbers of `Sᵀ F` for a wide joint, from a force in its body's axes at its origin.
#[inline(always)]
fn put_wide(kind: JointKind, force: &Force<f64>, entries: &mut [f64]) {
    let (ang, lin) = (force.ang, force.lin);
    let along = if kind == JointKind::Free { [lin.x, lin.y, lin.z, ang.x, ang.y, ang.z] } else { [ang.x, ang.y, ang.z, 0.0, 0.0, 0.0] };
    for (entry, along) in entries.iter_mut().zip(along) {
        *entry = along;
    }
}

/// Writes some lanes of a register; `place` is where the first of them goes.
#[inline(always)]
fn put(values: &mut [f64], place: usize, along: Pack, lanes: Range<usize>) {
    store_lanes(&mut values[place..place + lanes.len()], along, lanes.start);
}
