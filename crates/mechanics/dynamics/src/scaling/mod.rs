//! One robot on all cores: how a tree is divided into sub-trees.
//!
//! Computes: the *trunk* of a tree, its *parts* and its *tasks*. A part is a sub-tree. The trunk is what is in no part. A task is a range of
//! consecutive bodies with several parts, and so much work that it is worth a turn of a core.
//! Depth-first order makes each sub-tree a range of bodies, of dofs and of rows of a matrix. So arrays are divided between tasks as slices.
//! A body belongs to the trunk if the weight of its sub-tree is more than a 64th of the whole and the sub-tree branches. So does the only child
//! of a body of the trunk. So a part begins where the tree branches, or at the world. Units: none. Cost: O(n), once per topology.
//!
//! A task has path slots of its own: on most trees some dozen. They are as many as bodies where each body's first child carries the rest of the
//! tree, and other children follow.
//!
//! The algorithms with such a plan are [`ParallelRnea`](crate::ParallelRnea), [`ParallelAba`](crate::ParallelAba),
//! [`ParallelCrba`](crate::ParallelCrba) and [`ParallelLtdl`](crate::ParallelLtdl). They do the same operations in the same order as the
//! serial ones: sums over children begin with the last child. So answers are the same to the bit, with any number of threads.
//! The trunk is the serial part of their work. On a chain everything is one part, and nothing is gained; see [`Twisted`](crate::Twisted).

mod aba;
mod crba;
mod ltdl;
mod rnea;
mod twisted;

pub use aba::ParallelAba;
pub use crba::ParallelCrba;
pub use ltdl::ParallelLtdl;
pub use rnea::ParallelRnea;
pub use twisted::Twisted;

use crate::DimensionError;
use crate::error::expect;
use featherbench_model::Topology;
use std::ops::Range;

/// Sub-trees lighter than this share of the tree are not divided: parts for some dozen cores.
const PARTS: u64 = 64;
/// About so many tasks: cores that are done early find another.
const TASKS: u64 = 32;

/// A tree divided into a trunk and parts.
#[derive(Clone, Debug)]
struct Plan {
    /// The bodies of the trunk and the parts, from the root.
    order: Vec<Piece>,
    parts: Vec<Part>,
    tasks: Vec<Task>,
}

/// A body of the trunk, or a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Piece {
    /// The body's index.
    Trunk(usize),
    /// The part's index.
    Part(usize),
}

/// A sub-tree.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Part {
    /// The body of the trunk that carries it, or `None` for the world.
    parent: Option<usize>,
    /// Its bodies, the root first.
    bodies: Range<usize>,
    /// Their dofs.
    dofs: Range<usize>,
}

/// Consecutive parts, with the bodies of the trunk between them.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Task {
    parts: Range<usize>,
    bodies: Range<usize>,
    dofs: Range<usize>,
    /// The path slots up to the last that a part uses.
    slots: usize,
}

impl Plan {
    /// Divides a tree. `weight(d)` is the work on a dof that has d dofs on its path, itself included.
    fn new(topology: &Topology, weight: impl Fn(u64) -> u64) -> Self {
        let joints = topology.joints();
        let count = joints.len();
        // Weight and last body of each sub-tree, its children, and whether it branches.
        let mut weights = vec![0_u64; count];
        let mut end: Vec<usize> = (1..=count).collect();
        let mut children = vec![0_usize; count];
        let mut branches = vec![false; count];
        for (i, joint) in joints.iter().enumerate().rev() {
            weights[i] += (joint.v..joint.v + joint.kind.nv()).map(|dof| weight(topology.dof_depth(dof) as u64)).sum::<u64>();
            branches[i] |= children[i] > 1;
            if let Some(parent) = joint.parent {
                weights[parent] += weights[i];
                end[parent] = end[parent].max(end[i]);
                children[parent] += 1;
                branches[parent] |= branches[i];
            }
        }
        let total: u64 = joints.iter().zip(&weights).filter(|(joint, _)| joint.parent.is_none()).map(|(_, weight)| weight).sum();

        let last_dof = |body: usize| joints.get(body).map_or(topology.nv(), |joint| joint.v);
        let (mut order, mut parts, mut part_weights) = (Vec::new(), Vec::new(), Vec::new());
        let mut next = 0;
        while let Some(joint) = joints.get(next) {
            let heavy = weights[next] > total / PARTS;
            let only_child = joint.parent.is_some_and(|parent| children[parent] == 1);
            if branches[next] && (heavy || only_child) {
                order.push(Piece::Trunk(next));
                next += 1;
            } else {
                order.push(Piece::Part(parts.len()));
                parts.push(Part { parent: joint.parent, bodies: next..end[next], dofs: joint.v..last_dof(end[next]) });
                part_weights.push(weights[next]);
                next = end[next];
            }
        }
        let tasks = tasks(topology, &parts, &part_weights);
        Self { order, parts, tasks }
    }

