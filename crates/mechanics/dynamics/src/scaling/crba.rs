//! The joint-space inertia matrix of one state on all cores, sub-tree by sub-tree.
//!
//! Source, frames, shapes and units: those of `crba.rs`, whose functions for one joint it calls. The tree is divided by `scaling/mod.rs`. The rows
//! of a task's dofs are consecutive. The task computes those of its parts: it carries their forces together through the trunk to the world.
//! Dofs of the trunk stand between them; their forces are zero, and step 3 writes their rows.
//!
//! | step | where | what |
//! |---|---|---|
//! | 1 | trunk | placements |
//! | 2 | tasks, in parallel | placements and composite inertias Iᶜ of the parts, all rows of the parts |
//! | 3 | trunk | composite inertias, and the rows of the trunk, the forces of its dofs together |
//!
//! Cost: O(n + Σ d_k), the operations of [`crate::Crba`] and those on the zeros of step 2. Beside what `rayon` itself allocates, a call allocates
//! four lists of slices, with one entry per task each.

use super::{Part, Piece, Plan, Task};
use crate::crba::{Forces, Rows, column_force, expect_shapes, project};
use crate::step::by_kind;
use crate::tree_sparse::Row;
use crate::{DimensionError, TreeSparse};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{CentralInertia, Force, Lift, Real, Transform};
use rayon::prelude::*;
use std::ops::Range;

/// The workspace of the composite-rigid-body algorithm for one state on all cores. Its answers are those of [`crate::Crba`] to the bit.
///
/// It uses the threads of the current pool of `rayon`. It pays where the tree branches and has some thousand bodies or more.
///
/// ```
/// use featherbench_dynamics::{ParallelCrba, TreeSparse, mass_matrix};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("binary_tree:depth=10")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 1);
///
/// let mut matrix = TreeSparse::new(&model.topology);
/// ParallelCrba::new(&model.topology).run(&model, states.q(0), &mut matrix)?;
/// assert_eq!(matrix, mass_matrix(&model, states.q(0))?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ParallelCrba<T> {
    plan: Plan,
    /// Per task: its parts and the bodies of the trunk between them, in the plan's order.
    pieces: Vec<Range<usize>>,
    composites: Vec<CentralInertia<T>>,
    placements: Vec<Transform<T>>,
    trunk: Vec<Body<T>>,
    /// The rows of the trunk's dofs.
    trunk_rows: Vec<Row>,
    /// Per part: its composite inertia in its parent.
    carried: Vec<CentralInertia<T>>,
    /// Per task: the forces of its dofs. The last is for the dofs of the trunk.
    forces: Vec<Forces<T>>,
}

/// A body of the trunk, in the plan's order.
#[derive(Clone, Debug)]
struct Body<T> {
    index: usize,
    /// Its placement in its parent, for all tasks to read.
    x: Transform<T>,
    /// Where its parent stands in the trunk.
    parent: Option<usize>,
    /// The dofs of the trunk that it supports, its own first, counted within the trunk.
    dofs: Range<usize>,
}

/// What a task reads.
struct Inputs<'a, P, T> {
    model: &'a Model<P>,
    q: &'a [T],
    trunk: &'a [Body<T>],
    rows: &'a [Row],
}

/// What a task writes: slices that begin with its first body, and its rows in the flat array, which begin at number `start`.
struct Outputs<'a, T> {
    composites: &'a mut [CentralInertia<T>],
    placements: &'a mut [Transform<T>],
    forces: &'a mut Forces<T>,
    values: &'a mut [T],
    start: usize,
}

