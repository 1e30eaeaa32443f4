//! What a batch asks of a register: numbers in and out of it, both orders of an array, and the kernels with the instructions of its width.

use super::Number;
use super::kernels::{Inlined, Workspace};
use crate::Error;
use featherbench_model::Model;
use featherbench_spatial::{Force, Real};

/// A register of numbers `S`, one of each state of a group.
///
/// A batch runs its kernels through [`Register::run`] and [`Register::run_each`]. A register of a [`Width`](super::Width) that is wider than the
/// build compiles these two, and all that they call, with the instructions of that width.
pub trait Register<S: Copy>: Real {
    /// How many numbers a register holds.
    const LANES: usize;

    /// The register with these numbers, lane after lane.
    fn pack(number: impl FnMut(usize) -> S) -> Self;

    /// The numbers of a register.
    fn lanes(&self) -> &[S];

    /// The vectors of one group, of `each` entries, from an array in row order. The last state fills lanes without a state.
    fn load_rows(array: &[S], each: usize, group: usize, buffer: &mut [Self]);

    /// [`Register::load_rows`] as a part of its caller.
    fn load_rows_inlined(array: &[S], each: usize, group: usize, buffer: &mut [Self]);

    /// Writes the results of one group to its part of an array in row order.
    fn store_rows(results: &[Self], part: &mut [S]);

    /// [`Register::store_rows`] as a part of its caller.
    fn store_rows_inlined(results: &[Self], part: &mut [S]);

    /// The vectors of one group, of `each` entries, from an array in lane order. What is not of this register's type is copied to `buffer`.
    fn load_lanes<'a>(array: &'a [S::Lanes], each: usize, group: usize, buffer: &'a mut [Self]) -> &'a [Self]
    where
        S: Number;

    /// Writes the results of one group to its part of an array in lane order.
    fn store_lanes(results: &[Self], part: &mut [S::Lanes])
    where
        S: Number;

    /// Whether all numbers in all lanes are finite.
    fn are_finite(registers: &[Self]) -> bool;

    /// A model with the same number in all lanes.
    fn lift(model: &Model<S>) -> Model<Self>;

    /// Does some work with the instructions of this width.
    fn with_instructions<R>(work: impl FnOnce() -> R) -> R;

    /// Runs a kernel on a group whose states have one model.
    fn run<'w, K: Inlined<N>, const N: usize>(
        workspace: &'w mut Workspace<Self>,
        model: &Model<S>,
        inputs: [&[Self]; N],
        wrenches: Option<&[Force<Self>]>,
    ) -> (&'w [Self], Result<(), Error>);

    /// Runs a kernel on a group each of whose states has its own model.
    fn run_each<'w, K: Inlined<N>, const N: usize>(
        workspace: &'w mut Workspace<Self>,
        model: &Model<Self>,
        inputs: [&[Self]; N],
        wrenches: Option<&[Force<Self>]>,
    ) -> (&'w [Self], Result<(), Error>);
}

/// The first entries of the squares of numbers that cover a vector of `each` entries. A square has `side` entries of `side` states, and is
/// transposed in registers. The last one overlaps the one before it where it must.
#[inline(always)]
pub(super) fn squares(each: usize, side: usize) -> impl Iterator<Item = usize> {
    let last = each.checked_sub(side);
    (0..each.next_multiple_of(side)).step_by(side).filter_map(move |entry| Some(entry.min(last?)))
}

/// The entries of a vector that is too short for a square.
#[inline(always)]
pub(super) fn rest(each: usize, side: usize) -> std::ops::Range<usize> {
    if each < side { 0..each } else { 0..0 }
}

