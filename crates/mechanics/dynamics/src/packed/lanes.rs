//! A register of joints, and sums along paths of the tree over its lanes.
//!
//! A *block* is a register's worth of consecutive joints. A *segment* is a run of joints in a block, each the parent of the next. Inside
//! all segments of a block at once, a sum over the path takes log₂(lanes) additions. After the step of stride s each lane holds the sum of
//! its 2s nearest ancestors in its segment. Then each segment takes the sum up to its parent.

use super::model::{Block, PackedModel, Source};
use super::rotate::{rotate_down, rotate_up};
use featherbench_spatial::{CentralInertia, Force, Mat3, Motion, Real, RigidBodyInertia, Sym3, Vec3};

/// One number of each joint of a block.
#[cfg(target_feature = "avx512f")]
pub(super) type Pack = wide::f64x8;
/// One number of each joint of a block.
#[cfg(not(target_feature = "avx512f"))]
pub(super) type Pack = wide::f64x4;

/// Joints of a block.
pub(super) const LANES: usize = size_of::<Pack>() / size_of::<f64>();
/// Steps of a sum over a segment.
pub(super) const STEPS: usize = LANES.trailing_zeros() as usize;

/// The register with `f(k)` in lane k.
#[inline(always)]
pub(super) fn from_lanes(f: impl Fn(usize) -> f64) -> Pack {
    Pack::new(std::array::from_fn(f))
}

/// What holds a register per component, and can be read lane by lane.
pub(super) trait Lanes: Copy {
    /// The same quantity of one joint.
    type Single: Copy;

    /// Applies a function to each register.
    fn map(self, f: impl Fn(Pack) -> Pack) -> Self;
    /// Applies a function to each register and its fellow.
    fn zip(self, other: Self, f: impl Fn(Pack, Pack) -> Pack) -> Self;
    /// The quantity of the joint in lane k.
    fn lane(&self, k: usize) -> Self::Single;
    /// Replaces the quantity of the joint in lane k.
    fn set_lane(&mut self, k: usize, value: Self::Single);
    /// The quantity of one joint in every lane.
    fn splat(value: Self::Single) -> Self;
}

impl Lanes for Pack {
    type Single = f64;
    #[inline(always)]
    fn map(self, f: impl Fn(Pack) -> Pack) -> Self {
        f(self)
    }
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(Pack, Pack) -> Pack) -> Self {
        f(self, other)
    }
    #[inline(always)]
    fn lane(&self, k: usize) -> f64 {
        self.as_array()[k]
    }
    #[inline(always)]
    fn set_lane(&mut self, k: usize, value: f64) {
        self.as_mut_array()[k] = value;
    }
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self::from_f64(value)
    }
}

/// Implements [`Lanes`] field by field.
macro_rules! lanes_of {
    ($type:ident { $($field:ident: $inner:ty),+ }) => {
        impl Lanes for $type<Pack> {
            type Single = $type<f64>;
            #[inline(always)]
            fn map(self, f: impl Fn(Pack) -> Pack) -> Self {
                Self { $($field: self.$field.map(&f)),+ }
            }
            #[inline(always)]
            fn zip(self, other: Self, f: impl Fn(Pack, Pack) -> Pack) -> Self {
                Self { $($field: self.$field.zip(other.$field, &f)),+ }
            }
            #[inline(always)]
            fn lane(&self, k: usize) -> $type<f64> {
                $type { $($field: self.$field.lane(k)),+ }
            }
            #[inline(always)]
            fn set_lane(&mut self, k: usize, value: $type<f64>) {
                $(self.$field.set_lane(k, value.$field);)+
            }
            #[inline(always)]
            fn splat(value: $type<f64>) -> Self {
                Self { $($field: <$inner>::splat(value.$field)),+ }
            }
        }
    };
}

lanes_of!(Vec3 { x: Pack, y: Pack, z: Pack });
lanes_of!(Mat3 { x: Vec3<Pack>, y: Vec3<Pack>, z: Vec3<Pack> });
lanes_of!(Motion { ang: Vec3<Pack>, lin: Vec3<Pack> });
lanes_of!(Force { ang: Vec3<Pack>, lin: Vec3<Pack> });
lanes_of!(RigidBodyInertia { mass: Pack, first_moment: Vec3<Pack>, rotational: Sym3<Pack> });
lanes_of!(CentralInertia { mass: Pack, com: Vec3<Pack>, rotational: Sym3<Pack> });
lanes_of!(Sym3 { xx: Pack, xy: Pack, xz: Pack, yy: Pack, yz: Pack, zz: Pack });

/// `mask·x + y`, component by component.
#[inline(always)]
fn masked_add<V: Lanes>(mask: Pack, x: V, y: V) -> V {
    x.zip(y, |x, y| x.mul_add(mask, y))
}

/// The sum over the lanes.
#[inline(always)]
pub(super) fn horizontal(v: Vec3<Pack>) -> Vec3<f64> {
    Vec3::new(v.x.reduce_add(), v.y.reduce_add(), v.z.reduce_add())
}

