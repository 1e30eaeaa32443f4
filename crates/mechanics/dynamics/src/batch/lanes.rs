//! Numbers, the registers of the build, and the two orders of an array.

use super::kernels::{Inlined, Workspace};
use super::register::{Register, kernels_of_register, methods_of_register};
use super::run::are_finite;
use super::selected::Selectable;
use crate::error::expect;
use crate::{DimensionError, Error};
use featherbench_model::Model;
use featherbench_spatial::{Compensated, Force, Lift, Part, Real};

/// A number of a batch, `f64` or `f32`, and the register of the build that holds one of each state of a group.
///
/// The register is chosen when the crate is compiled: 64 bytes with AVX-512, otherwise 32. A batch can compute in wider ones
/// ([`Width`](crate::Width)). Arrays in lane order always consist of these.
pub trait Number: Part + Element<Self> + Selectable + Lift<<Self as Number>::Lanes> + Lift<Compensated<<Self as Number>::Lanes>> {
    /// The register.
    type Lanes: Part + Element<Self> + Register<Self>;

    /// How many numbers a register holds.
    const LANES: usize;

    /// The register with these numbers, lane after lane.
    #[inline(always)]
    fn pack(number: impl FnMut(usize) -> Self) -> Self::Lanes {
        Register::pack(number)
    }

    /// The numbers of a register.
    #[inline(always)]
    fn lanes(register: &Self::Lanes) -> &[Self] {
        Register::lanes(register)
    }

    /// The numbers of a register, to be written.
    fn lanes_mut(register: &mut Self::Lanes) -> &mut [Self];
}

/// An element of the arrays of a batch of `S`: a number (row order) or a register (lane order). See the [`Batch`](crate::Batch).
pub trait Element<S: Number>: Copy + Send + Sync {
    /// How many states an element belongs to: 1, or [`Number::LANES`].
    const STATES: usize;

    /// The vectors of one group of registers `L`, of `each` entries. The array has those of all groups. Unless it consists of `L`, the group's
    /// are copied to `buffer`, and the last state fills lanes without a state.
    fn load<'a, L: Register<S>>(array: &'a [Self], each: usize, group: usize, buffer: &'a mut [L]) -> &'a [L];

    /// Writes the results of one group to its part of an array.
    fn store<L: Register<S>>(results: &[L], part: &mut [Self]);

    /// Writes NaN over the results of the state in a lane, in its group's part of an array; a vector has `each` entries.
    fn erase(part: &mut [Self], each: usize, lane: usize);
}

