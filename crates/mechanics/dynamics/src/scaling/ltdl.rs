//! The factorization `M = LᵀDL` for `f64` on all cores, sub-tree by sub-tree.
//!
//! Source, shapes and units: those of `ltdl.rs`, whose kernel of `ltdl/factor.rs` it calls. The tree is divided by `scaling/mod.rs`. A row of L needs
//! the rows below it only. So the rows of a part are factored by themselves, in a copy with padding, and then the rows of the trunk.
//! Cost: O(Σ d_k²), the operations of [`Ltdl`], and one copy of the rows of the parts each way. Memory beside the matrix: the rows of the largest
//! part of each task, and 144 bytes per dof. Beside what `rayon` allocates, a call allocates one list of slices, with one entry per task.
//! Solutions are those of [`Ltdl`], on one core.

use super::{Part, Plan, Task};
use crate::error::Pivot;
use crate::ltdl::blocks::Block;
use crate::ltdl::factor::factor_blocks;
use crate::ltdl::registers::LANES;
use crate::tree_sparse::{PADDING, Row};
use crate::{Error, Ltdl, NotPositiveDefinite, TreeSparse};
use featherbench_model::Topology;
use rayon::prelude::*;
use std::ops::Range;

/// The workspace of the factorization on all cores. Its factors are those of [`Ltdl`] to the bit.
///
/// It uses the threads of the current pool of `rayon`. It pays where the tree branches and has some thousand dofs or more.
///
/// ```
/// use featherbench_dynamics::{ParallelLtdl, mass_matrix};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("binary_tree:depth=10")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 1);
/// let matrix = mass_matrix(&model, states.q(0))?;
///
/// let mut parallel = ParallelLtdl::new(&model.topology);
/// parallel.run(&matrix)?;
/// let mut x = states.tau(0).to_vec();
/// parallel.factors().solve(&mut x)?;
///
/// assert_eq!(parallel.factors().factors(), matrix.into_ltdl()?.factors());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ParallelLtdl {
    ltdl: Ltdl<f64>,
    plan: Plan,
    parts: Vec<Rows>,
    /// Per task: the numbers of one part with padding, and what the kernel needs beside them.
    copies: Vec<(Vec<f64>, Vec<[f64; LANES]>)>,
    /// The blocks of the trunk.
    trunk: Vec<Block>,
}

/// The rows of a part, with places counted from its first dof and its first number.
#[derive(Clone, Debug)]
struct Rows {
    rows: Vec<Row>,
    blocks: Vec<Block>,
    /// Where its numbers stand in the flat array.
    numbers: Range<usize>,
}

impl ParallelLtdl {
    /// A workspace for the factors of a matrix of this topology.
    pub fn new(topology: &Topology) -> Self {
        let plan = Plan::new(topology, |depth| depth * depth);
        let ltdl = Ltdl::new(topology);
        let (rows, blocks) = (ltdl.matrix.parts().0, &ltdl.plan.blocks);
        let parts: Vec<Rows> = plan.parts.iter().map(|part| Rows::new(part, &ltdl.matrix, rows, blocks)).collect();
        let copies = plan.tasks.iter().map(|task| {
            let (numbers, dofs) = parts[task.parts.clone()]
                .iter()
                .fold((0, 0), |(numbers, dofs), part| (numbers.max(part.numbers.len()), dofs.max(part.rows.len())));
            (vec![0.0; numbers + PADDING], vec![[0.0; LANES]; dofs])
        });
        let copies = copies.collect();
        let in_part = |block: &&Block| {
            let behind = plan.parts.partition_point(|part| part.dofs.start <= block.first);
            behind > 0 && plan.parts[behind - 1].dofs.contains(&block.first)
        };
        let trunk = blocks.iter().filter(|block| !in_part(block)).copied().collect();
        Self { copies, trunk, parts, plan, ltdl }
    }

