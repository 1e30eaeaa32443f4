//! The tree: parents, joint kinds and indices, without a scalar.

use crate::{Axis, JointKind};
use std::sync::OnceLock;

/// A joint of the compiled tree and its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Joint {
    /// The parent body, or `None` for the world. Always less than the body's own index.
    pub parent: Option<usize>,
    /// The kind of joint.
    pub kind: JointKind,
    /// Where the joint's part of q begins.
    pub q: usize,
    /// Where the joint's part of v begins.
    pub v: usize,
    /// The *path slot* of the body. A recursion keeps there what it needs of the bodies on one path.
    ///
    /// The world has slot 0, a root has slot 1. The last child of a body takes over its parent's slot, every other child has the next slot.
    /// So in depth-first order a slot is written only after the last child has read it. A chain has one slot, whatever its length.
    pub slot: usize,
    /// The path slot of the parent.
    pub parent_slot: usize,
}

/// A tree of primitive joints in depth-first order. Body i is the body moved by joint i.
///
/// It takes O(n) memory: of a revolute joint 80 bytes. Only [`Topology::row_dofs`] takes more.
#[derive(Clone, Debug)]
pub struct Topology {
    joints: Vec<Joint>,
    nq: usize,
    nv: usize,
    dof_parent: Vec<Option<usize>>,
    row_start: Vec<usize>,
    slots: usize,
    /// The dofs of all rows, made when they are first asked for.
    row_dofs: OnceLock<Vec<usize>>,
}

/// Trees are equal if their joints are: all else follows from these.
impl PartialEq for Topology {
    fn eq(&self, other: &Self) -> bool {
        self.joints == other.joints
    }
}

impl Eq for Topology {}

impl Topology {
    /// The tree of these (parent, kind) pairs, parents before children.
    ///
    /// Returns `None` unless the order is depth-first: each body's parent must be on the path from the world to the body before it.
    pub fn new(tree: &[(Option<usize>, JointKind)]) -> Option<Self> {
        let mut joints: Vec<Joint> = Vec::with_capacity(tree.len());
        let (mut nq, mut nv) = (0, 0);
        let mut path: Vec<usize> = Vec::new();
        for (body, &(parent, kind)) in tree.iter().enumerate() {
            while path.last().copied() != parent {
                path.pop()?;
            }
            path.push(body);
            joints.push(Joint { parent, kind, q: nq, v: nv, slot: 1, parent_slot: 0 });
            nq += kind.nq();
            nv += kind.nv();
        }

        let mut last_child: Vec<usize> = vec![0; joints.len()];
        for (body, joint) in joints.iter().enumerate() {
            if let Some(parent) = joint.parent {
                last_child[parent] = body;
            }
        }
        for body in 0..joints.len() {
            if let Some(parent) = joints[body].parent {
                joints[body].parent_slot = joints[parent].slot;
                joints[body].slot = joints[parent].slot + usize::from(last_child[parent] != body);
            }
        }

        // A dof's parent is the dof before it in its joint, or the last dof of the parent body.
        let mut dof_parent = Vec::with_capacity(nv);
        for joint in &joints {
            let inherited = joint.parent.map(|parent: usize| joints[parent].v + joints[parent].kind.nv() - 1);
            dof_parent.extend((0..joint.kind.nv()).map(|k| if k == 0 { inherited } else { Some(joint.v + k - 1) }));
        }

        // Row k: the dofs from the root to k, k included. It is one longer than that of its parent.
        let mut row_start: Vec<usize> = Vec::with_capacity(nv + 1);
        row_start.push(0);
        for (dof, parent) in dof_parent.iter().enumerate() {
            let above = parent.map_or(0, |parent: usize| row_start[parent + 1] - row_start[parent]);
            row_start.push(row_start[dof] + above + 1);
        }
        let slots = 1 + joints.iter().map(|joint| joint.slot).max().unwrap_or(0);
        Some(Self { joints, nq, nv, dof_parent, row_start, slots, row_dofs: OnceLock::new() })
    }

    /// The same tree with the axes of these joints taken as skew ones.
    pub fn with_skew_axes(&self, skew: impl Fn(usize) -> bool) -> Self {
        let mut changed = self.clone();
        for (_, joint) in changed.joints.iter_mut().enumerate().filter(|(i, _)| skew(*i)) {
            joint.kind = joint.kind.with_axis(Axis::Skew);
        }
        changed
    }

    /// The joints, depth-first.
    #[inline(always)]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Number of bodies, massless ones of composed joints included.
    #[inline(always)]
    pub fn bodies(&self) -> usize {
        self.joints.len()
    }

    /// Length of q.
    #[inline(always)]
    pub fn nq(&self) -> usize {
        self.nq
    }

    /// Degrees of freedom.
    #[inline(always)]
    pub fn nv(&self) -> usize {
        self.nv
    }

    /// The parent dof of each dof: the book's λ on the expanded tree (section 6.4).
    pub fn dof_parents(&self) -> &[Option<usize>] {
        &self.dof_parent
    }

    /// Depth of a dof: the number of dofs from the root to it, itself included.
    pub fn dof_depth(&self, dof: usize) -> usize {
        self.row_start[dof + 1] - self.row_start[dof]
    }

    /// The range of row `dof` of a tree-sparse matrix in its flat array: entries (dof, a) for each a of [`Topology::row_dofs`].
    #[inline(always)]
    pub fn row(&self, dof: usize) -> std::ops::Range<usize> {
        self.row_start[dof]..self.row_start[dof + 1]
    }

    /// The dofs from the root to `dof`, itself last.
    ///
    /// The first call makes the rows of all dofs: [`Topology::stored`] numbers, on a chain n (n + 1) / 2. Algorithms in O(n) follow
    /// [`Topology::dof_parents`] in place of it.
    pub fn row_dofs(&self, dof: usize) -> &[usize] {
        let rows = self.row_dofs.get_or_init(|| {
            let mut rows = Vec::with_capacity(self.stored());
            for (dof, parent) in self.dof_parent.iter().enumerate() {
                if let Some(parent) = *parent {
                    rows.extend_from_within(self.row(parent));
                }
                rows.push(dof);
            }
            rows
        });
        &rows[self.row(dof)]
    }

    /// Stored numbers of a tree-sparse matrix: `n + Σ(d_k − 1)`.
    #[inline(always)]
    pub fn stored(&self) -> usize {
        self.row_start[self.nv]
    }

    /// The number of path slots ([`Joint::slot`]), the world's included. It is 2 on a chain, and at most one more than [`Topology::depth`].
    pub fn slots(&self) -> usize {
        self.slots
    }

    /// The largest number of bodies on a path from the world.
    pub fn depth(&self) -> usize {
        let mut depth = vec![0_usize; self.bodies()];
        for (i, joint) in self.joints.iter().enumerate() {
            depth[i] = 1 + joint.parent.map_or(0, |parent| depth[parent]);
        }
        depth.into_iter().max().unwrap_or(0)
    }
}
