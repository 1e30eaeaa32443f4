//! The orientation of every body in the axes of its base: `R_i = R_p L_i`, `d_i = R_p t_i`, and the motion subspaces `R_i S_i`.
//!
//! About its axis u a joint turns by `L = R₀ (u uᵀ + sin q · u× + cos q · (1 − u uᵀ))`. The three matrices are parameters of the model. So
//! L is formed for a register of joints at once, whatever their axes. `R_i = R_p L_i` goes from joint to joint, the columns of R in three
//! registers. The body of a free joint at the root is its tree's base: there R = 1 and d = 0.
//!
//! Cost per joint: about 110 multiply-adds over a register of joints, and 9 multiply-adds of registers of three. The recursion waits for
//! three dependent multiply-adds per joint.

use super::lanes::{LANES, Lanes, Pack, load};
use super::model::{Block, PackedModel, Source, Wide};
use super::xyz::transposed;
use featherbench_model::JointKind;
use featherbench_spatial::{Force, Mat3, Motion, Real, Transform, Vec3};
use wide::f64x4;

/// The orientations of one configuration.
#[derive(Clone, Debug)]
pub(super) struct Orientations {
    pub frames: Vec<Frame>,
    /// Columns of R per body; the fourth number is 0.
    columns: Vec<[f64x4; 3]>,
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
        let (zero, column) = (Vec3::zero(), [f64x4::from_f64(0.0); 3]);
        let frame = Frame { rotation: Mat3::zero(), displacement: zero, subspace: Motion::zero() };
        Self {
            frames: vec![frame; model.blocks.len()],
            columns: vec![column; model.blocks.len() * LANES],
            bases: vec![Vec3::zero(); model.segments.len()],
        }
    }

    /// Turns every body. The steps that need no other block are loops of their own, so that the processor works on several blocks at once.
    #[inline(always)]
    pub fn turn(&mut self, model: &PackedModel, q: &[f64]) {
        for (b, block) in model.blocks.iter().enumerate() {
            let (local, displacement) = self.across_joints(model, block, q);
            let frame = &mut self.frames[b];
            // d = R_p t = R_i (Lᵀ t): the displacement is as straight as the body's own axes
            (frame.rotation, frame.displacement) = (local, local.transpose_mul(displacement));
        }
        for b in 0..model.blocks.len() {
            self.along_path(model, b);
        }
        for ((block, frame), columns) in model.blocks.iter().zip(&mut self.frames).zip(self.columns.as_chunks::<LANES>().0) {
            // from columns per joint to a register per component
            let vector = |column: usize| transposed(|k| columns[k][column]);
            let rotation = straightened(Mat3::from_rows(vector(0), vector(1), vector(2)).transpose());
            let sliding = if block.slides { rotation * block.subspace.lin } else { Vec3::zero() };
            frame.displacement = rotation * frame.displacement;
            (frame.rotation, frame.subspace) = (rotation, Motion::new(rotation * block.subspace.ang, sliding));
        }
    }

    /// `R_i = R_p L_i` for block `b`, whose frame holds L.
    #[inline(always)]
    fn along_path(&mut self, model: &PackedModel, b: usize) {
        let (block, l, columns) = (&model.blocks[b], &self.frames[b].rotation, &mut self.columns[..]);
        for segment in &model.segments[block.segments.clone()] {
            let [mut x, mut y, mut z] = match segment.parent {
                Source::Root => identity(),
                Source::Before { block, lane } => columns[block * LANES + lane],
                Source::Within { lane } => columns[b * LANES + lane],
            };
            for k in segment.first..segment.end {
                let combine = |a: f64, b: f64, c: f64| f64x4::splat(a).mul_add(x, f64x4::splat(b).mul_add(y, f64x4::splat(c) * z));
                let turned = [
                    combine(l.x.x.lane(k), l.y.x.lane(k), l.z.x.lane(k)),
                    combine(l.x.y.lane(k), l.y.y.lane(k), l.z.y.lane(k)),
                    combine(l.x.z.lane(k), l.y.z.lane(k), l.z.z.lane(k)),
                ];
                [x, y, z] = turned;
                columns[b * LANES + k] = turned;
            }
        }
    }

    /// L and t: orientation and position in the parent, in the parent's axes.
    #[inline(always)]
    fn across_joints(&mut self, model: &PackedModel, block: &Block, q: &[f64]) -> (Mat3<Pack>, Vec3<Pack>) {
        let angle = load(block, &block.q, q);
        let mut local = block.turned(angle);
        let mut displacement = if block.slides { block.slide.scale_add(angle, block.mount) } else { block.mount };
        for wide in &model.wide[block.wide.clone()] {
            let x = self.across_wide(model, wide, &q[block.q[wide.lane]..]);
            local.set_lane(wide.lane, x.rotation);
            displacement.set_lane(wide.lane, x.translation);
        }
        (local, displacement)
    }

    /// The placement of a wide joint's body in its parent; of a base, the identity, and the acceleration of its tree's base is turned.
    fn across_wide(&mut self, model: &PackedModel, wide: &Wide, q: &[f64]) -> Transform<f64> {
        let x = wide.kind.transform(&wide.placement, &Motion::zero(), q);
        match wide.base {
            Some(segment) => {
                self.bases[segment] = x.rotation.transpose_mul(-model.gravity);
                Transform::identity()
            }
            None => x,
        }
    }
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

/// The rotation nearest to a matrix that is one but for rounding: `R + R (1 − RᵀR)/2`.
///
/// Rounding makes R longer or shorter by 2⁻⁵³ per joint. Without this step a body's inertia would carry the sum over its path.
#[inline(always)]
pub(super) fn straightened(rotation: Mat3<Pack>) -> Mat3<Pack> {
    let Mat3 { x, y, z } = rotation.transpose();
    let (half, minus_one) = (Pack::from_f64(-0.5), Pack::from_f64(-1.0));
    let product = |a: Vec3<Pack>, b: Vec3<Pack>, start: Pack| a.x.mul_add(b.x, a.y.mul_add(b.y, a.z.mul_add(b.z, start))) * half;
    let [xx, yy, zz] = [product(x, x, minus_one), product(y, y, minus_one), product(z, z, minus_one)];
    let [xy, yz, zx] = [product(x, y, Pack::zero()), product(y, z, Pack::zero()), product(z, x, Pack::zero())];
    let column = |own: Vec3<Pack>, ex: Pack, ey: Pack, ez: Pack| x.scale_add(ex, y.scale_add(ey, z.scale_add(ez, own)));
    Mat3::from_rows(column(x, xx, xy, zx), column(y, xy, yy, yz), column(z, zx, yz, zz)).transpose()
}

fn identity() -> [f64x4; 3] {
    [f64x4::new([1.0, 0.0, 0.0, 0.0]), f64x4::new([0.0, 1.0, 0.0, 0.0]), f64x4::new([0.0, 0.0, 1.0, 0.0])]
}
