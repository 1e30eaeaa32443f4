//! Trees given by the parent of each node, and a depth-first order of them.
//!
//! A tree-sparse matrix needs no robot: which entries differ from zero is told by the parents of its dofs alone (the book's λ, section 6.4).
//! The rows stand in depth-first order: what a dof supports comes right after it. Any other order is renumbered once, by
//! [`depth_first_order`]. Cost: O(n). No recursion: a chain may be as long as memory permits.

use thiserror::Error;

/// The parents of these dofs do not make a tree in depth-first order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NotATree {
    /// A dof's parent is not on the path from the root to the dof before it.
    #[error(
        "dof {dof} is not in depth-first order: its parent must be the dof before it or an ancestor of that; \
         `depth_first_order` gives an order that is"
    )]
    NotDepthFirst {
        /// The first such dof.
        dof: usize,
    },
    /// A dof's parent does not exist.
    #[error("dof {dof} has parent {parent}, but there are {count} dofs")]
    NoSuchParent {
        /// The dof.
        dof: usize,
        /// Its parent.
        parent: usize,
        /// How many dofs there are.
        count: usize,
    },
    /// A dof is its own ancestor.
    #[error("dof {dof} is its own ancestor")]
    Cycle {
        /// A dof that does not descend from a root.
        dof: usize,
    },
}

/// The dofs of a tree in depth-first order: `order[new]` is the old number. Brothers keep their order, and so do trees.
///
/// # Errors
/// [`NotATree`] when a parent does not exist or a dof is its own ancestor.
///
/// ```
/// use featherbench_dynamics::{TreeSparse, depth_first_order};
/// // Level by level: two dofs on the world, and two on the first of them.
/// let parents = [None, None, Some(0), Some(0)];
/// let order = depth_first_order(&parents)?;
/// assert_eq!(order, [0, 2, 3, 1]);
///
/// let mut new = vec![0; 4];
/// for (place, &old) in order.iter().enumerate() {
///     new[old] = place;
/// }
/// let renumbered: Vec<_> = order.iter().map(|&old| parents[old].map(|parent| new[parent])).collect();
/// let matrix: TreeSparse<f64> = TreeSparse::of_parents(&renumbered)?;
/// assert_eq!(matrix.values().len(), 6);
/// # Ok::<(), featherbench_dynamics::NotATree>(())
/// ```
pub fn depth_first_order(parents: &[Option<usize>]) -> Result<Vec<usize>, NotATree> {
    let count = parents.len();
    // The children of a dof as a linked list, the first child first.
    let (mut first_child, mut next_brother) = (vec![None; count], vec![None; count]);
    let mut roots = Vec::new();
    for (dof, &parent) in parents.iter().enumerate().rev() {
        match parent {
            None => roots.push(dof),
            Some(parent) if parent >= count => return Err(NotATree::NoSuchParent { dof, parent, count }),
            Some(parent) => next_brother[dof] = first_child[parent].replace(dof),
        }
    }
    let mut order = Vec::with_capacity(count);
    let mut next = roots;
    while let Some(dof) = next.pop() {
        order.push(dof);
        // The child is taken before the brother.
        next.extend(next_brother[dof]);
        next.extend(first_child[dof]);
    }
    if order.len() < count {
        let mut reached = vec![false; count];
        order.iter().for_each(|&dof| reached[dof] = true);
        let dof = reached.iter().position(|reached| !reached).unwrap_or(0);
        return Err(NotATree::Cycle { dof });
    }
    Ok(order)
}

/// An error unless each dof's parent is on the path from the root to the dof before it.
pub(crate) fn check_depth_first(parents: &[Option<usize>]) -> Result<(), NotATree> {
    let count = parents.len();
    for (dof, &parent) in parents.iter().enumerate() {
        if let Some(parent) = parent.filter(|&parent| parent >= count) {
            return Err(NotATree::NoSuchParent { dof, parent, count });
        }
        // From the dof before this one towards the root. What is passed is passed for good: it is no later dof's ancestor.
        let mut ancestor = dof.checked_sub(1);
        while ancestor != parent {
            ancestor = parents[ancestor.ok_or(NotATree::NotDepthFirst { dof })?];
        }
    }
    Ok(())
}
