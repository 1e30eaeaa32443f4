//! Projected Gauss–Seidel: contact by contact, the normal row and then the tangent rows.
//!
//! Source: J. J. Moreau 1994; M. Jean, *The non-smooth contact dynamics method* (1999). With frictionless contacts that all stay closed it
//! is the classical Gauss–Seidel method: the error falls by ρ((D + L)⁻¹ U) each sweep, see [`crate::rate::gauss_seidel`].

use super::standard::Standard;
use super::{Solver, Unsupported, positive};
use crate::problem::Problem;
use crate::solution::{Outcome, Solution};
use nalgebra::DVector;

/// Projected Gauss–Seidel. O(rows²) per sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussSeidel {
    /// The largest natural-map residual of an answer, free of units.
    pub tolerance: f64,
    /// The cap on sweeps.
    pub sweeps: usize,
}

impl Default for GaussSeidel {
    fn default() -> Self {
        Self { tolerance: 1e-10, sweeps: 100_000 }
    }
}

impl Solver for GaussSeidel {
    fn name(&self) -> &'static str {
        "gauss_seidel"
    }

    fn solve(&self, problem: &Problem) -> Result<Solution, Unsupported> {
        positive(self.name(), "tolerance", self.tolerance)?;
        let standard = Standard::new(problem, self.name(), true)?;
        let (mut x, mut steps) = (DVector::zeros(standard.size()), Vec::new());
        // Zero is an answer too: contacts that all open.
        let mut residual = standard.residual(&x, &standard.velocities(&x));
        while residual > self.tolerance && steps.len() < self.sweeps {
            steps.push(standard.sweep(&mut x, 0.0));
            residual = standard.residual(&x, &standard.velocities(&x));
        }
        let (iterations, point) = (steps.len(), standard.point(problem, &x));
        let outcome = Outcome::judged(point, residual <= self.tolerance, iterations >= self.sweeps);
        Ok(Solution { outcome, iterations, steps })
    }
}