impl<T: Real> ParallelCrba<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let plan = Plan::new(topology, |depth| depth);
        let trunk = trunk(&plan, topology);
        let trunk_dofs = trunk.iter().map(|body| body.dofs.end).max().unwrap_or(0);
        let place = |part: usize| plan.order.iter().position(|piece| *piece == Piece::Part(part)).unwrap_or(0);
        let pieces = plan.tasks.iter().map(|task| place(task.parts.start)..place(task.parts.end - 1) + 1).collect();
        let forces = plan.tasks.iter().map(|task| Forces::new(task.dofs.len())).chain([Forces::new(trunk_dofs)]).collect();
        Self {
            pieces,
            composites: vec![CentralInertia::zero(); topology.bodies()],
            placements: vec![Transform::identity(); topology.bodies()],
            carried: vec![CentralInertia::zero(); plan.parts.len()],
            trunk,
            trunk_rows: Vec::with_capacity(trunk_dofs),
            forces,
            plan,
        }
    }

    /// The joint-space inertia matrix `matrix` of configuration `q`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], matrix: &mut TreeSparse<T>) -> Result<(), DimensionError> {
        let Self { plan, pieces, composites, placements, trunk, trunk_rows, carried, forces } = self;
        expect_shapes(model, composites.len(), q, matrix)?;
        plan.expect(&model.topology)?;

        for body in trunk.iter_mut() {
            body.x = model.joint_transform(body.index, q);
        }
        let (rows, values) = matrix.parts_mut();
        let inputs = Inputs { model, q, trunk, rows };
        let first_number = |dof: usize| rows[dof].start;
        let last_number = |dof: usize| rows.get(dof).map_or(model.topology.stored(), |row| row.start);

        let composite_slices = plan.divide(composites, |task| task.bodies.clone());
        let placement_slices = plan.divide(placements, |task| task.bodies.clone());
        let value_slices = plan.divide(values, |task| first_number(task.dofs.start)..last_number(task.dofs.end));
        let carried_slices = plan.divide_parts(carried);
        let slices = composite_slices.into_par_iter().zip(placement_slices).zip(value_slices).zip(carried_slices);
        let tasks = plan.tasks.par_iter().zip(&*pieces).zip(slices).zip(&mut *forces);
        tasks.for_each(|(((task, pieces), (((composites, placements), values), carried)), forces)| {
            let outputs = Outputs { composites, placements, forces, values, start: first_number(task.dofs.start) };
            inputs.run(plan, task, &plan.order[pieces.clone()], outputs, carried);
        });

        let Some(forces) = forces.last_mut() else { return Ok(()) };
        let dofs_of = |body: &Body<T>| dofs(&model.topology, body.index);
        trunk_rows.clear();
        trunk_rows.extend(trunk.iter().flat_map(|body| &rows[dofs_of(body)]));
        for body in trunk.iter() {
            composites[body.index] = model.inertias[body.index].lift::<T>().central();
        }
        let mut next = trunk.len();
        for piece in plan.order.iter().rev() {
            match *piece {
                Piece::Trunk(index) => {
                    next -= 1;
                    let body = &trunk[next];
                    let (kind, subspace) = (model.topology.joints()[index].kind, &model.subspaces[index]);
                    for column in 0..kind.nv() {
                        forces.set(body.dofs.start + column, column_force(kind, &composites[index], subspace, column));
                    }
                    let rows = Supported { first: body.dofs.start, rows: &trunk_rows[body.dofs.clone()], own: true };
                    inputs.set_columns(index, forces, rows, values, 0);
                    if let Some(parent) = body.parent {
                        let moved = composites[index].to_parent(&body.x);
                        composites[trunk[parent].index] += moved;
                        forces.carry_to_parent(&body.x, body.dofs.clone());
                    }
                }
                Piece::Part(part) => {
                    if let Some(parent) = plan.parts[part].parent {
                        composites[parent] += carried[part];
                    }
                }
            }
        }
        for dof in trunk.iter().flat_map(dofs_of) {
            values[rows[dof].start + model.topology.dof_depth(dof) - 1] += model.armature[dof].lift();
        }
        Ok(())
    }
}

/// The trunk in the plan's order.
fn trunk<T: Real>(plan: &Plan, topology: &Topology) -> Vec<Body<T>> {
    let indices: Vec<usize> = plan.trunk().collect();
    let mut trunk: Vec<Body<T>> = Vec::with_capacity(indices.len());
    let mut next = 0;
    for &index in &indices {
        let parent = topology.joints()[index].parent.and_then(|parent| indices.binary_search(&parent).ok());
        let first = next;
        next += dofs(topology, index).len();
        trunk.push(Body { index, x: Transform::identity(), parent, dofs: first..next });
    }
    // What a body supports, its parent supports.
    for place in (0..trunk.len()).rev() {
        let end = trunk[place].dofs.end;
        if let Some(parent) = trunk[place].parent {
            let dofs = &mut trunk[parent].dofs;
            if end > dofs.end {
                dofs.end = end;
            }
        }
    }
    trunk
}

/// The dofs of a body's joint.
fn dofs(topology: &Topology, body: usize) -> Range<usize> {
    let joint = &topology.joints()[body];
    joint.v..joint.v + joint.kind.nv()
}

/// Consecutive dofs that a body supports: where their forces begin, and their rows.
struct Supported<'a> {
    first: usize,
    rows: &'a [Row],
    /// Whether the first of them are the body's own.
    own: bool,
}

