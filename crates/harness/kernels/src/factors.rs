//! Factors and solutions of many mass matrices at once: a state per lane of a register, on one core.
//!
//! The matrices were made before, in lane order, as [`Batch::mass_matrix`](featherbench_dynamics::Batch::mass_matrix) leaves them there. So
//! nothing is brought into lanes, and results stay in lanes: these are inputs and results of other batched kernels.

use crate::kernel::{Evaluate, Failure, Kernel, matrices};
use featherbench_bench::NoAnswer;
use featherbench_dynamics::{Ltdl, Number, TreeSparse};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::Real;

/// A register of states.
type Lanes = <f64 as Number>::Lanes;
/// The states of a group.
const LANES: usize = <f64 as Number>::LANES;
/// Groups of a call: a call costs some ten nanoseconds, a group of a small robot some fifty.
const GROUPS: usize = 4;

/// Groups of matrices, or of factors with right-hand sides.
struct Grouped {
    ltdl: Ltdl<Lanes>,
    /// The matrix of each group, or its factors. Of the last group those lanes without a state are the first states.
    groups: Vec<TreeSparse<Lanes>>,
    /// The right-hand sides of each group, if it solves.
    sides: Option<Vec<Vec<Lanes>>>,
    /// The last solution.
    x: Vec<Lanes>,
    /// States whose matrices are kept.
    states: usize,
}

/// The batched kernel of `factorization`.
pub(crate) fn factorization<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    Ok(Box::new(Grouped::new(model, states)?))
}

/// The batched kernel of `solve`.
pub(crate) fn solve<'a>(model: &'a Model<f64>, states: &'a StateBatch) -> Result<Kernel<'a>, NoAnswer> {
    let mut grouped = Grouped::new(model, states)?;
    let nv = model.topology.nv();
    let side = |group: usize| -> Vec<Lanes> {
        (0..nv).map(|dof| f64::pack(|lane| states.tau((group * LANES + lane) % grouped.states)[dof])).collect()
    };
    let sides = (0..grouped.groups.len()).map(side).collect();
    for group in &mut grouped.groups {
        grouped.ltdl.matrix_mut().values_mut().copy_from_slice(group.values());
        grouped.ltdl.factor().map_err(|error| NoAnswer::Failed(error.to_string()))?;
        group.values_mut().copy_from_slice(grouped.ltdl.factors().values());
    }
    grouped.sides = Some(sides);
    Ok(Box::new(grouped))
}

impl Grouped {
    fn new(model: &Model<f64>, states: &StateBatch) -> Result<Self, NoAnswer> {
        let rows = matrices(model, states)?;
        let group = |first: usize| {
            let mut group = TreeSparse::new(&model.topology);
            for (entry, value) in group.values_mut().iter_mut().enumerate() {
                *value = f64::pack(|lane| rows[(first + lane) % rows.len()][entry]);
            }
            group
        };
        let groups = (0..rows.len()).step_by(LANES).map(group).collect();
        let x = vec![Lanes::zero(); model.topology.nv()];
        Ok(Self { ltdl: Ltdl::new(&model.topology), groups, sides: None, x, states: rows.len() })
    }

    fn run_group(&mut self, group: usize) -> Result<(), Failure> {
        let Self { ltdl, groups, sides, x, .. } = self;
        match sides {
            None => {
                ltdl.matrix_mut().values_mut().copy_from_slice(groups[group].values());
                ltdl.factor()?;
            }
            Some(sides) => {
                x.copy_from_slice(&sides[group]);
                ltdl.matrix_mut().exchange(&mut groups[group])?;
                let solved = ltdl.solve(x);
                ltdl.matrix_mut().exchange(&mut groups[group])?;
                solved?;
            }
        }
        Ok(())
    }
}

impl Evaluate for Grouped {
    /// Alone, as copies of itself in all lanes: no other state's failure is this one's.
    fn evaluate(&mut self, k: usize) -> Result<(), Failure> {
        let (group, lane) = (k % self.states / LANES, k % self.states % LANES);
        let copies = |lanes: &[Lanes]| -> Vec<Lanes> { lanes.iter().map(|x| f64::pack(|_| f64::lanes(x)[lane])).collect() };
        self.ltdl.matrix_mut().values_mut().copy_from_slice(&copies(self.groups[group].values()));
        match &self.sides {
            None => self.ltdl.factor()?,
            Some(sides) => {
                self.x.copy_from_slice(&copies(&sides[group]));
                self.ltdl.solve(&mut self.x)?;
            }
        }
        Ok(())
    }

    fn together(&self) -> usize {
        GROUPS * LANES
    }

    fn sweep(&mut self, k: usize) -> Result<(), Failure> {
        let first = k % self.states / LANES;
        (0..GROUPS).try_for_each(|group| self.run_group((first + group) % self.groups.len()))
    }

    fn read(&self, out: &mut [f64]) {
        let from = if self.sides.is_some() { &self.x } else { self.ltdl.factors().values() };
        out.iter_mut().zip(from).for_each(|(out, x)| *out = x.min_lane());
    }
}
