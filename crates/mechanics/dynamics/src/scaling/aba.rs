//! The articulated-body algorithm for one state on all cores, sub-tree by sub-tree.
//!
//! Source, frames, shapes and units: those of `aba.rs`, whose recursions it calls. The tree is divided by `scaling/mod.rs`. Each part
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
//! Cost: O(n), the operations of [`Aba`]. Beside what `rayon` itself allocates, a call allocates three lists of slices,
//! with one entry per task each.

use super::{Piece, Plan};
use crate::aba::{Inputs, Link, OnPath};
use crate::error::Pivot;
use crate::{Aba, Error};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{ArticulatedInertia, Force, Lift, Real};
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
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(
        &mut self,
        model: &Model<P>,
        q: &[T],
        v: &[T],
        tau: &[T],
        wrenches: Option<&[Force<T>]>,
        a: &mut [T],
    ) -> Result<(), Error> {
        let inputs = Inputs { model, q, v, tau, wrenches };
        self.aba.expect_shapes(&inputs, a)?;
        self.plan.expect(&model.topology)?;
        let Self { plan, aba: Aba { links, path }, parents, paths } = self;
        let joints = model.topology.joints();
        // Functions, of which trunk and parts share one copy.
        let outward = |first: usize, links: &mut [Link<T>], path: &mut [OnPath<T>]| inputs.outward(first, links, path);
        let inward = |first: usize, links: &mut [Link<T>], path: &mut [OnPath<T>], outside: Option<&mut Force<T>>, smallest: &mut Pivot| {
            inputs.inward(first, links, path, outside, smallest);
        };
        let accelerate = |first: usize, links: &[Link<T>], path: &mut [OnPath<T>], a: &mut [T], smallest: &mut Pivot| {
            inputs.accelerate(first, links, path, a, smallest);
        };

        path[0].a.lin = -model.gravity.lift();
        for piece in &plan.order {
            match *piece {
                Piece::Trunk(i) => outward(i, &mut links[i..=i], path),
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
                let links = &mut links[part.bodies.start - task.bodies.start..part.bodies.end - task.bodies.start];
                let (root, slot) = (part.bodies.start, joints[part.bodies.start].parent_slot);
                path[slot] = parent.on_path;
                outward(root, links, path);
                // The parent's slot is the root's as well if the root is the last child. Then the root reads it last, and begins the sum anew.
                path[slot].inertia = ArticulatedInertia::zero();
                inward(root, links, path, Some(&mut parent.p), &mut smallest);
                parent.on_path.inertia = path[slot].inertia;
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
                    inward(i, &mut rest[..1], path, parent, &mut in_trunk);
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

        let mut last = Pivot::none();
        for piece in &plan.order {
            match *piece {
                Piece::Trunk(i) => accelerate(i, &links[i..=i], path, &mut a[joints[i].v..], &mut last),
                Piece::Part(k) => parents[k].on_path.a = path[joints[plan.parts[k].bodies.start].parent_slot].a,
            }
        }

        let accelerations = plan.divide(a, |task| task.dofs.clone());
        let in_parts = plan.tasks.par_iter().zip(accelerations).zip(paths).map(|((task, a), path)| {
            let mut smallest = Pivot::none();
            for (part, parent) in plan.parts[task.parts.clone()].iter().zip(&parents[task.parts.clone()]) {
                path[joints[part.bodies.start].parent_slot].a = parent.on_path.a;
                let a = &mut a[part.dofs.start - task.dofs.start..];
                accelerate(part.bodies.start, &links[part.bodies.clone()], path, a, &mut smallest);
            }
            smallest
        });
        last = last.root_first(in_parts.reduce(Pivot::none, Pivot::root_first));
        smallest.check()?;
        Ok(last.check()?)
    }
}
