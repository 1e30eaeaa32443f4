//! The joint-space inertia matrix of one state on all cores, sub-tree by sub-tree.
//!
//! Source, frames, shapes and units: those of `crba.rs`, whose functions for one joint it calls. The tree is divided by `parallel.rs`. The rows
//! of a part's dofs are consecutive. Each part computes all of them: it carries its forces on through the trunk to the world.
//!
//! | step | where | what |
//! |---|---|---|
//! | 1 | trunk | placements |
//! | 2 | parts, in parallel | placements, composite inertias Iᶜ, all rows of the part |
//! | 3 | trunk | composite inertias, and the rows of the trunk by the book's algorithm, one force at a time |
//!
//! Cost: O(n + Σ d_k), the operations of [`crate::Crba`]. Beside what `rayon` itself allocates, a call allocates five lists of slices,
//! with one entry per task each.

use super::{Forces, column_force, project};
use crate::parallel::{Part, Piece, Plan, Task};
use crate::step::by_kind;
use crate::tree_sparse::Row;
use crate::{DimensionError, TreeSparse};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{CentralInertia, Lift, Real, Transform};
use rayon::prelude::*;

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
    composites: Vec<CentralInertia<T>>,
    placements: Vec<Transform<T>>,
    /// Per body of the trunk, in the plan's order: its index and its placement, for all parts to read.
    trunk: Vec<(usize, Transform<T>)>,
    /// Per part: where its parent stands in `trunk`.
    parents: Vec<Option<usize>>,
    /// Per body of the trunk: where its parent stands in `trunk`.
    trunk_parents: Vec<Option<usize>>,
    /// Per part: its composite inertia in its parent.
    carried: Vec<CentralInertia<T>>,
    /// Per task: the forces of one part. The last is for the trunk.
    forces: Vec<Forces<T>>,
}

/// What a part reads.
struct Inputs<'a, P, T> {
    model: &'a Model<P>,
    q: &'a [T],
    trunk: &'a [(usize, Transform<T>)],
    trunk_parents: &'a [Option<usize>],
    rows: &'a [Row],
}

/// What a part writes: slices that begin with its root, and its rows in the flat array, which begin at `start`.
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
        let trunk: Vec<_> = plan.trunk().map(|body| (body, Transform::identity())).collect();
        let place = |parent: Option<usize>| parent.and_then(|parent| trunk.binary_search_by_key(&parent, |(body, _)| *body).ok());
        let parents = plan.parts.iter().map(|part| place(part.parent)).collect();
        let trunk_parents = trunk.iter().map(|(body, _)| place(topology.joints()[*body].parent)).collect();
        let largest = |task: &Task| plan.parts[task.parts.clone()].iter().map(|part| part.dofs.len()).max();
        let forces = plan.tasks.iter().map(|task| Forces::new(largest(task).unwrap_or(0))).chain([Forces::new(6)]).collect();
        Self {
            composites: vec![CentralInertia::zero(); topology.bodies()],
            placements: vec![Transform::identity(); topology.bodies()],
            carried: vec![CentralInertia::zero(); plan.parts.len()],
            trunk,
            parents,
            trunk_parents,
            forces,
            plan,
        }
    }

    /// The joint-space inertia matrix `matrix` of configuration `q`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], matrix: &mut TreeSparse<T>) -> Result<(), DimensionError> {
        let Self { plan, composites, placements, trunk, parents, trunk_parents, carried, forces } = self;
        super::expect_shapes(model, composites.len(), q, matrix)?;
        plan.expect(&model.topology)?;

        for (body, x) in trunk.iter_mut() {
            *x = model.joint_transform(*body, q);
        }
        let (rows, values) = matrix.parts_mut();
        let inputs = Inputs { model, q, trunk, trunk_parents, rows };
        let first_number = |dof: usize| rows[dof].start;
        let last_number = |dof: usize| rows.get(dof).map_or(model.topology.stored(), |row| row.start);

        let composite_slices = plan.divide(composites, |task| task.bodies.clone());
        let placement_slices = plan.divide(placements, |task| task.bodies.clone());
        let value_slices = plan.divide(values, |task| first_number(task.dofs.start)..last_number(task.dofs.end));
        let carried_slices = plan.divide_parts(carried);
        let slices = composite_slices.into_par_iter().zip(placement_slices).zip(value_slices).zip(carried_slices);
        plan.tasks.par_iter().zip(slices).zip(&mut *forces).for_each(|((task, (((composites, placements), values), carried)), forces)| {
            for (k, carried) in task.parts.clone().zip(carried) {
                let part = &plan.parts[k];
                let body = part.bodies.start - task.bodies.start;
                let (composites, placements) = (&mut composites[body..], &mut placements[body..]);
                let start = first_number(task.dofs.start);
                let outputs = Outputs { composites, placements, forces, values, start };
                *carried = inputs.run(part, parents[k], outputs);
            }
        });

        for (body, _) in trunk.iter() {
            composites[*body] = model.inertias[*body].lift::<T>().central();
        }
        let Some(forces) = forces.last_mut() else { return Ok(()) };
        let mut next = trunk.len();
        for piece in plan.order.iter().rev() {
            match *piece {
                Piece::Trunk(body) => {
                    next -= 1;
                    inputs.set_rows_of_trunk(next, &composites[body], forces, values);
                    if let Some(parent) = trunk_parents[next] {
                        let moved = composites[body].to_parent(&trunk[next].1);
                        composites[trunk[parent].0] += moved;
                    }
                }
                Piece::Part(part) => {
                    if let Some(parent) = plan.parts[part].parent {
                        composites[parent] += carried[part];
                    }
                }
            }
        }
        Ok(())
    }
}