/// The methods of [`Register`] that are one text for all registers of `$count` numbers. A square has `$side` by `$side` numbers.
macro_rules! methods_of_register {
    ($scalar:ident, $count:literal, $square:path, $side:literal) => {
        const LANES: usize = $count;

        #[inline(always)]
        fn pack(number: impl FnMut(usize) -> $scalar) -> Self {
            Self::new(std::array::from_fn(number))
        }

        #[inline(always)]
        fn lanes(&self) -> &[$scalar] {
            self.as_array()
        }

        fn lift(model: &featherbench_model::Model<$scalar>) -> featherbench_model::Model<Self> {
            model.lift()
        }

        #[inline(always)]
        fn load_rows_inlined(array: &[$scalar], each: usize, group: usize, buffer: &mut [Self]) {
            let rows = &array[group * each * $count..];
            let rows = &rows[..rows.len().min(each * $count)];
            let last = (rows.len() / each.max(1)).saturating_sub(1);
            let mut lanes = [&rows[..0]; $count];
            for (lane, row) in lanes.iter_mut().enumerate() {
                *row = &rows[lane.min(last) * each..][..buffer.len()];
            }
            let rows = lanes;
            for entry in $crate::batch::register::squares(each, $side) {
                let mut columns = [[<$square as featherbench_spatial::Real>::zero(); $side]; $count / $side];
                for (columns, rows) in columns.iter_mut().zip(rows.as_chunks::<$side>().0) {
                    for (column, row) in columns.iter_mut().zip(rows) {
                        *column = <$square>::new(*row[entry..].first_chunk().expect("a row of the square"));
                    }
                    *columns = <$square>::transpose(*columns);
                }
                for (k, register) in buffer[entry..][..$side].iter_mut().enumerate() {
                    let mut lanes = [[0.0; $side]; $count / $side];
                    for (lanes, columns) in lanes.iter_mut().zip(&columns) {
                        *lanes = *columns[k].as_array();
                    }
                    *register = Self::new(*lanes.as_flattened().first_chunk().expect("all lanes"));
                }
            }
            for entry in $crate::batch::register::rest(each, $side) {
                buffer[entry] = Self::new(std::array::from_fn(|lane| rows[lane][entry]));
            }
        }

        #[inline(always)]
        fn store_rows_inlined(results: &[Self], part: &mut [$scalar]) {
            let each = results.len();
            let states = part.len() / each.max(1);
            for entry in $crate::batch::register::squares(each, $side) {
                for (block, part) in part.chunks_mut(each * $side).enumerate() {
                    let mut columns = [<$square as featherbench_spatial::Real>::zero(); $side];
                    for (column, result) in columns.iter_mut().zip(&results[entry..]) {
                        *column = <$square>::new(*result.as_array()[block * $side..].first_chunk().expect("a row of the square"));
                    }
                    let columns = <$square>::transpose(columns);
                    for (state, column) in part.chunks_exact_mut(each).zip(&columns) {
                        state[entry..][..$side].copy_from_slice(column.as_array());
                    }
                }
            }
            for entry in $crate::batch::register::rest(each, $side) {
                for (lane, number) in results[entry].as_array().iter().enumerate().take(states) {
                    part[lane * each + entry] = *number;
                }
            }
        }
    };
}
pub(super) use methods_of_register;

/// [`Register::run`] and [`Register::run_each`], each a function with these attributes.
macro_rules! kernels_of_register {
    ($scalar:ident, $apart:ident) => {
        #[inline(always)]
        fn run<'w, K: $crate::batch::kernels::Inlined<N>, const N: usize>(
            workspace: &'w mut $crate::batch::kernels::Workspace<Self>,
            model: &featherbench_model::Model<$scalar>,
            inputs: [&[Self]; N],
            wrenches: Option<&[featherbench_spatial::Force<Self>]>,
        ) -> (&'w [Self], Result<(), $crate::Error>) {
            $apart::<K, Self, $scalar, N>(workspace, model, inputs, wrenches)
        }

        #[inline(always)]
        fn run_each<'w, K: $crate::batch::kernels::Inlined<N>, const N: usize>(
            workspace: &'w mut $crate::batch::kernels::Workspace<Self>,
            model: &featherbench_model::Model<Self>,
            inputs: [&[Self]; N],
            wrenches: Option<&[featherbench_spatial::Force<Self>]>,
        ) -> (&'w [Self], Result<(), $crate::Error>) {
            $apart::<K, Self, Self, N>(workspace, model, inputs, wrenches)
        }
    };
}
pub(super) use kernels_of_register;
