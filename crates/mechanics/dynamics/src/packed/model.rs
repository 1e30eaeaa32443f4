//! The parameters of a model, several joints to a register.

use super::bodies::Trees;
use super::lanes::{LANES, Lanes, Pack, STEPS, from_lanes};
use featherbench_model::{JointKind, Label, Model, Topology};
use featherbench_spatial::{CentralInertia, Force, Mat3, Motion, Real, RigidBodyInertia, Sym3, Transform, Vec3};
use std::ops::Range;

/// A model for the packed kernels: its parameters in registers, and where sums go from block to block.
///
/// It is made once from a [`Model`], and has the same bodies, dofs, axes and units.
///
/// ```
/// use featherbench_dynamics::{PackedModel, PackedRnea, inverse_dynamics};
/// use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model};
///
/// let joint = JointDescription { kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] }, ..JointDescription::default() };
/// let bob = BodyDescription { name: "bob".into(), parent: None, mass: 1.0, com: [0.0, 0.0, -0.5], inertia: [0.0; 6], joint };
/// let pendulum = Description { gravity: [0.0, 0.0, -10.0], bodies: vec![bob], ..Description::default() };
/// let model: Model<f64> = Model::build(&pendulum)?;
///
/// let packed = PackedModel::new(&model);
/// let mut tau = [0.0];
/// PackedRnea::new(&packed).run(&packed, &[0.3], &[0.2], &[0.1], None, &mut tau)?;
/// assert!((tau[0] - inverse_dynamics(&model, &[0.3], &[0.2], &[0.1])?[0]).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PackedModel {
    pub(super) topology: Topology,
    /// How the described axes of each body are called.
    pub(super) labels: Vec<Label>,
    pub(super) gravity: Vec3<f64>,
    pub(super) armature: Vec<f64>,
    pub(super) blocks: Vec<Block>,
    pub(super) segments: Vec<Segment>,
    pub(super) children: Vec<Child>,
    pub(super) wide: Vec<Wide>,
    pub(super) trees: Trees,
    /// Whether a body has a child other than the next body.
    pub(super) forks: Vec<bool>,
}

/// The parameters of consecutive joints, one to a lane. Lanes without a joint hold zeros.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// `L = turn[0] + sin q · turn[1] + cos q · turn[2]`: the orientation of each body in its parent. See [`Block::turned`].
    turn: [Mat3<Pack>; 3],
    /// The displacement from the parent's origin, in the parent's axes, at q = 0, and its change with q.
    pub mount: Vec3<Pack>,
    pub slide: Vec3<Pack>,
    /// Motion subspace of the one-dof joints, in body axes.
    pub subspace: Motion<Pack>,
    pub inertia: RigidBodyInertia<Pack>,
    /// I S and Sᵀ I S of each body alone, in body axes.
    pub subspace_force: Force<Pack>,
    pub subspace_inertia: Pack,
    /// The inertia of each body about its centre of mass, in body axes.
    pub central: CentralInertia<Pack>,
    /// Mass of each body with everything that it supports, and its reciprocal or 0.
    pub supported: Pack,
    pub inverse_supported: Pack,
    /// Mass m' of what each body supports, without its own mass m; 1/m' or 0; and m m'/(m + m') or 0.
    pub carried: Pack,
    pub inverse_carried: Pack,
    pub reduced: Pack,
    /// Armature of the one-dof joints.
    pub armature: Pack,
    /// Joints in the block, and the first of them.
    pub count: usize,
    pub first: usize,
    /// Where each joint's numbers begin in q and v.
    pub q: [usize; LANES],
    pub v: [usize; LANES],
    /// The segment of each joint, and how many dofs are above its own on the path to the root.
    pub segment: [usize; LANES],
    pub depth: [usize; LANES],
    /// Whether a joint is the first of its segment.
    pub begins: [bool; LANES],
    /// Whether a lane holds a one-dof joint.
    pub is_screw: [bool; LANES],
    /// Whether every lane holds a one-dof joint, and their numbers are consecutive.
    pub plain: bool,
    /// Whether some joint moves its body's origin in the parent.
    pub slides: bool,
    /// Whether the parent of some joint may have several children.
    pub shares: bool,
    /// 1 in the lanes whose 1, 2, 4 lanes distant ancestor (descendant) is in their segment.
    pub ancestor: [Pack; STEPS],
    pub descendant: [Pack; STEPS],
    pub segments: Range<usize>,
    pub children: Range<usize>,
    pub wide: Range<usize>,
}

