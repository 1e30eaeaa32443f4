//! A robot of an engine that factorizes, its states, and the calls that are timed.

use crate::description::{description, read_back};
use crate::{Factorization, Tree};
use featherbench_dynamics::{Crba, TreeSparse};
use featherbench_interface::{self as interface, Given, Refusal};
use featherbench_model::Model;
use std::ops::Range;

/// The most numbers that a matrix and its factors may have: 128 MiB.
pub const MOST: usize = 16 << 20;
/// The numbers of prepared matrices or factors: 32 MiB, as our own kernels keep them. Big robots use a few in turn while they are timed.
const KEPT: usize = 4 << 20;

/// A robot with its states.
pub struct Robot<F: Factorization> {
    model: Model<f64>,
    /// Each method, once it was asked for.
    methods: Vec<Option<F>>,
    /// q and τ, state after state.
    states: [Vec<f64>; 2],
    count: usize,
    /// The state that was evaluated last.
    last: usize,
    ready: Ready<F>,
}

/// The input of a method, and its result.
enum Ready<F: Factorization> {
    Nothing,
    /// Matrices, and room for the factors of the last.
    Factorize(Vec<Vec<f64>>, F::Factors),
    /// Factors, right sides in the order of the tree, and the last solution.
    Solve(Vec<F::Factors>, Vec<f64>, Vec<f64>),
    /// The count.
    Entries(usize),
}

impl<F: Factorization> Robot<F> {
    /// The tree as a method is given it.
    fn tree(&self, method: usize) -> Tree {
        Tree::new(self.model.topology.dof_parents(), F::REVERSED.contains(&F::METHODS[method].1))
    }

    /// Mass matrices of states in the form of a method.
    fn matrices(&self, way: &F, states: Range<usize>) -> Result<Vec<Vec<f64>>, Refusal> {
        let nq = self.model.topology.nq();
        let (mut crba, mut matrix) = (Crba::new(&self.model.topology), TreeSparse::new(&self.model.topology));
        states
            .map(|k| {
                crba.run(&self.model, &self.states[0][k * nq..(k + 1) * nq], &mut matrix)?;
                Ok(way.form(matrix.values()))
            })
            .collect()
    }

    /// Evaluates the last state again with its own matrix, if `run` took that of another state because fewer are kept.
    fn with_own_matrix(&mut self, method: usize) -> Result<(), Refusal> {
        let (kept, last) = (self.ready.kept(), self.last);
        if kept.is_none_or(|kept| last < kept) {
            return Ok(());
        }
        let mut way = self.methods[method].take().ok_or_else(lost)?;
        for matrix in self.matrices(&way, last..last + 1)? {
            match &mut self.ready {
                Ready::Factorize(_, factors) => way.factorize(&matrix, factors)?,
                Ready::Solve(_, right, x) => {
                    let (n, mut factors) = (x.len(), way.room());
                    way.factorize(&matrix, &mut factors)?;
                    x.copy_from_slice(&right[last * n..(last + 1) * n]);
                    way.solve(&factors, x);
                }
                Ready::Entries(_) | Ready::Nothing => {}
            }
        }
        self.methods[method] = Some(way);
        Ok(())
    }
}

impl<F: Factorization> Ready<F> {
    /// The states whose matrices or factors are kept: the first ones.
    fn kept(&self) -> Option<usize> {
        match self {
            Self::Factorize(matrices, _) => Some(matrices.len()),
            Self::Solve(factors, ..) => Some(factors.len()),
            Self::Entries(_) | Self::Nothing => None,
        }
    }
}

/// The states of a range, which begins again beyond the last. No division is timed.
fn cycle(states: usize, first: usize, count: usize) -> impl Iterator<Item = usize> {
    let mut next = first.checked_rem(states).unwrap_or_default();
    (0..count).map(move |_| {
        let k = next;
        next = if k + 1 == states { 0 } else { k + 1 };
        k
    })
}

fn lost() -> Refusal {
    Refusal::Failed("the method was not prepared".into())
}

impl<F: Factorization> interface::Robot for Robot<F> {
    const ENGINE: &'static str = F::ENGINE;
    const METHODS: &'static [(&'static str, &'static str)] = F::METHODS;

