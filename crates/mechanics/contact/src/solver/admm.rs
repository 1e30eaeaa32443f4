//! The alternating direction method of multipliers on Coulomb's law, with De Saxcé's term as in a fixed point.
//!
//! Source: J. Carpentier, Q. Le Lidec and L. Montaut, *From compliant to rigid contact simulation: a unified and efficient approach*
//! (arXiv 2405.17020). One iteration:
//!
//! ```text
//! x = (A + ρ 1)⁻¹ (ρ (z − u) − b − Γ)     z = P_K(x + u)     u ← u + x − z     c = −ρ u     Γ = ‖c_t‖ e_n
//! ```
//!
//! While all contacts stay inside their cones it is a proximal-point iteration, and the error falls by ρ/(ρ + λ_min(A)).

use super::standard::Standard;
use super::{Solver, Unsupported, positive};
use crate::cones;
use crate::problem::Problem;
use crate::solution::{Outcome, Solution};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// ADMM. One factorization, then O(rows²) per iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Admm {
    /// ρ, in units of the largest diagonal entry of G. Without it √(λ_min λ_max), λ_min the smallest eigenvalue of the scaled matrix above
    /// 1e-8 of the largest.
    pub rho: Option<f64>,
    /// The largest natural-map residual of an answer, free of units.
    pub tolerance: f64,
    /// The cap on iterations.
    pub iterations: usize,
}

impl Default for Admm {
    fn default() -> Self {
        Self { rho: None, tolerance: 1e-10, iterations: 100_000 }
    }
}

impl Admm {
    fn chosen(&self, standard: &Standard) -> Result<f64, Unsupported> {
        if let Some(rho) = self.rho {
            positive(self.name(), "rho", rho)?;
            return Ok(rho);
        }
        let eigenvalues = SymmetricEigen::new(standard.matrix.clone()).eigenvalues;
        let largest = eigenvalues.max();
        let smallest = eigenvalues.iter().copied().filter(|value| *value > 1e-8 * largest).fold(largest, |a, b| if b < a { b } else { a });
        Ok(if largest > 0.0 { (smallest * largest).sqrt() } else { 1.0 })
    }
}

impl Solver for Admm {
    fn name(&self) -> &'static str {
        "admm"
    }

    fn solve(&self, problem: &Problem) -> Result<Solution, Unsupported> {
        positive(self.name(), "tolerance", self.tolerance)?;
        let standard = Standard::new(problem, self.name(), false)?;
        let rho = self.chosen(&standard)?;
        let size = standard.size();
        let factor = (&standard.matrix + DMatrix::identity(size, size) * rho).lu();
        let (mut z, mut u, mut gamma) = (DVector::zeros(size), DVector::<f64>::zeros(size), DVector::<f64>::zeros(size));
        let mut steps = Vec::new();
        let mut residual = standard.residual(&z, &standard.velocities(&z));
        while residual > self.tolerance && steps.len() < self.iterations {
            let Some(x) = factor.solve(&((&z - &u) * rho - &standard.free - &gamma)) else { break };
            let mut next = &x + &u;
            for contact in 0..standard.contacts() {
                cones::project(&mut next.as_mut_slice()[standard.range(contact)]);
            }
            u += &x - &next;
            for contact in 0..standard.contacts() {
                let range = standard.range(contact);
                gamma[range.start] = rho * u.rows(range.start + 1, range.len() - 1).norm();
            }
            steps.push((&next - &z).amax());
            z = next;
            residual = standard.residual(&z, &standard.velocities(&z));
        }
        let (iterations, point) = (steps.len(), standard.point(problem, &z));
        let outcome = Outcome::judged(point, residual <= self.tolerance, iterations >= self.iterations);
        Ok(Solution { outcome, iterations, steps })
    }
}