    /// Factors a matrix.
    ///
    /// # Errors
    /// [`Error`] when the matrix has another topology, or a pivot is not positive; the factors then mean nothing.
    pub fn run(&mut self, matrix: &TreeSparse<f64>) -> Result<(), Error> {
        if self.ltdl.plan.single.factor {
            return self.ltdl.run(matrix);
        }
        self.ltdl.matrix.expect_same_tree(matrix)?;
        let source = matrix.values();
        let (rows, values) = self.ltdl.matrix.parts_mut();
        for block in &self.trunk {
            let last = block.first + block.size - 1;
            let numbers = rows[block.first].start..rows[last].start + block.shared + block.size;
            values[numbers.clone()].copy_from_slice(&source[numbers]);
        }
        Ok(self.factor_of(Some(source))?)
    }

    /// The matrix that [`ParallelLtdl::factor`] overwrites with its factors.
    pub fn matrix_mut(&mut self) -> &mut TreeSparse<f64> {
        &mut self.ltdl.matrix
    }

    /// Factors the matrix that was written to [`ParallelLtdl::matrix_mut`], in place.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] when a pivot is not positive; the factors then mean nothing.
    pub fn factor(&mut self) -> Result<(), NotPositiveDefinite> {
        if self.ltdl.plan.single.factor { self.ltdl.factor() } else { self.factor_of(None) }
    }

    /// Factors these numbers, or those of the matrix. The rows of the trunk are always those of the matrix.
    fn factor_of(&mut self, source: Option<&[f64]>) -> Result<(), NotPositiveDefinite> {
        let Self { ltdl, plan, parts, copies, trunk } = self;
        let (rows, values) = ltdl.matrix.parts_mut();
        let numbers = |task: &Task| {
            let (first, last) = (&parts[task.parts.start], &parts[task.parts.end - 1]);
            first.numbers.start..last.numbers.end
        };
        let slices = plan.divide(values, numbers);
        let tasks = plan.tasks.par_iter().zip(slices).zip(copies);
        let in_parts = tasks.map(|((task, values), (copy, coefficients))| {
            let start = numbers(task).start;
            let mut smallest = Pivot::none();
            for (part, place) in parts[task.parts.clone()].iter().zip(&plan.parts[task.parts.clone()]) {
                let values = &mut values[part.numbers.start - start..][..part.numbers.len()];
                let given = source.map_or(&*values, |source| &source[part.numbers.clone()]);
                copy[..given.len()].copy_from_slice(given);
                let found = factor_blocks(&part.rows, copy, &part.blocks, &mut coefficients[..part.rows.len()]);
                values.copy_from_slice(&copy[..values.len()]);
                smallest = smallest.leaves_first(found.behind(place.dofs.start));
            }
            smallest
        });
        let smallest = in_parts.reduce(Pivot::none, Pivot::leaves_first);
        let in_trunk = factor_blocks(rows, values, trunk, ltdl.scratch.as_chunks_mut().0);
        smallest.leaves_first(in_trunk).check()
    }

    /// The factors, which solve and invert.
    pub fn factors(&self) -> &Ltdl<f64> {
        &self.ltdl
    }
}

impl Rows {
    fn new(part: &Part, matrix: &TreeSparse<f64>, rows: &[Row], blocks: &[Block]) -> Self {
        let (dofs, first) = (part.dofs.clone(), part.dofs.start);
        let numbers = rows[first].start..matrix.row(dofs.end - 1).end;
        let from = blocks.partition_point(|block| block.first < first);
        let to = blocks.partition_point(|block| block.first < dofs.end);
        let moved = |block: &Block| Block {
            first: block.first - first,
            end: block.end - first,
            stored_end: block.stored_end - numbers.start,
            ..*block
        };
        Self {
            rows: rows[dofs].iter().map(|row| row.counted_from(numbers.start)).collect(),
            blocks: blocks[from..to].iter().map(moved).collect(),
            numbers,
        }
    }
}
