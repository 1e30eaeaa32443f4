//! Where the trees of a model stand in the world: the placement of the axes and of the origin that a tree's packed quantities refer to.
//!
//! The packed axes of a tree are those of the world, or those of its root body if its root is a free joint. Positions are displacements
//! from the root body's origin. So a robot far from the world's origin loses no digits of its shape.

use super::lanes::{LANES, Lanes, Pack, from_lanes};
use super::orientation::Frame;
use featherbench_model::{JointKind, Model};
use featherbench_spatial::{Mat3, Motion, Transform, Vec3};

/// The trees of a model.
#[derive(Clone, Debug)]
pub(super) struct Trees {
    pub roots: Vec<Root>,
    /// Mass of all bodies.
    pub mass: f64,
    /// The tree of each body.
    pub of_body: Vec<usize>,
    blocks: Vec<Members>,
}

/// The joint at the root of a tree.
#[derive(Clone, Debug)]
pub(super) struct Root {
    kind: JointKind,
    placement: Transform<f64>,
    /// Linear part of the subspace of a one-dof joint.
    slide: Vec3<f64>,
    /// Where its numbers begin in q.
    q: usize,
    /// Mass of the tree.
    pub mass: f64,
}

/// The trees of a block's joints.
#[derive(Clone, Debug)]
struct Members {
    tree: [usize; LANES],
    /// Whether all joints are of one tree.
    alone: bool,
    /// Whether the packed axes of some joint are not those of the world.
    turned: bool,
    /// Whether some joint is a root, and 0 in the lanes of the roots, 1 in the others.
    has_root: bool,
    hangs: Pack,
}

impl Trees {
    pub fn new(model: &Model<f64>) -> Self {
        let joints = model.topology.joints();
        let mut trees = Self { roots: Vec::new(), mass: 0.0, of_body: Vec::new(), blocks: Vec::new() };
        for (i, joint) in joints.iter().enumerate() {
            let tree = joint.parent.map_or(trees.roots.len(), |parent| trees.of_body[parent]);
            if joint.parent.is_none() {
                let (placement, slide) = (model.placements[i], model.subspaces[i].lin);
                trees.roots.push(Root { kind: joint.kind, placement, slide, q: joint.q, mass: 0.0 });
            }
            trees.roots[tree].mass += model.inertias[i].mass;
            trees.of_body.push(tree);
        }
        trees.mass = trees.roots.iter().map(|root| root.mass).sum();
        for (of_body, joints) in trees.of_body.chunks(LANES).zip(joints.chunks(LANES)) {
            let tree = std::array::from_fn(|k| *of_body.get(k).unwrap_or(&of_body[0]));
            let is_root = |k: usize| joints.get(k).is_some_and(|joint| joint.parent.is_none());
            trees.blocks.push(Members {
                tree,
                alone: tree.iter().all(|other| *other == tree[0]),
                turned: tree.iter().any(|tree| trees.roots[*tree].kind == JointKind::Free),
                has_root: (0..LANES).any(is_root),
                hangs: from_lanes(|k| if is_root(k) { 0.0 } else { 1.0 }),
            });
        }
        trees
    }

    /// The centre of mass from a first moment of mass; not finite when there is no mass.
    #[inline(always)]
    pub fn center(&self, moment: Vec3<f64>) -> Vec3<f64> {
        Vec3::new(moment.x / self.mass, moment.y / self.mass, moment.z / self.mass)
    }

    /// The displacements of a block's bodies from their parents; zero for the roots.
    #[inline(always)]
    pub fn displacement(&self, b: usize, frame: &Frame) -> Vec3<Pack> {
        let members = &self.blocks[b];
        if members.has_root { frame.displacement * members.hangs } else { frame.displacement }
    }
}

impl Root {
    /// Placement of the tree's axes, at the root body's origin.
    #[inline(always)]
    pub fn pose(&self, q: &[f64]) -> Transform<f64> {
        let Self { kind, placement, slide, .. } = self;
        let q = &q[self.q..];
        match kind {
            JointKind::Free => kind.transform(placement, &Motion::zero(), q),
            JointKind::Prismatic | JointKind::Helical => Transform::new(Mat3::identity(), placement.point(*slide * q[0])),
            JointKind::Revolute | JointKind::Spherical => Transform::new(Mat3::identity(), placement.translation),
        }
    }
}

/// The placement of each tree of a configuration.
#[derive(Clone, Debug)]
pub(super) struct Poses(Vec<Transform<f64>>);

impl Poses {
    pub fn new(trees: &Trees) -> Self {
        Self(vec![Transform::identity(); trees.roots.len()])
    }

    /// Places the trees. A workspace must have as many of them as the model.
    #[inline(always)]
    pub fn place(&mut self, trees: &Trees, q: &[f64]) {
        for (pose, root) in self.0.iter_mut().zip(&trees.roots) {
            *pose = root.pose(q);
        }
    }

    /// How many trees there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The origin of the first root body; zero without bodies.
    #[inline(always)]
    pub fn first(&self) -> Vec3<f64> {
        self.0.first().map_or(Vec3::zero(), |pose| pose.translation)
    }

    /// The first moment of mass about [`Poses::first`], from the sum of those of the trees about their own root bodies' origins.
    #[inline(always)]
    pub fn about_first(&self, trees: &Trees, moment: Vec3<f64>) -> Vec3<f64> {
        let others = self.0.iter().zip(&trees.roots).skip(1);
        others.fold(moment, |moment, (pose, root)| (pose.translation - self.first()).scale_add(root.mass, moment))
    }

    /// Positions as seen from [`Poses::first`], from those as seen from each root body's origin.
    #[inline(always)]
    pub fn from_first(&self, trees: &Trees, b: usize, from_root: Vec3<Pack>) -> Vec3<Pack> {
        match self.0.len() {
            0 | 1 => from_root,
            _ => from_root + self.each::<Vec3<Pack>>(&trees.blocks[b], |pose| pose.translation - self.first()),
        }
    }

    /// The origin of each joint's tree.
    #[inline(always)]
    pub fn origins(&self, trees: &Trees, b: usize) -> Vec3<Pack> {
        self.each(&trees.blocks[b], |pose| pose.translation)
    }

    /// A vector per joint of a block, in world axes.
    #[inline(always)]
    pub fn turn(&self, trees: &Trees, b: usize, v: Vec3<Pack>) -> Vec3<Pack> {
        let members = &trees.blocks[b];
        if members.turned { self.each::<Mat3<Pack>>(members, |pose| pose.rotation) * v } else { v }
    }

    /// The frame of a block in world axes, its roots displaced by zero.
    #[inline(always)]
    pub fn in_world(&self, trees: &Trees, b: usize, frame: &Frame) -> Frame {
        let (members, displacement) = (&trees.blocks[b], trees.displacement(b, frame));
        if members.turned {
            let r: Mat3<Pack> = self.each(members, |pose| pose.rotation);
            let subspace = Motion::new(r * frame.subspace.ang, r * frame.subspace.lin);
            Frame { rotation: r * frame.rotation, displacement: r * displacement, subspace }
        } else {
            Frame { displacement, ..*frame }
        }
    }

    /// What `of` reads from the placement of each joint's tree.
    #[inline(always)]
    fn each<V: Lanes>(&self, members: &Members, of: impl Fn(&Transform<f64>) -> V::Single) -> V {
        let mut each = V::splat(of(&self.0[members.tree[0]]));
        if !members.alone {
            for (k, tree) in members.tree.iter().enumerate() {
                each.set_lane(k, of(&self.0[*tree]));
            }
        }
        each
    }
}
