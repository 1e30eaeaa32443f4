//! The articulated-body algorithm for one state on all cores, sub-tree by sub-tree.
//!
//! Source, frames, shapes and units: those of `aba.rs`, whose functions for one body it calls. The tree is divided by `parallel.rs`. Each part
//! has a stand-in for its parent: it brings ω and a of the parent into the part, and collects the Iᵃ and pᵃ that the part adds to the parent.
//! Each task has path slots of its own.
//!
//! | step | where | what |
//! |---|---|---|
//! | 1 | trunk | pass 1, outward |
//! | 2 | parts, in parallel | pass 1, outward, then pass 2, inward |
//! | 3 | trunk | pass 2, inward; then pass 3, outward |
//! | 4 | parts, in parallel | pass 3, outward |
//!
//! Cost: O(n), the operations of [`Aba`]. Without `rayon`'s own, a call allocates three lists of slices, each with as many entries as there are
//! tasks.

use super::{Link, OnPath, accelerate, pass_to_parent, set_moving};
use crate::error::Pivot;
use crate::parallel::{Part, Piece, Plan};
use crate::step::by_kind;
use crate::{Aba, Error};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{ArticulatedInertia, Force, Lift, Motion, Real, Vec3};
use rayon::prelude::*;

/// The workspace of the articulated-body algorithm for one state on all cores. Its answers are those of [`Aba`] to the bit.
///
/// It uses the threads of the current pool of `rayon`. It pays where the tree branches and has some thousand bodies or more.
///
/// ```
/// use featherbench_dynamics::{ParallelAba, forward_dynamics};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("binary_tree:depth=10")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 1);
/// let (q, v, tau) = (states.q(0), states.v(0), states.tau(0));
///
/// let mut a = vec![0.0; model.topology.nv()];
/// ParallelAba::new(&model.topology).run(&model, q, v, tau, None, &mut a)?;
/// assert_eq!(a, forward_dynamics(&model, q, v, tau)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ParallelAba<T> {
    plan: Plan,
    aba: Aba<T>,
    /// Per part: what stands in for its parent.
    parents: Vec<Parent<T>>,
    /// Per task: path slots.
    paths: Vec<Vec<OnPath<T>>>,
}

/// A stand-in for the parent of a part.
#[derive(Clone, Copy, Debug)]
struct Parent<T> {
    on_path: OnPath<T>,
    p: Force<T>,
}

/// What a step reads.
struct Inputs<'a, P, T> {
    model: &'a Model<P>,
    q: &'a [T],
    v: &'a [T],
    tau: &'a [T],
    wrenches: Option<&'a [Force<T>]>,
}