/// The numbers of a block's one-dof joints from a vector with one number per dof or coordinate; 0 in the other lanes.
#[inline(always)]
pub(super) fn load(block: &Block, places: &[usize; LANES], from: &[f64]) -> Pack {
    let mut lanes = [0.0; LANES];
    if block.plain {
        lanes.copy_from_slice(&from[places[0]..places[0] + LANES]);
    } else {
        for (k, lane) in lanes.iter_mut().enumerate() {
            if block.is_screw[k] {
                *lane = from[places[k]];
            }
        }
    }
    Pack::new(lanes)
}

/// Writes the numbers of a block's one-dof joints into a vector with one number per dof.
#[inline(always)]
pub(super) fn store(block: &Block, values: Pack, into: &mut [f64]) {
    let values = values.to_array();
    if block.plain {
        into[block.v[0]..block.v[0] + LANES].copy_from_slice(&values);
    } else {
        for (k, value) in values.into_iter().enumerate() {
            if block.is_screw[k] {
                into[block.v[k]] = value;
            }
        }
    }
}

/// `(x_i + Σ over the ancestors in the joint's segment, Σ over these ancestors alone)`.
#[inline(always)]
pub(super) fn sum_in_segments<V: Lanes>(block: &Block, x: V) -> (V, V) {
    let sum = sum_of_segments(block, x);
    (sum, sum.map(rotate_up::<1>).map(|above| above * block.ancestor[0]))
}

/// x_i and the sum over the ancestors in the joint's segment.
#[inline(always)]
fn sum_of_segments<V: Lanes>(block: &Block, x: V) -> V {
    let mut sum = masked_add(block.ancestor[0], x.map(rotate_up::<1>), x);
    sum = masked_add(block.ancestor[1], sum.map(rotate_up::<2>), sum);
    if LANES > 4 {
        sum = masked_add(block.ancestor[STEPS - 1], sum.map(rotate_up::<{ LANES / 2 }>), sum);
    }
    sum
}

/// `(x_i + Σ over the ancestors, Σ over the ancestors alone)`.
///
/// `before(block, lane)` is the first result of a joint of an earlier block.
#[inline(always)]
pub(super) fn sum_from_root(
    model: &PackedModel,
    block: &Block,
    x: Vec3<Pack>,
    before: impl Fn(usize, usize) -> Vec3<f64>,
) -> (Vec3<Pack>, Vec3<Pack>) {
    let mut sum = sum_of_segments(block, x);
    let mut start = Vec3::<Pack>::zero();
    for segment in &model.segments[block.segments.clone()] {
        let carried = Vec3::<Pack>::splat(match segment.parent {
            Source::Root => continue,
            Source::Before { block, lane } => before(block, lane),
            Source::Within { lane } => sum.lane(lane),
        });
        sum = masked_add(segment.all, carried, sum);
        start = masked_add(segment.first_only, carried, start);
    }
    let above = masked_add(block.ancestor[0], sum.map(rotate_up::<1>), start);
    (sum, above)
}

/// `(y_i = x_i + Σ (y_c + passed_c), Σ (y_c + passed_c))` over the children c: the sums from the leaves, when a joint passes on its sum and
/// `passed`.
///
/// `totals` keeps what each segment passes to its parent. Blocks must be summed last to first.
#[inline(always)]
pub(super) fn sum_from_leaves<V: Lanes>(model: &PackedModel, block: &Block, x: V, passed: V, totals: &mut [V::Single]) -> (V, V)
where
    V::Single: std::ops::Add<Output = V::Single>,
{
    let mut sum = masked_add(block.descendant[0], passed.map(rotate_down::<1>), x);
    sum = masked_add(block.descendant[0], sum.map(rotate_down::<1>), sum);
    sum = masked_add(block.descendant[1], sum.map(rotate_down::<2>), sum);
    if LANES > 4 {
        sum = masked_add(block.descendant[STEPS - 1], sum.map(rotate_down::<{ LANES / 2 }>), sum);
    }
    let mut across = passed.map(|_| Pack::zero());
    for child in &model.children[block.children.clone()] {
        let total = match child.within {
            Some(lane) => sum.lane(lane) + passed.lane(lane),
            None => totals[child.segment],
        };
        let total = V::splat(total);
        sum = masked_add(child.ancestors, total, sum);
        across = masked_add(child.parent, total, across);
    }
    for s in block.segments.clone() {
        let first = model.segments[s].first;
        totals[s] = sum.lane(first) + passed.lane(first);
    }
    let below = sum.zip(passed, |sum, passed| sum + passed).map(rotate_down::<1>);
    (sum, masked_add(block.descendant[0], below, across))
}

/// The parents' vectors; zero at a root. `before(block, lane)` is the vector of a joint of an earlier block.
#[inline(always)]
pub(super) fn of_parents(model: &PackedModel, block: &Block, x: Vec3<Pack>, before: impl Fn(usize, usize) -> Vec3<f64>) -> Vec3<Pack> {
    let mut above = x.map(rotate_up::<1>).map(|above| above * block.ancestor[0]);
    for segment in &model.segments[block.segments.clone()] {
        let parent = match segment.parent {
            Source::Root => continue,
            Source::Before { block, lane } => before(block, lane),
            Source::Within { lane } => x.lane(lane),
        };
        above = masked_add(segment.first_only, Vec3::splat(parent), above);
    }
    above
}
