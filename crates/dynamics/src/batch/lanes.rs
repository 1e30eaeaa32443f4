//! Numbers, registers of them, and the two orders of an array.

use crate::DimensionError;
use crate::error::expect;
use featherbench_spatial::{Compensated, Lift, Part, Real};

/// A number of a batch, `f64` or `f32`, and the register that holds one of each state of a group.
///
/// The register is chosen when the crate is compiled: 64 bytes with AVX-512, otherwise 32.
pub trait Number: Part + Element<Self> + Lift<<Self as Number>::Lanes> + Lift<Compensated<<Self as Number>::Lanes>> {
    /// The register.
    type Lanes: Part + Element<Self>;

    /// How many numbers a register holds.
    const LANES: usize;

    /// The register with these numbers, lane after lane.
    fn pack(number: impl FnMut(usize) -> Self) -> Self::Lanes;

    /// The numbers of a register.
    fn lanes(register: &Self::Lanes) -> &[Self];

    /// The numbers of a register, to be written.
    fn lanes_mut(register: &mut Self::Lanes) -> &mut [Self];
}

/// An element of the arrays of a batch of `S`: a number (row order) or a register (lane order). See the [`Batch`](crate::Batch).
pub trait Element<S: Number>: Copy + Send + Sync {
    /// How many states an element belongs to: 1, or [`Number::LANES`].
    const STATES: usize;

    /// The vectors of one group, of `each` entries. The array has those of all groups. A number's are copied to `buffer`, and the last state
    /// fills lanes without a state.
    fn load<'a>(array: &'a [Self], each: usize, group: usize, buffer: &'a mut [S::Lanes]) -> &'a [S::Lanes];

    /// Writes the results of one group to its part of an array.
    fn store(results: &[S::Lanes], part: &mut [Self]);

    /// Writes NaN over the results of the state in a lane, in its group's part of an array; a vector has `each` entries.
    fn erase(part: &mut [Self], each: usize, lane: usize);
}

/// The first entries of the squares of numbers that cover a vector of `each` entries. A square has `side` entries of `side` states, and is
/// transposed in registers. The last one overlaps the one before it where it must.
#[inline(always)]
fn squares(each: usize, side: usize) -> impl Iterator<Item = usize> {
    let last = each.checked_sub(side);
    (0..each.next_multiple_of(side)).step_by(side).filter_map(move |entry| Some(entry.min(last?)))
}

/// The entries of a vector that is too short for a square.
#[inline(always)]
fn rest(each: usize, side: usize) -> std::ops::Range<usize> {
    if each < side { 0..each } else { 0..0 }
}

macro_rules! number {
    ($scalar:ident, $lanes:path, $count:expr, $square:path, $side:expr) => {
        impl Number for $scalar {
            type Lanes = $lanes;

            const LANES: usize = $count;

            #[inline(always)]
            fn pack(number: impl FnMut(usize) -> Self) -> $lanes {
                <$lanes>::new(std::array::from_fn(number))
            }

            #[inline(always)]
            fn lanes(register: &$lanes) -> &[Self] {
                register.as_array()
            }

            #[inline(always)]
            fn lanes_mut(register: &mut $lanes) -> &mut [Self] {
                register.as_mut_array()
            }
        }

        impl Element<$scalar> for $lanes {
            const STATES: usize = $count;

            #[inline(always)]
            fn load<'a>(array: &'a [Self], each: usize, group: usize, _: &'a mut [$lanes]) -> &'a [$lanes] {
                &array[group * each..][..each]
            }

            #[inline(always)]
            fn store(results: &[$lanes], part: &mut [Self]) {
                part.copy_from_slice(results);
            }

            fn erase(part: &mut [Self], _: usize, lane: usize) {
                for register in part {
                    register.as_mut_array()[lane] = $scalar::NAN;
                }
            }
        }

        impl Element<$scalar> for $scalar {
            const STATES: usize = 1;

            #[inline(always)]
            fn load<'a>(array: &'a [Self], each: usize, group: usize, buffer: &'a mut [$lanes]) -> &'a [$lanes] {
                let rows = &array[group * each * $count..];
                let rows = &rows[..rows.len().min(each * $count)];
                let last = (rows.len() / each.max(1)).saturating_sub(1);
                let mut lanes = [&rows[..0]; $count];
                for (lane, row) in lanes.iter_mut().enumerate() {
                    *row = &rows[lane.min(last) * each..][..buffer.len()];
                }
                let rows = lanes;
                for entry in squares(each, $side) {
                    let columns: [[$square; $side]; $count / $side] = std::array::from_fn(|block| {
                        let row = |k: usize| *rows[block * $side + k][entry..].first_chunk().expect("a row of the square");
                        <$square>::transpose(std::array::from_fn(|k| <$square>::new(row(k))))
                    });
                    for (k, register) in buffer[entry..][..$side].iter_mut().enumerate() {
                        let mut lanes = [[0.0; $side]; $count / $side];
                        for (lanes, columns) in lanes.iter_mut().zip(&columns) {
                            *lanes = columns[k].to_array();
                        }
                        *register = <$lanes>::new(*lanes.as_flattened().first_chunk().expect("all lanes"));
                    }
                }
                for entry in rest(each, $side) {
                    buffer[entry] = <$lanes>::new(std::array::from_fn(|lane| rows[lane][entry]));
                }
                buffer
            }

            #[inline(always)]
            fn store(results: &[$lanes], part: &mut [Self]) {
                let each = results.len();
                let states = part.len() / each.max(1);
                for entry in squares(each, $side) {
                    for (block, part) in part.chunks_mut(each * $side).enumerate() {
                        let row = |k: usize| *results[entry + k].as_array()[block * $side..].first_chunk().expect("a row of the square");
                        let columns = <$square>::transpose(std::array::from_fn(|k| <$square>::new(row(k))));
                        for (state, column) in part.chunks_exact_mut(each).zip(columns) {
                            state[entry..][..$side].copy_from_slice(column.as_array());
                        }
                    }
                }
                for entry in rest(each, $side) {
                    for (lane, number) in results[entry].as_array().iter().enumerate().take(states) {
                        part[lane * each + entry] = *number;
                    }
                }
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

/// An array in lane order, from one in row order whose vectors have `each` entries. The last group is filled with copies of its last state.
///
/// # Errors
/// [`DimensionError`] when the rows are not whole vectors.
pub fn to_lanes<S: Number>(rows: &[S], each: usize) -> Result<Vec<S::Lanes>, DimensionError> {
    let states = rows.len() / each.max(1);
    expect("numbers in row order", states * each, rows.len())?;
    let mut lanes = vec![S::Lanes::zero(); states.div_ceil(S::LANES) * each];
    for (group, part) in lanes.chunks_exact_mut(each.max(1)).enumerate() {
        S::load(rows, each, group, part);
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
        S::store(results, part);
    }
    Ok(rows)
}