    /// The bodies of the trunk, from the root.
    fn trunk(&self) -> impl DoubleEndedIterator<Item = usize> + '_ {
        self.order.iter().filter_map(|piece| match piece {
            Piece::Trunk(body) => Some(*body),
            Piece::Part(_) => None,
        })
    }

    /// An error if the tree has another shape.
    fn expect(&self, topology: &Topology) -> Result<(), DimensionError> {
        let joints = topology.joints();
        let fits = |part: &&Part| {
            let root = joints.get(part.bodies.start);
            root.is_some_and(|root| root.parent == part.parent && root.v == part.dofs.start)
        };
        expect("parts of the plan that are sub-trees of the model", self.parts.len(), self.parts.iter().filter(fits).count())
    }

    /// An array with one entry per part, divided between the tasks.
    fn divide_parts<'a, X>(&self, array: &'a mut [X]) -> Vec<&'a mut [X]> {
        self.divide(array, |task| task.parts.clone())
    }

    /// An array divided between the tasks: `range` says what of it belongs to a task. What is between the tasks is left out.
    fn divide<'a, X>(&self, array: &'a mut [X], range: impl Fn(&Task) -> Range<usize>) -> Vec<&'a mut [X]> {
        let (mut rest, mut done) = (array, 0);
        let mut slices = Vec::with_capacity(self.tasks.len());
        for task in &self.tasks {
            let range = range(task);
            let (before, behind) = rest.split_at_mut(range.end - done);
            slices.push(&mut before[range.start - done..]);
            (rest, done) = (behind, range.end);
        }
        slices
    }
}

/// How a tree is divided between cores: what of the work is in the trunk, and what in the heaviest task.
///
/// A dof with d dofs on its path, itself included, weighs a power of d:
///
/// | power | algorithm |
/// |---|---|
/// | 0 | [`ParallelRnea`](crate::ParallelRnea), [`ParallelAba`](crate::ParallelAba) |
/// | 1 | [`ParallelCrba`](crate::ParallelCrba) |
/// | 2 | [`ParallelLtdl`](crate::ParallelLtdl) |
///
/// Cost: O(n).
///
/// ```
/// use featherbench_dynamics::Division;
/// use featherbench_model::Model;
/// use featherbench_robots::Family;
///
/// let tree: Model<f64> = Model::build(&Family::parse("binary_tree:depth=10")?.generate()?)?;
/// let division = Division::of(&tree.topology, 0);
/// assert_eq!(division.total, 1023);
/// assert!(division.tasks > 16 && division.span_share() < 0.2);
/// // A chain is one task.
/// let chain: Model<f64> = Model::build(&Family::parse("chain:n=10")?.generate()?)?;
/// assert_eq!(Division::of(&chain.topology, 0), Division { total: 10, trunk: 0, heaviest: 10, tasks: 1 });
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Division {
    /// The weight of all dofs.
    pub total: u64,
    /// The weight of the trunk, which is not divided.
    pub trunk: u64,
    /// The weight of the heaviest task.
    pub heaviest: u64,
    /// The number of tasks.
    pub tasks: usize,
}

impl Division {
    /// The division of a tree for algorithms of this power.
    pub fn of(topology: &Topology, power: u32) -> Self {
        let weight = |depth: u64| depth.saturating_pow(power);
        let plan = Plan::new(topology, weight);
        let of_dofs = |dofs: Range<usize>| dofs.map(|dof| weight(topology.dof_depth(dof) as u64)).sum::<u64>();
        let total = of_dofs(0..topology.nv());
        let parts: Vec<u64> = plan.parts.iter().map(|part| of_dofs(part.dofs.clone())).collect();
        let heaviest = plan.tasks.iter().map(|task| parts[task.parts.clone()].iter().sum()).max().unwrap_or(0);
        Self { total, trunk: total - parts.iter().sum::<u64>(), heaviest, tasks: plan.tasks.len() }
    }

    /// The share of the work that waits for each other: the trunk, then the heaviest task.
    pub fn span_share(&self) -> f64 {
        (self.trunk + self.heaviest) as f64 / self.total.max(1) as f64
    }
}

/// Consecutive parts in groups of about equal weight.
fn tasks(topology: &Topology, parts: &[Part], weights: &[u64]) -> Vec<Task> {
    let enough = weights.iter().sum::<u64>() / TASKS;
    let (mut tasks, mut first, mut sum) = (Vec::new(), 0, 0);
    for (k, weight) in weights.iter().enumerate() {
        sum += weight;
        if sum > enough || k + 1 == parts.len() {
            let (from, to) = (&parts[first], &parts[k]);
            let bodies = from.bodies.start..to.bodies.end;
            let slots = 1 + topology.joints()[bodies.clone()].iter().map(|joint| joint.slot).max().unwrap_or(0);
            tasks.push(Task { parts: first..k + 1, bodies, dofs: from.dofs.start..to.dofs.end, slots });
            (first, sum) = (k + 1, 0);
        }
    }
    tasks
}