impl Block {
    /// L at these angles: the orientation of each body in its parent, but for wide joints.
    #[inline(always)]
    pub fn turned(&self, angle: Pack) -> Mat3<Pack> {
        let (sin, cos) = angle.sin_cos();
        let [fixed, by_sin, by_cos] = &self.turn;
        let partly = by_cos.zip(*fixed, |by_cos, fixed| by_cos.mul_add(cos, fixed));
        by_sin.zip(partly, |by_sin, partly| by_sin.mul_add(sin, partly))
    }
}

/// Joints of a block, each the parent of the next, or one wide joint.
#[derive(Clone, Debug)]
pub(super) struct Segment {
    /// Its lanes.
    pub first: usize,
    pub end: usize,
    /// The joint that it hangs from.
    pub parent: Source,
    /// Whether it has one-dof joints only. A wide joint is a segment by itself.
    pub plain: bool,
    /// 1 in its lanes; 1 in its first lane.
    pub all: Pack,
    pub first_only: Pack,
}

/// Where a segment's parent stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    Root,
    /// In an earlier block.
    Before {
        block: usize,
        lane: usize,
    },
    /// In the same block, in an earlier segment.
    Within {
        lane: usize,
    },
}

impl Source {
    /// Where the parent stands among the lanes of all blocks, for a segment of block `b`.
    #[inline(always)]
    pub fn body(self, b: usize) -> Option<usize> {
        match self {
            Self::Root => None,
            Self::Before { block, lane } => Some(block * LANES + lane),
            Self::Within { lane } => Some(b * LANES + lane),
        }
    }
}

/// A segment that hangs from a joint of a block.
#[derive(Clone, Debug)]
pub(super) struct Child {
    pub segment: usize,
    /// Its first lane, if it is in the same block.
    pub within: Option<usize>,
    /// 1 in the lanes of its ancestors in their segment; 1 in its parent's.
    pub ancestors: Pack,
    pub parent: Pack,
}

/// A spherical or free joint.
#[derive(Clone, Debug)]
pub(super) struct Wide {
    pub lane: usize,
    pub kind: JointKind,
    pub placement: Transform<f64>,
    /// The segment that it begins, if it is a free joint at the root: the base of its tree.
    pub base: Option<usize>,
}