impl<P: Real + Lift<T>, T: Real> Inputs<'_, P, T> {
    /// The rows of a task's parts, and for each part its composite inertia in its parent.
    fn run(&self, plan: &Plan, task: &Task, pieces: &[Piece], outputs: Outputs<'_, T>, carried: &mut [CentralInertia<T>]) {
        let Outputs { composites, placements, forces, values, start } = outputs;
        let topology = &self.model.topology;
        for piece in pieces.iter().rev() {
            match *piece {
                Piece::Part(k) => {
                    let part = &plan.parts[k];
                    let body = part.bodies.start - task.bodies.start;
                    let (composites, placements) = (&mut composites[body..], &mut placements[body..]);
                    carried[k - task.parts.start] =
                        self.run_part(part, task.dofs.start, Outputs { composites, placements, forces, values, start });
                }
                Piece::Trunk(index) => {
                    let own = dofs(topology, index);
                    for dof in own.clone() {
                        forces.set(dof - task.dofs.start, Force::zero());
                    }
                    let rows = &self.rows[own.start..self.rows[own.start].end.min(task.dofs.end)];
                    self.carry(index, Supported { first: own.start - task.dofs.start, rows, own: true }, forces, values, start);
                }
            }
        }
        // The bodies that support the whole task.
        let mut above = topology.joints()[task.bodies.start].parent;
        while let Some(index) = above {
            let end = self.rows[dofs(topology, index).start].end.min(task.dofs.end);
            self.carry(index, Supported { first: 0, rows: &self.rows[task.dofs.start..end], own: false }, forces, values, start);
            above = topology.joints()[index].parent;
        }
        for dof in plan.parts[task.parts.clone()].iter().flat_map(|part| part.dofs.clone()) {
            values[self.rows[dof].start - start + topology.dof_depth(dof) - 1] += self.model.armature[dof].lift();
        }
    }

    /// The entries of a task's dofs in the columns of a body of the trunk. Then their forces go to its parent.
    fn carry(&self, index: usize, supported: Supported<'_>, forces: &mut Forces<T>, values: &mut [T], start: usize) {
        let dofs = supported.first..supported.first + supported.rows.len();
        self.set_columns(index, forces, supported, values, start);
        let place = self.trunk.binary_search_by_key(&index, |body| body.index);
        if let Some(body) = place.ok().map(|place| &self.trunk[place]).filter(|body| body.parent.is_some()) {
            forces.carry_to_parent(&body.x, dofs);
        }
    }

    /// The rows of a part up to its root; returns its composite inertia in its parent. `first` is the task's first dof.
    fn run_part(&self, part: &Part, first: usize, outputs: Outputs<'_, T>) -> CentralInertia<T> {
        let Outputs { composites, placements, forces, values, start } = outputs;
        let (model, topology) = (self.model, &self.model.topology);
        let root = part.bodies.start;
        let joints = &topology.joints()[part.bodies.clone()];
        for (k, (composite, x)) in composites.iter_mut().zip(placements.iter_mut()).enumerate().take(joints.len()) {
            *composite = model.inertias[root + k].lift::<T>().central();
            *x = model.joint_transform(root + k, self.q);
        }
        let mut carried = CentralInertia::zero();
        for (k, joint) in joints.iter().enumerate().rev() {
            let (kind, x) = (joint.kind, &placements[k]);
            let end = self.rows[joint.v].end;
            for column in 0..kind.nv() {
                forces.set(joint.v + column - first, column_force(kind, &composites[k], &model.subspaces[root + k], column));
            }
            let rows = Supported { first: joint.v - first, rows: &self.rows[joint.v..end], own: true };
            self.set_columns(root + k, forces, rows, values, start);
            let Some(parent) = joint.parent else { continue };
            let moved = composites[k].to_parent(x);
            match parent.checked_sub(root) {
                Some(parent) => composites[parent] += moved,
                None => carried = moved,
            }
            forces.carry_to_parent(x, joint.v - first..end - first);
        }
        carried
    }

    /// `M_kj = S_jᵀ F_k` for each dof j of a body and the dofs k that it supports.
    fn set_columns(&self, body: usize, forces: &Forces<T>, supported: Supported<'_>, values: &mut [T], start: usize) {
        let (joint, subspace) = (&self.model.topology.joints()[body], &self.model.subspaces[body]);
        for column in 0..joint.kind.nv() {
            let skipped = if supported.own { column } else { 0 };
            let (first, rows) = (supported.first + skipped, &supported.rows[skipped..]);
            let position = self.model.topology.dof_depth(joint.v + column) - 1;
            let into = Rows { rows, values: &mut *values, start };
            by_kind!(T, joint.kind, project, forces, first, subspace, column, position, into);
        }
    }
}