impl<T: Real> ParallelAba<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let plan = Plan::new(topology, |_| 1);
        let parents = vec![Parent { on_path: OnPath::at_rest(), p: Force::zero() }; plan.parts.len()];
        let paths = plan.tasks.iter().map(|task| vec![OnPath::at_rest(); task.slots]).collect();
        Self { plan, aba: Aba::new(topology), parents, paths }
    }

    /// The accelerations `a` at configuration `q`, velocity `v`, joint forces `tau` and external wrenches.
    ///
    /// # Errors
    /// [`Error`] when an argument or the workspace does not fit the model, or when a joint meets no inertia; `a` then means nothing.
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        tau: &[T],
        wrenches: Option<&[Force<T>]>,
        a: &mut [T],
    ) -> Result<(), Error> {
        self.aba.expect_shapes(model, q, v, tau, wrenches, a)?;
        self.plan.expect(&model.topology)?;
        let Self { plan, aba: Aba { links, path }, parents, paths } = self;
        let joints = model.topology.joints();
        let inputs = Inputs { model, q, v, tau, wrenches };

        path[0] = OnPath { a: Motion::new(Vec3::zero(), -model.gravity.lift()), ..OnPath::at_rest() };
        for piece in &plan.order {
            match *piece {
                Piece::Trunk(i) => inputs.set_moving(i, path, &mut links[i]),
                Piece::Part(k) => {
                    let omega = path[joints[plan.parts[k].bodies.start].parent_slot].omega;
                    parents[k] = Parent { on_path: OnPath { omega, ..OnPath::at_rest() }, p: Force::zero() };
                }
            }
        }

        let slices = plan.divide(links, |task| task.bodies.clone());
        let stand_ins = plan.divide_parts(parents);
        let tasks = plan.tasks.par_iter().zip(slices).zip(stand_ins).zip(&mut *paths);
        let in_parts = tasks.map(|(((task, links), parents), path)| {
            let mut smallest = Pivot::none();
            for (part, parent) in plan.parts[task.parts.clone()].iter().zip(parents).rev() {
                inputs.inward(part, &mut links[part.bodies.start - task.bodies.start..], parent, path, &mut smallest);
            }
            smallest
        });
        let mut smallest = in_parts.reduce(Pivot::none, Pivot::leaves_first);

        let mut in_trunk = Pivot::none();
        for piece in plan.order.iter().rev() {
            match *piece {
                Piece::Trunk(i) => {
                    let (before, rest) = links.split_at_mut(i);
                    let parent = joints[i].parent.map(|parent| &mut before[parent].p);
                    by_kind!(joints[i].kind, pass_to_parent, model, i, tau, &mut rest[0], parent, path, &mut in_trunk);
                }
                Piece::Part(k) => {
                    let root = &joints[plan.parts[k].bodies.start];
                    if let Some(parent) = root.parent {
                        // The last child begins the sum.
                        let (sum, added) = (&mut path[root.parent_slot].inertia, parents[k].on_path.inertia);
                        *sum = if root.slot == root.parent_slot { added } else { *sum + added };
                        links[parent].p += parents[k].p;
                    }
                }
            }
        }
        smallest = smallest.leaves_first(in_trunk);

        let mut outward = Pivot::none();
        for piece in &plan.order {
            match *piece {
                Piece::Trunk(i) => {
                    let a = &mut a[joints[i].v..];
                    by_kind!(joints[i].kind, accelerate, model, i, tau, a, &links[i], path, &mut outward);
                }
                Piece::Part(k) => parents[k].on_path.a = path[joints[plan.parts[k].bodies.start].parent_slot].a,
            }
        }

        let accelerations = plan.divide(a, |task| task.dofs.clone());
        let in_parts = plan.tasks.par_iter().zip(accelerations).zip(paths).map(|((task, a), path)| {
            let mut smallest = Pivot::none();
            for k in task.parts.clone() {
                let part = &plan.parts[k];
                path[joints[part.bodies.start].parent_slot].a = parents[k].on_path.a;
                for i in part.bodies.clone() {
                    let a = &mut a[joints[i].v - task.dofs.start..];
                    by_kind!(joints[i].kind, accelerate, model, i, tau, a, &links[i], path, &mut smallest);
                }
            }
            smallest
        });
        outward = outward.root_first(in_parts.reduce(Pivot::none, Pivot::root_first));
        smallest.check()?;
        Ok(outward.check()?)
    }
}

impl<P: Real + Lift<T>, T: Real> Inputs<'_, P, T> {
    /// Pass 1 for one body.
    fn set_moving(&self, i: usize, path: &mut [OnPath<T>], link: &mut Link<T>) {
        let Self { model, q, v, .. } = *self;
        by_kind!(model.topology.joints()[i].kind, set_moving, model, i, q, v, path, link);
        if let Some(wrenches) = self.wrenches {
            link.p -= model.labels[i].force_to_compiled(wrenches[i]);
        }
    }

    /// Passes 1 and 2 for the bodies of a part. `links` begins with its root.
    fn inward(&self, part: &Part, links: &mut [Link<T>], parent: &mut Parent<T>, path: &mut [OnPath<T>], smallest: &mut Pivot) {
        let (model, root) = (self.model, part.bodies.start);
        let joints = &model.topology.joints()[part.bodies.clone()];
        let slot = joints[0].parent_slot;
        path[slot] = parent.on_path;
        for (k, link) in links[..joints.len()].iter_mut().enumerate() {
            self.set_moving(root + k, path, link);
        }
        // The parent's slot is the root's as well if the root is the last child. Then the root reads it last, and begins the sum anew.
        path[slot].inertia = ArticulatedInertia::zero();
        for (k, joint) in joints.iter().enumerate().rev() {
            let (before, rest) = links.split_at_mut(k);
            let parent_p = match joint.parent.and_then(|parent| parent.checked_sub(root)) {
                Some(parent) => Some(&mut before[parent].p),
                None => part.parent.map(|_| &mut parent.p),
            };
            by_kind!(joint.kind, pass_to_parent, model, root + k, self.tau, &mut rest[0], parent_p, path, smallest);
        }
        parent.on_path.inertia = path[slot].inertia;
    }
}