impl<P: Real + Lift<T>, T: Real> Inputs<'_, P, T> {
    /// The rows of a part whose parent stands at `parent` in the trunk; returns its composite inertia in its parent.
    fn run(&self, part: &Part, parent: Option<usize>, outputs: Outputs<'_, T>) -> CentralInertia<T> {
        let Outputs { composites, placements, forces, values, start } = outputs;
        let (model, topology) = (self.model, &self.model.topology);
        let (root, first) = (part.bodies.start, part.dofs.start);
        let joints = &topology.joints()[part.bodies.clone()];
        for (k, (composite, x)) in composites.iter_mut().zip(placements.iter_mut()).enumerate().take(joints.len()) {
            *composite = model.inertias[root + k].lift::<T>().central();
            *x = model.joint_transform(root + k, self.q);
        }
        let mut carried = CentralInertia::zero();
        for (k, joint) in joints.iter().enumerate().rev() {
            let (kind, subspace, x) = (joint.kind, &model.subspaces[root + k], &placements[k]);
            let end = self.rows[joint.v].end;
            for column in 0..kind.nv() {
                forces.set(joint.v + column - first, column_force(kind, &composites[k], subspace, column));
            }
            for column in 0..kind.nv() {
                let dofs = joint.v + column..end;
                let position = topology.dof_depth(dofs.start) - 1;
                by_kind!(kind, project, forces, dofs.start - first, subspace, column, &self.rows[dofs], position, values, start);
            }
            let moved = composites[k].to_parent(x);
            match joint.parent.filter(|parent| *parent >= root) {
                Some(parent) => composites[parent - root] += moved,
                None => carried = moved,
            }
            forces.carry_to_parent(x, joint.v - first..end - first);
        }
        self.walk(parent, forces, part.dofs.clone(), values, start);
        for dof in part.dofs.clone() {
            values[self.rows[dof].start - start + topology.dof_depth(dof) - 1] += model.armature[dof].lift();
        }
        carried
    }

    /// The rows of the body that stands at `place` in the trunk.
    fn set_rows_of_trunk(&self, place: usize, composite: &CentralInertia<T>, forces: &mut Forces<T>, values: &mut [T]) {
        let (body, x) = &self.trunk[place];
        let (joint, subspace) = (&self.model.topology.joints()[*body], &self.model.subspaces[*body]);
        let (kind, dofs) = (joint.kind, joint.v..joint.v + joint.kind.nv());
        for column in 0..kind.nv() {
            forces.set(column, column_force(kind, composite, subspace, column));
        }
        for column in 0..kind.nv() {
            let rows = &self.rows[dofs.start + column..dofs.end];
            let position = self.model.topology.dof_depth(dofs.start + column) - 1;
            by_kind!(kind, project, forces, column, subspace, column, rows, position, values, 0);
        }
        forces.carry_to_parent(x, 0..kind.nv());
        self.walk(self.trunk_parents[place], forces, dofs.clone(), values, 0);
        for dof in dofs {
            values[self.rows[dof].start + self.model.topology.dof_depth(dof) - 1] += self.model.armature[dof].lift();
        }
    }

    /// Carries the forces of these dofs from the body at `place` in the trunk to the world, and writes their entries on the way.
    fn walk(&self, mut place: Option<usize>, forces: &mut Forces<T>, dofs: std::ops::Range<usize>, values: &mut [T], start: usize) {
        while let Some(at) = place {
            let (body, x) = &self.trunk[at];
            let (joint, subspace) = (&self.model.topology.joints()[*body], &self.model.subspaces[*body]);
            for column in 0..joint.kind.nv() {
                let position = self.model.topology.dof_depth(joint.v + column) - 1;
                by_kind!(joint.kind, project, forces, 0, subspace, column, &self.rows[dofs.clone()], position, values, start);
            }
            place = self.trunk_parents[at];
            if place.is_some() {
                forces.carry_to_parent(x, 0..dofs.len());
            }
        }
    }
}