macro_rules! number {
    ($scalar:ident, $lanes:path, $count:literal, $square:path, $side:literal) => {
        impl Number for $scalar {
            type Lanes = $lanes;

            const LANES: usize = $count;

            #[inline(always)]
            fn lanes_mut(register: &mut $lanes) -> &mut [Self] {
                register.as_mut_array()
            }
        }

        impl Register<$scalar> for $lanes {
            methods_of_register!($scalar, $count, $square, $side);
            kernels_of_register!($scalar, run_as_built);

            #[inline(always)]
            fn load_rows(array: &[$scalar], each: usize, group: usize, buffer: &mut [Self]) {
                Self::load_rows_inlined(array, each, group, buffer);
            }

            #[inline(always)]
            fn store_rows(results: &[Self], part: &mut [$scalar]) {
                Self::store_rows_inlined(results, part);
            }

            #[inline(always)]
            fn are_finite(registers: &[Self]) -> bool {
                are_finite(registers)
            }

            #[inline(always)]
            fn load_lanes<'a>(array: &'a [$lanes], each: usize, group: usize, _: &'a mut [$lanes]) -> &'a [$lanes] {
                &array[group * each..][..each]
            }

            #[inline(always)]
            fn store_lanes(results: &[$lanes], part: &mut [$lanes]) {
                part.copy_from_slice(results);
            }

            #[inline(always)]
            fn with_instructions<R>(work: impl FnOnce() -> R) -> R {
                work()
            }
        }

        impl Element<$scalar> for $lanes {
            const STATES: usize = $count;

            #[inline(always)]
            fn load<'a, L: Register<$scalar>>(array: &'a [Self], each: usize, group: usize, buffer: &'a mut [L]) -> &'a [L] {
                L::load_lanes(array, each, group, buffer)
            }

            #[inline(always)]
            fn store<L: Register<$scalar>>(results: &[L], part: &mut [Self]) {
                L::store_lanes(results, part);
            }

            fn erase(part: &mut [Self], each: usize, lane: usize) {
                for register in &mut part[lane / $count * each..][..each] {
                    register.as_mut_array()[lane % $count] = $scalar::NAN;
                }
            }
        }

        impl Element<$scalar> for $scalar {
            const STATES: usize = 1;

            #[inline(always)]
            fn load<'a, L: Register<$scalar>>(array: &'a [Self], each: usize, group: usize, buffer: &'a mut [L]) -> &'a [L] {
                L::load_rows(array, each, group, buffer);
                buffer
            }

            #[inline(always)]
            fn store<L: Register<$scalar>>(results: &[L], part: &mut [Self]) {
                L::store_rows(results, part);
            }

            fn erase(part: &mut [Self], each: usize, lane: usize) {
                part[lane * each..][..each].fill($scalar::NAN);
            }
        }
    };
}

#[cfg(target_feature = "avx512f")]
number!(f64, wide::f64x8, 8, wide::f64x4, 4);
#[cfg(target_feature = "avx512f")]
number!(f32, wide::f32x16, 16, wide::f32x8, 8);
#[cfg(not(target_feature = "avx512f"))]
number!(f64, wide::f64x4, 4, wide::f64x4, 4);
#[cfg(not(target_feature = "avx512f"))]
number!(f32, wide::f32x8, 8, wide::f32x8, 8);

/// Runs a kernel with the instructions of the build. A function of its own: row order and lane order share it.
#[inline(never)]
fn run_as_built<'w, K: Inlined<N>, T: Real, P: Real + Lift<T>, const N: usize>(
    workspace: &'w mut Workspace<T>,
    model: &Model<P>,
    inputs: [&[T]; N],
    wrenches: Option<&[Force<T>]>,
) -> (&'w [T], Result<(), Error>) {
    K::run(workspace, model, inputs, wrenches)
}

/// An array in lane order, from one in row order whose vectors have `each` entries. The last group is filled with copies of its last state.
///
/// # Errors
/// [`DimensionError`] when the rows are not whole vectors.
pub fn to_lanes<S: Number>(rows: &[S], each: usize) -> Result<Vec<S::Lanes>, DimensionError> {
    let states = rows.len() / each.max(1);
    expect("numbers in row order", states * each, rows.len())?;
    let mut lanes = vec![S::Lanes::zero(); states.div_ceil(S::LANES) * each];
    for (group, part) in lanes.chunks_exact_mut(each.max(1)).enumerate() {
        Register::load_rows(rows, each, group, part);
    }
    Ok(lanes)
}

/// An array in row order with the vectors of so many states, from one in lane order. A vector has `each` entries.
///
/// # Errors
/// [`DimensionError`] when the number of groups is not the number of states over [`Number::LANES`], rounded up.
pub fn to_rows<S: Number>(lanes: &[S::Lanes], each: usize, states: usize) -> Result<Vec<S>, DimensionError> {
    expect("registers in lane order", states.div_ceil(S::LANES) * each, lanes.len())?;
    let mut rows = vec![S::zero(); states * each];
    let parts = rows.chunks_mut((each * S::LANES).max(1));
    for (results, part) in lanes.chunks_exact(each.max(1)).zip(parts) {
        Register::store_rows(results, part);
    }
    Ok(rows)
}
