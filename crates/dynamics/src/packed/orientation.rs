//! The orientation of every body in the axes of its base, `R_i = R_p L_i`, with `d_i = R_p t_i` and the motion subspaces `R_i S_i`.
//!
//! Orientations are kept as quaternions. About its axis u a joint turns by `l = p (cos q/2 + sin q/2 · u)`, where p is that of its
//! placement: p and p u are parameters of the model. So l is formed for a register of joints at once, whatever their axes. The product over
//! the path takes log₂(lanes) steps, like the sums in `lanes.rs`; then each segment takes the orientation of its parent. The body of a free
//! joint at the root is its tree's base: there R = 1 and d = 0.
//!
//! Rounding changes the length of a quaternion by 2⁻⁵³ per step. R does not depend on the length, and is orthogonal up to its own rounding.
//!
//! Cost per register of joints: sine and cosine, about 190 other instructions, and 30 more for each segment. With matrices in place of
//! quaternions it would be twice as many.

use super::lanes::{LANES, Lanes, Pack, STEPS, load};
use super::model::{Block, PackedModel, Source, Wide};
use super::rotate::rotate_up;
use featherbench_model::JointKind;
use featherbench_spatial::{Force, Mat3, Motion, Quaternion, Real, Vec3};

/// The orientations of one configuration.
#[derive(Clone, Debug)]
pub(super) struct Orientations {
    pub frames: Vec<Frame>,
    /// Orientation of each body, per block: relative to the segment's parent, then to the base.
    turns: Vec<Quaternion<Pack>>,
    /// Orientation of the body that a segment hangs from.
    parents: Vec<Quaternion<f64>>,
    /// Acceleration −g of the base, in the axes of its tree, per segment that begins at the root. A run sets it.
    pub bases: Vec<Vec3<f64>>,
}

/// The orientations of a block, in the axes of the base.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Orientation of each body.
    pub rotation: Mat3<Pack>,
    /// Displacement d of each body's origin from its parent's.
    pub displacement: Vec3<Pack>,
    /// Motion subspace of each one-dof joint.
    pub subspace: Motion<Pack>,
}

impl Orientations {
    pub fn new(model: &PackedModel) -> Self {
        let (zero, upright) = (Vec3::zero(), Quaternion { v: Vec3::zero(), w: 1.0 });
        let frame = Frame { rotation: Mat3::zero(), displacement: zero, subspace: Motion::zero() };
        Self {
            frames: vec![frame; model.blocks.len()],
            turns: vec![Quaternion::splat(upright); model.blocks.len()],
            parents: vec![upright; model.segments.len()],
            bases: vec![Vec3::zero(); model.segments.len()],
        }
    }

    /// Turns every body. The steps that need no other block come first, so that the processor works on several blocks at once.
    #[inline(always)]
    pub fn turn(&mut self, model: &PackedModel, q: &[f64]) {
        for (b, block) in model.blocks.iter().enumerate() {
            let (local, displacement) = self.across_joints(model, block, q);
            self.turns[b] = along_segments(block, local);
            self.frames[b].displacement = displacement;
        }
        for (b, block) in model.blocks.iter().enumerate() {
            let turn = self.along_path(model, b);
            self.turns[b] = turn;
            let rotation = turn.to_rotation();
            let sliding = if block.slides { rotation * block.subspace.lin } else { Vec3::zero() };
            let frame = &mut self.frames[b];
            frame.displacement = rotation * frame.displacement;
            (frame.rotation, frame.subspace) = (rotation, Motion::new(rotation * block.subspace.ang, sliding));
        }
    }

    /// l and Lᵀ t: orientation in the parent, and displacement from the parent's origin in the body's axes.
    #[inline(always)]
    fn across_joints(&mut self, model: &PackedModel, block: &Block, q: &[f64]) -> (Quaternion<Pack>, Vec3<Pack>) {
        let position = load(block, &block.q, q);
        let (sin, cos) = (position * block.half).sin_cos();
        let mut local = block.turn[0].zip(block.turn[1], |by_cos, by_sin| by_sin.mul_add(sin, by_cos * cos));
        local.w += block.idle;
        // of the whole angle: sin q = 2 sin q/2 cos q/2,  cos q = 1 − 2 sin² q/2
        let twice = sin + sin;
        let (sin, cos) = (twice * cos, twice.mul_add(-sin, Pack::from_f64(1.0)));
        let [fixed, by_sin, by_cos] = block.mount;
        let mut displacement = by_sin.scale_add(sin, by_cos.scale_add(cos, fixed));
        if block.slides {
            displacement = block.subspace.lin.scale_add(position, displacement);
        }
        for wide in &model.wide[block.wide.clone()] {
            let (turn, mount) = self.across_wide(model, wide, &q[block.q[wide.lane]..]);
            local.set_lane(wide.lane, turn);
            displacement.set_lane(wide.lane, mount);
        }
        (local, displacement)
    }