    fn new(given: &Given, readback: &mut [f64]) -> Result<Self, Refusal> {
        let model: Model<f64> = Model::build(&description(given)?)?;
        if [model.topology.nq(), model.topology.nv()] != given.sizes {
            return Err(Refusal::Failed("our model counts other degrees of freedom".into()));
        }
        read_back(given.bodies, readback);
        let methods = F::METHODS.iter().map(|_| None).collect();
        Ok(Self { model, methods, states: Default::default(), count: 0, last: 0, ready: Ready::Nothing })
    }

    fn sizes(&self) -> [usize; 2] {
        [self.model.topology.nq(), self.model.topology.nv()]
    }

    fn size(&self, method: usize) -> usize {
        match F::METHODS[method].0 {
            "factorization" => self.model.topology.stored(),
            "solve" => self.model.topology.nv(),
            _ => 1,
        }
    }

    fn convert(&mut self, [q, v, _, tau]: [&[f64]; 4]) -> Result<(), Refusal> {
        self.count = v.len() / self.model.topology.nv().max(1);
        (self.states, self.ready) = ([q.to_vec(), tau.to_vec()], Ready::Nothing);
        Ok(())
    }

    fn ready(&mut self, method: usize, _: usize) -> Result<(), Refusal> {
        let ((quantity, name), tree) = (F::METHODS[method], self.tree(method));
        self.ready = Ready::Nothing;
        let mut way = match self.methods[method].take() {
            Some(way) => way,
            None => F::new(name, &tree)?,
        };
        let kept = self.count.min(1 + KEPT / way.numbers().max(1));
        self.ready = match quantity {
            "factorization" => Ready::Factorize(self.matrices(&way, 0..kept)?, way.room()),
            "solve" => {
                let matrices = self.matrices(&way, 0..kept)?;
                let mut factors = Vec::with_capacity(matrices.len());
                for matrix in matrices {
                    let mut room = way.room();
                    way.factorize(&matrix, &mut room)?;
                    factors.push(room);
                }
                let nv = tree.size();
                let mut right = self.states[1].clone();
                right.chunks_exact_mut(nv.max(1)).for_each(|b| tree.arrange(b));
                Ready::Solve(factors, right, vec![0.0; nv])
            }
            _ => Ready::Entries(way.entries()),
        };
        self.methods[method] = Some(way);
        Ok(())
    }

    fn run(&mut self, method: usize, first: usize, count: usize) -> Result<(), Refusal> {
        let way = self.methods[method].as_mut().ok_or_else(lost)?;
        let states = cycle(self.count, first, count);
        self.last = (first + count.max(1) - 1).checked_rem(self.count).unwrap_or_default();
        match &mut self.ready {
            Ready::Factorize(matrices, factors) => {
                for k in states {
                    way.factorize(&matrices[k % matrices.len()], factors)?;
                }
            }
            Ready::Solve(factors, right, x) => {
                let n = x.len();
                for k in states {
                    x.copy_from_slice(&right[k * n..(k + 1) * n]);
                    way.solve(&factors[k % factors.len()], x);
                }
            }
            Ready::Entries(_) => {}
            Ready::Nothing => return Err(lost()),
        }
        Ok(())
    }

    fn read(&mut self, method: usize, value: &mut [f64]) -> Result<(), Refusal> {
        self.with_own_matrix(method)?;
        let (way, tree) = (self.methods[method].as_ref().ok_or_else(lost)?, self.tree(method));
        match &self.ready {
            Ready::Factorize(_, factors) => {
                let mut lower = way.lower(factors);
                // From the order of the tree to that of the dofs.
                lower.places = (0..tree.size()).map(|dof| lower.places[tree.place(dof)]).collect();
                return lower.neutral(self.model.topology.dof_parents(), value);
            }
            Ready::Solve(_, _, x) => {
                value.copy_from_slice(x);
                tree.arrange(value);
            }
            Ready::Entries(entries) => value[0] = *entries as f64,
            Ready::Nothing => return Err(lost()),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn states_begin_again() {
        assert_eq!(super::cycle(3, 4, 5).collect::<Vec<_>>(), [1, 2, 0, 1, 2]);
        assert_eq!(super::cycle(1, 0, 2).collect::<Vec<_>>(), [0, 0]);
    }
}
