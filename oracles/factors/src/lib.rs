//! Libraries of linear algebra as engines: they have no robots, and factorize mass matrices.
//!
//! A library is a type with the trait [`Factorization`]; [`Robot`] makes an engine of it. M of each state comes from our own kernel
//! `mass_matrix`, to the bit that of [`featherbench_dynamics`], and is made in `ready`: it is neither timed nor judged here. What the library
//! gives is judged: its factors of M, and its solutions of M x = τ.
//!
//! | quantity | timed | outside the time |
//! |---|---|---|
//! | `factorization` | M in the library's own form to factors, in memory that is used again | M; the choice of an order and the pattern of L, once per robot |
//! | `solve` | τ and factors to x, with the copy of τ | M, factors; τ in the order of M |
//! | `factor_entries` | – | the count |
//!
//! Factors are brought to the neutral M = LᵀDL by `neutral.rs`.

mod description;
mod neutral;
mod robot;
mod tree;

pub use neutral::Lower;
pub use robot::{MOST, Robot};
pub use tree::Tree;

use featherbench_interface::Refusal;

/// A method of a library, with what it prepares once for a robot's tree.
///
/// The library is given M in the order of [`Factorization::REVERSED`], and factorizes P M Pᵀ = L Lᵀ with an order P of its own.
pub trait Factorization: Sized + 'static {
    /// The engine's name in rows.
    const ENGINE: &'static str;
    /// What is answered: quantity and method.
    const METHODS: &'static [(&'static str, &'static str)];
    /// The methods that are given M with its dofs from the last to the first.
    const REVERSED: &'static [&'static str];
    /// The factors of a matrix, in the library's own form.
    type Factors;

    /// Prepares a method for the matrices of a tree, whose dofs have the order in which M is given.
    ///
    /// # Errors
    /// [`Refusal::Unsupported`] for a tree that is too large, else [`Refusal::Failed`].
    fn new(method: &str, tree: &Tree) -> Result<Self, Refusal>;

    /// How many numbers of L may differ from zero.
    fn entries(&self) -> usize;

    /// How many numbers a matrix and its factors have in memory.
    fn numbers(&self) -> usize;

    /// The matrix in the library's form, from its stored entries, which [`Tree::entries`] names.
    fn form(&self, stored: &[f64]) -> Vec<f64>;

    /// Room for factors.
    fn room(&self) -> Self::Factors;

    /// Factorizes a matrix: what is timed as `factorization`.
    ///
    /// # Errors
    /// [`Refusal::Failed`] where M is not positive definite.
    fn factorize(&mut self, matrix: &[f64], factors: &mut Self::Factors) -> Result<(), Refusal>;

    /// Solves M x = b: `x` holds b before and the solution afterwards. What is timed as `solve`, with the copy of b.
    fn solve(&mut self, factors: &Self::Factors, x: &mut [f64]);

    /// The numbers of L.
    fn lower(&self, factors: &Self::Factors) -> Lower;
}