    /// l and Lᵀ t of a wide joint. Of a base they are 1 and 0, and the acceleration of its tree's base is turned.
    fn across_wide(&mut self, model: &PackedModel, wide: &Wide, q: &[f64]) -> (Quaternion<f64>, Vec3<f64>) {
        let x = wide.kind.transform(&wide.placement, &Motion::zero(), q);
        match wide.base {
            Some(segment) => {
                self.bases[segment] = x.rotation.transpose_mul(-model.gravity);
                (Quaternion { v: Vec3::zero(), w: 1.0 }, Vec3::zero())
            }
            None => {
                // the last four coordinates of either kind
                let last = wide.kind.nq() - 4;
                let across = Quaternion::from_array([q[last], q[last + 1], q[last + 2], q[last + 3]]);
                (wide.turn * across.normalized(), x.rotation.transpose_mul(x.translation))
            }
        }
    }

    /// The orientations in the base, from those relative to the segments' parents.
    #[inline(always)]
    fn along_path(&mut self, model: &PackedModel, b: usize) -> Quaternion<Pack> {
        let (block, within) = (&model.blocks[b], self.turns[b]);
        if block.segments.len() == 1 && model.segments[block.segments.start].parent == Source::Root {
            return within;
        }
        let mut parents = Quaternion { v: Vec3::zero(), w: block.idle };
        for s in block.segments.clone() {
            let segment = &model.segments[s];
            let parent = match segment.parent {
                Source::Root => Quaternion { v: Vec3::zero(), w: 1.0 },
                Source::Before { block, lane } => self.turns[block].lane(lane),
                Source::Within { lane } => self.parents[block.segment[lane]] * within.lane(lane),
            };
            self.parents[s] = parent;
            parents = Quaternion::splat(parent).zip(parents, |parent, parents| parent.mul_add(segment.all, parents));
        }
        parents * within
    }
}

/// The product of l over each joint's segment, up to the joint.
#[inline(always)]
fn along_segments(block: &Block, local: Quaternion<Pack>) -> Quaternion<Pack> {
    let mut product = after(block.ancestor[0], local.map(rotate_up::<1>), local);
    product = after(block.ancestor[1], product.map(rotate_up::<2>), product);
    if LANES > 4 {
        product = after(block.ancestor[STEPS - 1], product.map(rotate_up::<{ LANES / 2 }>), product);
    }
    product
}

/// `above · turn` in the lanes where `mask` is 1, and `turn` where it is 0.
#[inline(always)]
fn after(mask: Pack, above: Quaternion<Pack>, turn: Quaternion<Pack>) -> Quaternion<Pack> {
    let above = Quaternion { v: above.v * mask, w: above.w.mul_add(mask, Pack::from_f64(1.0) - mask) };
    above * turn
}

/// I S of each body alone, in the axes of the base.
///
/// A thin body that turns about its length has a small I S in body axes, and turning that keeps it small. The product of the turned I and S
/// would have the rounding errors of all of I.
#[inline(always)]
pub(super) fn own_force(block: &Block, frame: &Frame) -> Force<Pack> {
    Force::new(frame.rotation * block.subspace_force.ang, frame.rotation * block.subspace_force.lin)
}

/// The motion across each joint for one number per dof: `R_i S_i v`.
#[inline(always)]
pub(super) fn across(model: &PackedModel, block: &Block, frame: &Frame, v: &[f64]) -> Motion<Pack> {
    let rate = load(block, &block.v, v);
    let lin = if block.slides { frame.subspace.lin * rate } else { Vec3::zero() };
    let mut motion = Motion::new(frame.subspace.ang * rate, lin);
    for wide in &model.wide[block.wide.clone()] {
        let r = frame.rotation.lane(wide.lane);
        let local: Motion<f64> = wide.kind.motion(&Motion::<f64>::zero(), &v[block.v[wide.lane]..]);
        motion.ang.set_lane(wide.lane, r * local.ang);
        if wide.kind == JointKind::Free {
            motion.lin.set_lane(wide.lane, r * local.lin);
        }
    }
    motion
}