impl PackedModel {
    /// The packed parameters of a model.
    pub fn new(model: &Model<f64>) -> Self {
        let bodies = model.topology.bodies();
        let mut carried = vec![0.0; bodies];
        for (i, joint) in model.topology.joints().iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                carried[parent] += carried[i] + model.inertias[i].mass;
            }
        }
        let mut packed = Self {
            topology: model.topology.clone(),
            labels: model.labels.clone(),
            gravity: model.gravity,
            armature: model.armature.clone(),
            blocks: Vec::new(),
            segments: Vec::new(),
            children: Vec::new(),
            wide: Vec::new(),
            trees: Trees::new(model),
            forks: vec![false; bodies],
        };
        for (i, joint) in model.topology.joints().iter().enumerate() {
            if let Some(parent) = joint.parent.filter(|parent| parent + 1 < i) {
                packed.forks[parent] = true;
            }
        }
        for first in (0..bodies).step_by(LANES) {
            packed.add_block(model, first, (bodies - first).min(LANES), &carried);
        }
        packed.attach_segments();
        packed
    }

    /// The topology of the model.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    fn add_block(&mut self, model: &Model<f64>, first: usize, count: usize, carried: &[f64]) {
        let joints = &model.topology.joints()[first..first + count];
        let screw = |k: usize| k < count && is_screw(joints[k].kind);
        // One number per joint; zero where there is no joint.
        let each = |f: &dyn Fn(usize) -> f64| from_lanes(|k| if k < count { f(first + k) } else { 0.0 });
        let vector = |f: &dyn Fn(usize) -> Vec3<f64>| Vec3::new(each(&|i| f(i).x), each(&|i| f(i).y), each(&|i| f(i).z));
        let matrix = |f: &dyn Fn(usize) -> Mat3<f64>| Mat3::from_rows(vector(&|i| f(i).x), vector(&|i| f(i).y), vector(&|i| f(i).z));
        let subspace = |i: usize| if is_screw(model.topology.joints()[i].kind) { model.subspaces[i] } else { Motion::zero() };
        let own = |i: usize| model.inertias[i].mul(subspace(i));
        let turns: Vec<[Mat3<f64>; 3]> = (first..first + count).map(|i| turn(model, i)).collect();
        let sym3 = |f: &dyn Fn(usize) -> Sym3<f64>| {
            let entry = |entry: fn(&Sym3<f64>) -> f64| each(&|i| entry(&f(i)));
            Sym3 {
                xx: entry(|s| s.xx),
                xy: entry(|s| s.xy),
                xz: entry(|s| s.xz),
                yy: entry(|s| s.yy),
                yz: entry(|s| s.yz),
                zz: entry(|s| s.zz),
            }
        };
        let supported = |i: usize| model.inertias[i].mass + carried[i];

        let segments = self.segments.len()..self.segments.len() + self.add_segments(model, first, count);
        let distance = |k: usize, stride: usize, up: bool| {
            let own = self.segments[segments.clone()].iter().find(|segment| (segment.first..segment.end).contains(&k));
            let inside = own.is_some_and(|segment| if up { k >= segment.first + stride } else { k + stride < segment.end });
            if inside { 1.0 } else { 0.0 }
        };
        let steps = |up: bool| std::array::from_fn(|step| from_lanes(|k| distance(k, 1 << step, up)));
        let (ancestor, descendant) = (steps(true), steps(false));

        let wide_from = self.wide.len();
        for (lane, joint) in joints.iter().enumerate().filter(|(_, joint)| !is_screw(joint.kind)) {
            let begun = segments.clone().find(|s| self.segments[*s].first == lane);
            let base = begun.filter(|_| joint.kind == JointKind::Free && joint.parent.is_none());
            self.wide.push(Wide { lane, kind: joint.kind, placement: model.placements[first + lane], base });
        }
        let slides = joints.iter().any(|joint| !matches!(joint.kind, JointKind::Revolute(_) | JointKind::Spherical));
        let place = |of: fn(&featherbench_model::Joint) -> usize| std::array::from_fn(|k| joints.get(k).map_or(0, of));
        self.blocks.push(Block {
            turn: std::array::from_fn(|part| matrix(&|i| turns[i - first][part])),
            mount: vector(&|i| model.placements[i].translation),
            slide: vector(&|i| model.placements[i].rotation * subspace(i).lin),
            subspace: Motion::new(vector(&|i| subspace(i).ang), vector(&|i| subspace(i).lin)),
            inertia: RigidBodyInertia {
                mass: each(&|i| model.inertias[i].mass),
                first_moment: vector(&|i| model.inertias[i].first_moment),
                rotational: sym3(&|i| model.inertias[i].rotational),
            },
            subspace_force: Force::new(vector(&|i| own(i).ang), vector(&|i| own(i).lin)),
            subspace_inertia: each(&|i| subspace(i).dot(own(i))),
            central: CentralInertia {
                mass: each(&|i| model.inertias[i].mass),
                com: vector(&|i| model.inertias[i].central().com),
                rotational: sym3(&|i| model.inertias[i].central().rotational),
            },
            supported: each(&supported),
            inverse_supported: each(&|i| supported(i).reciprocal_or_zero()),
            carried: each(&|i| carried[i]),
            inverse_carried: each(&|i| carried[i].reciprocal_or_zero()),
            reduced: each(&|i| model.inertias[i].mass * carried[i] * supported(i).reciprocal_or_zero()),
            armature: from_lanes(|k| if screw(k) { model.armature[joints[k].v] } else { 0.0 }),
            count,
            first,
            q: place(|joint| joint.q),
            v: place(|joint| joint.v),
            segment: std::array::from_fn(|k| {
                let holds = |s: &usize| (self.segments[*s].first..self.segments[*s].end).contains(&k);
                segments.clone().find(holds).unwrap_or(segments.start)
            }),
            begins: std::array::from_fn(|k| segments.clone().any(|s| self.segments[s].first == k)),
            depth: std::array::from_fn(|k| joints.get(k).map_or(0, |joint| model.topology.dof_depth(joint.v) - 1)),
            is_screw: std::array::from_fn(screw),
            plain: (0..LANES).all(screw),
            slides,
            shares: joints.iter().any(|joint| joint.parent.is_some_and(|parent| self.forks[parent])),
            ancestor,
            descendant,
            segments,
            children: 0..0,
            wide: wide_from..self.wide.len(),
        });
    }

    /// Adds the segments of a block, and returns their number.
    fn add_segments(&mut self, model: &Model<f64>, first: usize, count: usize) -> usize {
        let joints = model.topology.joints();
        let alone = |i: usize| !is_screw(joints[i].kind);
        let begins = |k: &usize| {
            let i = first + k;
            *k == 0 || joints[i].parent != Some(i - 1) || alone(i) || alone(i - 1)
        };
        let starts: Vec<usize> = (0..count).filter(begins).collect();
        for (s, &start) in starts.iter().enumerate() {
            let end = starts.get(s + 1).map_or(count, |next| *next);
            let parent = match joints[first + start].parent {
                None => Source::Root,
                Some(parent) if parent >= first => Source::Within { lane: parent - first },
                Some(parent) => Source::Before { block: parent / LANES, lane: parent % LANES },
            };
            let plain = joints[first + start..first + end].iter().all(|joint| is_screw(joint.kind));
            let (all, first_only) = (mask(start..end), mask(start..start + 1));
            self.segments.push(Segment { first: start, end, parent, plain, all, first_only });
        }
        starts.len()
    }

    /// Lists for each block the segments that hang from its joints, the last segment first.
    fn attach_segments(&mut self) {
        let mut children: Vec<Vec<Child>> = vec![Vec::new(); self.blocks.len()];
        for (b, block) in self.blocks.iter().enumerate().rev() {
            for segment in block.segments.clone().rev() {
                let Segment { first, parent, .. } = self.segments[segment];
                let (host, lane, within) = match parent {
                    Source::Root => continue,
                    Source::Before { block, lane } => (block, lane, None),
                    Source::Within { lane } => (b, lane, Some(first)),
                };
                let mut hosts = self.segments[self.blocks[host].segments.clone()].iter();
                let start = hosts.find(|host| (host.first..host.end).contains(&lane)).map_or(lane, |host| host.first);
                let (ancestors, parent) = (mask(start..lane + 1), mask(lane..lane + 1));
                children[host].push(Child { segment, within, ancestors, parent });
            }
        }
        for (block, children) in self.blocks.iter_mut().zip(children) {
            let from = self.children.len();
            self.children.extend(children);
            block.children = from..self.children.len();
        }
    }
}

