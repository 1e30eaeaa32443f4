//! Blocks of rows for the kernels in registers, and straight-line code for their triangles.

use super::bushy;
use super::registers::LANES;
use crate::TreeSparse;
use crate::tree_sparse::Row;
use featherbench_spatial::Real;

/// Consecutive dofs, each the only child of the one before it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    /// The first dof.
    pub(crate) first: usize,
    /// How many dofs.
    pub(crate) size: usize,
    /// The strict ancestors of the first dof.
    pub(crate) shared: usize,
    /// One past the last dof that the block supports.
    pub(crate) end: usize,
    /// Where the row of that last dof ends.
    pub(crate) stored_end: usize,
}

impl Block {
    /// Whether it is one dof with nothing above it and nothing below.
    #[inline(always)]
    pub(super) fn alone(&self) -> bool {
        self.size == 1 && self.shared == 0 && self.first + self.size == self.end
    }
}

/// What is known from the topology.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// From the root.
    pub(crate) blocks: Vec<Block>,
    size: usize,
    /// The stored numbers.
    stored: usize,
    /// The length of the longest row.
    pub(super) deepest: usize,
    /// What goes a dof at a time.
    pub(crate) single: Single,
}

impl Plan {
    pub(super) fn new<T: Real>(matrix: &TreeSparse<T>) -> Self {
        let size = matrix.size();
        let blocks = blocks(matrix);
        let deepest = (0..size).map(|dof| matrix.depth(dof)).max().unwrap_or(0);
        let single = Single::of(deepest, size, blocks.len());
        Self { blocks, size, stored: matrix.values().len(), deepest, single }
    }

    /// How many numbers the factorization needs beside the matrix.
    pub(super) fn scratch(&self) -> usize {
        let factors = if self.single.factor { self.stored + LANES } else { 0 };
        factors.max(LANES * self.size)
    }

    /// Whether registers loaded from any row but the last end within the inverse, or none is loaded.
    pub(super) fn inverse_fits(&self) -> bool {
        self.size >= LANES || self.blocks.len() == 1
    }
}

/// What goes a dof at a time: a factorization, and the parts of a solution.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Single {
    pub(crate) factor: bool,
    pub(super) from_leaves: bool,
    pub(super) from_root: bool,
}

impl Single {
    /// By the dofs per block: 1 on a binary tree, about 2 on a random tree, 2.5 on a centipede. The limits 3/2 and 5/2 come from measurements:
    /// `docs/kernels/ltdl.md`.
    fn of(deepest: usize, size: usize, blocks: usize) -> Self {
        let short = (2..=bushy::LONGEST).contains(&deepest);
        Self {
            factor: short && deepest <= bushy::DEEPEST && size <= bushy::MOST && 2 * size < 3 * blocks,
            from_leaves: short && 2 * size < 3 * blocks,
            from_root: short && 2 * size < 5 * blocks,
        }
    }
}

/// The most rows in a block of a long run: their sums fill the registers, of which AVX-512 has twice as many of twice the size.
const MOST: usize = if cfg!(target_feature = "avx512f") { 8 } else { 4 };

/// Runs of more dofs are long.
const LONG: usize = 64;

/// The size of the next block of a run of which `rest` dofs are left.
///
/// A short run is one block: what its pivots wait for is all in registers. In a run of medium length smaller blocks overlap better while
/// pivots wait for each other (`docs/kernels/ltdl.md`).
fn size(rest: usize) -> usize {
    if rest <= LANES {
        rest
    } else if rest <= LONG {
        rest.div_ceil(rest.div_ceil(MOST.min(6)))
    } else {
        MOST
    }
}

/// The blocks of a topology, from the root.
fn blocks<T: Real>(matrix: &TreeSparse<T>) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut next = matrix.size();
    while next > 0 {
        let end = matrix.supported(next - 1).end;
        let joins = |&first: &usize| matrix.continues(first) && matrix.supported(first - 1).end == end;
        let rest = 1 + (1..next).rev().take(LONG).take_while(joins).count();
        let size = size(rest);
        let first = next - size;
        blocks.push(Block { first, size, shared: matrix.depth(first) - 1, end, stored_end: matrix.row(end - 1).end });
        next = first;
    }
    blocks.reverse();
    blocks
}

/// Calls a function with the size of a block as a constant.
macro_rules! by_size {
    ($size:expr, $function:ident($($argument:expr),+)) => {
        match $size {
            1 => $function::<1>($($argument),+),
            2 => $function::<2>($($argument),+),
            3 => $function::<3>($($argument),+),
            4 => $function::<4>($($argument),+),
            5 => $function::<5>($($argument),+),
            6 => $function::<6>($($argument),+),
            7 => $function::<7>($($argument),+),
            _ => $function::<8>($($argument),+),
        }
    };
}

/// Repeats statements for each index below a constant, or up to one, as straight-line code. Loops over triangles would stay loops.
macro_rules! up {
    ($index:ident < $count:ident $body:block) => {
        $crate::ltdl::blocks::repeat!($index, $count, $body, 0 1 2 3 4 5 6 7)
    };
    ($index:ident <= $last:ident $body:block) => {
        $crate::ltdl::blocks::repeat!($index, $last + 1, $body, 0 1 2 3 4 5 6 7)
    };
}
/// The same, downwards.
macro_rules! down {
    ($index:ident < $count:ident $body:block) => {
        $crate::ltdl::blocks::repeat!($index, $count, $body, 7 6 5 4 3 2 1 0)
    };
}
/// The body of both.
macro_rules! repeat {
    ($index:ident, $count:expr, $body:block, $($value:literal)+) => {
        $(
            if $value < $count {
                #[allow(non_upper_case_globals, reason = "it is written as an index")]
                const $index: usize = $value;
                $body
            }
        )+
    };
}
pub(super) use {by_size, down, repeat, up};

/// Where the rows of a block begin.
#[inline(always)]
pub(super) fn starts<const SIZE: usize>(rows: &[Row], block: &Block) -> [usize; SIZE] {
    let start = rows[block.first].start;
    std::array::from_fn(|a| start + a * (block.shared + 1) + a * a.saturating_sub(1) / 2)
}

/// The triangle of a block of factors, D on its diagonal.
#[inline(always)]
pub(super) fn triangle<const SIZE: usize>(values: &[f64], starts: &[usize; SIZE], shared: usize) -> [[f64; LANES]; SIZE] {
    let mut triangle = [[0.0; LANES]; SIZE];
    up!(a < SIZE {
        let row: &[f64; a + 1] = values[starts[a] + shared..].first_chunk().expect("a row");
        triangle[a][..a + 1].copy_from_slice(row);
    });
    triangle
}
