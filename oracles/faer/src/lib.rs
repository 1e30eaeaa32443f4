//! faer's Cholesky factorizations as an oracle: a library with the C interface of `../../native/oracle.h`.
//!
//! | method | M = L Lᵀ |
//! |---|---|
//! | `sparse_natural` | sparse, in the order of the dofs, root first: a tree's L is full |
//! | `sparse_amd` | sparse, in faer's usual order: approximate minimum degree |
//! | `sparse_leaves_first` | sparse, M is given with the dofs from the last to the first: no order, and no fill-in |
//! | `dense` | dense, in the order of the dofs |
//!
//! All settings are faer's own: where a factor is full enough it chooses supernodes, which it pads with zeros.

mod dense;
mod sparse;

use dense::Dense;
use featherbench_factors::{Factorization, Lower, Robot, Tree};
use featherbench_interface::Refusal;
use sparse::{Order, Sparse};

/// A method.
enum Way {
    Sparse(Box<Sparse>),
    Dense(Dense),
}

impl Factorization for Way {
    const ENGINE: &'static str = "faer";
    const METHODS: &'static [(&'static str, &'static str)] = &[
        ("factorization", "sparse_amd"),
        ("factorization", "sparse_natural"),
        ("factorization", "sparse_leaves_first"),
        ("factorization", "dense"),
        ("solve", "sparse_amd"),
        ("solve", "sparse_natural"),
        ("solve", "sparse_leaves_first"),
        ("solve", "dense"),
        ("factor_entries", "sparse_amd"),
        ("factor_entries", "sparse_natural"),
        ("factor_entries", "sparse_leaves_first"),
        ("factor_entries", "dense"),
    ];
    const REVERSED: &'static [&'static str] = &["sparse_leaves_first"];
    type Factors = Vec<f64>;

    fn new(method: &str, tree: &Tree) -> Result<Self, Refusal> {
        match method {
            "dense" => Dense::new(tree).map(Self::Dense),
            "sparse_amd" => Ok(Self::Sparse(Box::new(Sparse::new(tree, Order::MinimumDegree)?))),
            _ => Ok(Self::Sparse(Box::new(Sparse::new(tree, Order::Given)?))),
        }
    }

    fn entries(&self) -> usize {
        match self {
            Self::Sparse(sparse) => sparse.entries(),
            Self::Dense(dense) => dense.entries(),
        }
    }

    fn numbers(&self) -> usize {
        match self {
            Self::Sparse(sparse) => sparse.numbers(),
            Self::Dense(dense) => dense.numbers(),
        }
    }

    fn form(&self, stored: &[f64]) -> Vec<f64> {
        match self {
            Self::Sparse(sparse) => sparse.form(stored),
            Self::Dense(dense) => dense.form(stored),
        }
    }

    fn room(&self) -> Vec<f64> {
        vec![0.0; self.numbers()]
    }

    fn factorize(&mut self, matrix: &[f64], factors: &mut Vec<f64>) -> Result<(), Refusal> {
        let done = match self {
            Self::Sparse(sparse) => sparse.factorize(matrix, factors),
            Self::Dense(dense) => dense.factorize(matrix, factors),
        };
        done.map_err(|error| Refusal::Failed(format!("faer: {error}")))
    }

    fn solve(&mut self, factors: &Vec<f64>, x: &mut [f64]) {
        match self {
            Self::Sparse(sparse) => sparse.solve(factors, x),
            Self::Dense(dense) => dense.solve(factors, x),
        }
    }

    fn lower(&self, factors: &Vec<f64>) -> Lower {
        match self {
            Self::Sparse(sparse) => sparse.lower(factors),
            Self::Dense(dense) => dense.lower(factors),
        }
    }
}

/// The reason for a robot that is too large.
fn too_large(what: &str, n: usize, numbers: usize) -> Refusal {
    let most = featherbench_factors::MOST;
    Refusal::Unsupported(format!("{what} of {n} degrees of freedom has {numbers} numbers, and {most} are kept here"))
}

featherbench_interface::export!(Robot<Way>);