/// 1 in these lanes.
fn mask(lanes: Range<usize>) -> Pack {
    from_lanes(|k| if lanes.contains(&k) { 1.0 } else { 0.0 })
}

/// Whether a joint is a one-dof screw.
pub(super) fn is_screw(kind: JointKind) -> bool {
    matches!(kind, JointKind::Revolute(_) | JointKind::Prismatic(_) | JointKind::Helical)
}

/// The parts of `L = R (u uᵀ + sin q · u× + cos q · (1 − u uᵀ))`, the orientation of a body that turns about u; `R` alone if it does not.
///
/// About an axis of the frame each product is exact.
fn turn(model: &Model<f64>, i: usize) -> [Mat3<f64>; 3] {
    let (r, u) = (model.placements[i].rotation, model.subspaces[i].ang);
    match model.topology.joints()[i].kind {
        JointKind::Revolute(_) | JointKind::Helical => {
            let along = Sym3::rank_one(1.0, u);
            let across = Sym3::scalar(1.0) - along;
            [r * along.to_mat3(), r * Mat3::skew(u), r * across.to_mat3()]
        }
        JointKind::Prismatic(_) => [r, Mat3::zero(), Mat3::zero()],
        JointKind::Spherical | JointKind::Free => [Mat3::zero(); 3],
    }
}
