//! The trait [`SemidefiniteSolver`]: an engine that solves least squares under semidefinite conditions. Oracles offer it by the operation
//! `semidefinite_least_squares`.

use crate::NoAnswer;
use std::time::Duration;

/// Minimise ½|A x − b|² while P_i(x) is positive semidefinite for every body i. P_i is an affine map to symmetric 4×4 matrices.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct SemidefiniteProblem {
    /// How many unknowns there are: n.
    pub unknowns: usize,
    /// A, row by row, each row already times its weight.
    pub matrix: Vec<f64>,
    /// b, with the same weights.
    pub target: Vec<f64>,
    /// Of each body 16 rows of n + 1 numbers, one for each entry of the matrix, row by row. The first n are multiplied by x, the last is added.
    pub maps: Vec<f64>,
}

impl SemidefiniteProblem {
    /// How many matrices have to be semidefinite.
    pub fn bodies(&self) -> usize {
        self.maps.len() / (16 * (self.unknowns + 1))
    }
}

/// An answer.
#[derive(Clone, Debug, PartialEq)]
pub struct SemidefiniteSolution {
    /// x.
    pub x: Vec<f64>,
    /// Of each body the 16 numbers of Z ⪰ 0, with Aᵀ(A x − b) = Σ P*(Z).
    pub multipliers: Vec<f64>,
    /// What the engine says.
    pub converged: bool,
    /// The same in its own word.
    pub status: String,
    /// As the engine counts them.
    pub iterations: u64,
    /// The engine's own time.
    pub time: Duration,
}

/// An engine that solves such problems.
pub trait SemidefiniteSolver {
    /// Its methods, the usual one first.
    fn semidefinite_methods(&self) -> Vec<String>;

    /// Solves a problem with the engine's own tolerance and at most so many iterations.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine does not offer the method, or refuses the problem.
    fn semidefinite_least_squares(
        &self,
        problem: &SemidefiniteProblem,
        method: &str,
        tolerance: f64,
        iterations: usize,
    ) -> Result<SemidefiniteSolution, NoAnswer>;
}
