//! Inverse dynamics of one state on all cores, sub-tree by sub-tree.
//!
//! Source, frames, shapes and units: those of `rnea.rs`, whose functions for one body it calls. The tree is divided by `scaling/mod.rs`. Each part
//! has a stand-in for its parent: it brings ω and a of the parent into the part, and collects the force that the part passes on.
//! Each task has path slots of its own.
//!
//! | step | where | what |
//! |---|---|---|
//! | 1 | trunk | outward |
//! | 2 | parts, in parallel | outward, then inward |
//! | 3 | trunk | inward |
//!
//! Cost: O(n), the operations of [`Rnea`]. Beside what `rayon` itself allocates, a call allocates three lists of slices,
//! with one entry per task each.

use super::{Part, Piece, Plan};
use crate::error::expect;
use crate::rnea::{Inputs, Link, Moving};
use crate::step::expect_workspace;
use crate::{DimensionError, Rnea};
use featherbench_model::{Joint, Model, Topology};
use featherbench_spatial::{Force, Lift, Motion, Real, Vec3};
use rayon::prelude::*;

/// The workspace of inverse dynamics of one state on all cores. Its answers are those of [`Rnea`] to the bit.
///
/// It uses the threads of the current pool of `rayon`. It pays where the tree branches and has some thousand bodies or more.
///
/// ```
/// use featherbench_dynamics::{ParallelRnea, inverse_dynamics};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("binary_tree:depth=10")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 1);
/// let (q, v, a) = (states.q(0), states.v(0), states.a(0));
///
/// let mut tau = vec![0.0; model.topology.nv()];
/// ParallelRnea::new(&model.topology).run(&model, q, v, a, None, &mut tau)?;
/// assert_eq!(tau, inverse_dynamics(&model, q, v, a)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ParallelRnea<T> {
    plan: Plan,
    rnea: Rnea<T>,
    /// Per part: what stands in for its parent, and the force on it.
    parents: Vec<(Moving<T>, Force<T>)>,
    /// Per task: path slots.
    paths: Vec<Vec<Moving<T>>>,
}

impl<T: Real> ParallelRnea<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let plan = Plan::new(topology, |_| 1);
        let parents = vec![(Moving::at_rest(), Force::zero()); plan.parts.len()];
        let paths = plan.tasks.iter().map(|task| vec![Moving::at_rest(); task.slots]).collect();
        Self { plan, rnea: Rnea::new(topology), parents, paths }
    }

    /// The joint forces `tau` of configuration `q`, velocity `v`, acceleration `a` and external wrenches.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        a: &[T],
        wrenches: Option<&[Force<T>]>,
        tau: &mut [T],
    ) -> Result<(), DimensionError> {
        expect("acceleration a", model.topology.nv(), a.len())?;
        expect_workspace(model, self.rnea.links.len(), self.rnea.path.len())?;
        let inputs = Inputs { model, q, v, a, wrenches };
        inputs.expect_shapes(tau)?;
        self.plan.expect(&model.topology)?;
        let Self { plan, rnea: Rnea { links, path }, parents, paths } = self;
        let joints = model.topology.joints();

        path[0] = Moving { omega: Vec3::zero(), a: Motion::new(Vec3::zero(), -model.gravity.lift()) };
        for piece in &plan.order {
            match *piece {
                Piece::Trunk(i) => inputs.move_body(i, path, &mut links[i]),
                Piece::Part(k) => parents[k] = (path[joints[plan.parts[k].bodies.start].parent_slot], Force::zero()),
            }
        }

        let slices = plan.divide(links, |task| task.bodies.clone());
        let forces = plan.divide(tau, |task| task.dofs.clone());
        let stand_ins = plan.divide_parts(parents);
        let tasks = plan.tasks.par_iter().zip(slices).zip(forces).zip(stand_ins).zip(paths);
        tasks.for_each(|((((task, links), tau), parents), path)| {
            for (part, parent) in plan.parts[task.parts.clone()].iter().zip(parents).rev() {
                let links = &mut links[part.bodies.start - task.bodies.start..];
                inputs.through(part, links, parent, path, &mut tau[part.dofs.start - task.dofs.start..]);
            }
        });

        for piece in plan.order.iter().rev() {
            match *piece {
                Piece::Trunk(i) => {
                    let (before, rest) = links.split_at_mut(i);
                    let parent = joints[i].parent.map(|parent| &mut before[parent].f);
                    inputs.inward(i, &joints[i], &rest[0], parent, &mut tau[joints[i].v..]);
                }
                Piece::Part(k) => {
                    if let Some(parent) = plan.parts[k].parent {
                        links[parent].f += parents[k].1;
                    }
                }
            }
        }
        Ok(())
    }
}

impl<P: Real + Lift<T>, T: Real> Inputs<'_, P, T> {
    /// The outward step of one body, of which trunk and parts share one copy.
    fn move_body(&self, i: usize, path: &mut [Moving<T>], link: &mut Link<T>) {
        self.outward::<true>(i, path, link);
    }

    /// The inward step of one body: `τ_i = Sᵀ f_i + armature q̈_i`, `f_p += X* f_i`. `tau` begins with the joint's dofs.
    fn inward(&self, i: usize, joint: &Joint, link: &Link<T>, parent: Option<&mut Force<T>>, tau: &mut [T]) {
        joint.kind.project(&self.model.subspaces[i], link.f, tau);
        let dofs = joint.v..joint.v + joint.kind.nv();
        for ((tau, a), armature) in tau.iter_mut().zip(&self.a[dofs.clone()]).zip(&self.model.armature[dofs]) {
            *tau = a.mul_add(armature.lift(), *tau);
        }
        if let Some(parent) = parent {
            *parent += joint.kind.recall(&self.model.placements[i], &link.x).force(link.f);
        }
    }

    /// Both steps for the bodies of a part. `links` begins with its root, `tau` with the root's first dof.
    fn through(&self, part: &Part, links: &mut [Link<T>], parent: &mut (Moving<T>, Force<T>), path: &mut [Moving<T>], tau: &mut [T]) {
        let (root, dof) = (part.bodies.start, part.dofs.start);
        let joints = &self.model.topology.joints()[part.bodies.clone()];
        path[joints[0].parent_slot] = parent.0;
        for (k, link) in links[..joints.len()].iter_mut().enumerate() {
            self.move_body(root + k, path, link);
        }
        for (k, joint) in joints.iter().enumerate().rev() {
            let (before, rest) = links.split_at_mut(k);
            let force = match joint.parent.and_then(|parent| parent.checked_sub(root)) {
                Some(parent) => Some(&mut before[parent].f),
                None => part.parent.map(|_| &mut parent.1),
            };
            self.inward(root + k, joint, &rest[0], force, &mut tau[joint.v - dof..]);
        }
    }
}
