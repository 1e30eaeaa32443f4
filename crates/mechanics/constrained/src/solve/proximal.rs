//! The proximal method: a regularised Delassus matrix, iterated until the regularisation has no effect.
//!
//! Computes, with `G = J M⁻¹ Jᵀ` and `c = b − J M⁻¹ (τ − h)`, from λ = 0:
//!
//! ```text
//! (G + μ 1) λ' = c + μ λ        the rest c − G λ' = μ (λ' − λ) falls by μ / (μ + σ) along an eigenvector of G with eigenvalue σ
//! ```
//!
//! Of consistent rows the limit solves the equations, and λ is the shortest. Of inconsistent ones the rest tends to what G cannot reach: v̇
//! is the least-squares answer. μ is given as a share of the largest diagonal entry of G, and reported as it was.
//!
//! Source: J. Carpentier, R. Budhiraja and N. Mansard, *Proximal and sparse resolution of constrained dynamic equations* (RSS 2021).
//! Cost: that of G, m³/6, and m² per iteration. It allocates.

use super::{Equations, Method, Outcome, Solution, check_tolerance};
use crate::delassus::by_factors;
use crate::error::Error;
use featherbench_dynamics::Ltdl;
use featherbench_spatial::largest;
use nalgebra::{Cholesky, DVector};

/// What G may make of a rest, of its own size, so that no multiplier reduces the rest: rounding leaves ε/μ = 10⁻¹⁰ of it, and some more
/// where λ has grown.
const UNREACHABLE: f64 = 1e-8;

/// The proximal method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proximal {
    /// μ as a share of the largest diagonal entry of G; positive.
    pub mu: f64,
    /// What a residual may be of the size of the terms of a row.
    pub tolerance: f64,
    /// The most iterations.
    pub iterations: usize,
}

impl Default for Proximal {
    /// μ = 10⁻⁶, a tolerance of 10⁻¹¹ and 100 iterations: two of them where σ > 10⁻³ of the largest entry. A smaller μ would cost digits
    /// where rows are redundant: ε/μ of λ.
    fn default() -> Self {
        Self { mu: 1e-6, tolerance: 1e-11, iterations: 100 }
    }
}

impl Method for Proximal {
    fn name(&self) -> &'static str {
        "proximal"
    }

    fn solve(&self, equations: &Equations<'_>) -> Result<Solution, Error> {
        check_tolerance("tolerance of the proximal method", self.tolerance)?;
        let positive = self.mu.is_finite() && self.mu > 0.0;
        if !positive {
            return Err(Error::Parameter { parameter: "mu", value: self.mu, demand: "it must be positive and finite" });
        }
        let mut factors = Ltdl::new(&equations.model.topology);
        factors.run(equations.mass)?;
        let free = factors.applied(Ltdl::solve, equations.force)?;
        let g = by_factors(equations.rows.jacobian(), &factors)?;
        let c = DVector::from_vec(equations.shortfall(&free)?);
        let peak = largest((0..c.len()).map(|k| g[(k, k)]));
        // Without rows, or with rows of zeros only, any μ does.
        let mu = if peak > 0.0 { self.mu * peak } else { self.mu };
        let mut regular = g.clone();
        (0..c.len()).for_each(|k| regular[(k, k)] += mu);
        let Some(regular) = Cholesky::new(regular) else {
            return Err(Error::Parameter { parameter: "mu", value: self.mu, demand: "it must be large against the rounding of G" });
        };

        let scale = equations.scale(&free, &free);
        let mut lambda = DVector::zeros(c.len());
        let mut rest = c.clone();
        let (mut outcome, mut iterations) = (if c.amax() <= self.tolerance * scale { Outcome::Solved } else { Outcome::CapReached }, 0);
        while outcome == Outcome::CapReached && iterations < self.iterations {
            iterations += 1;
            // λ' − λ = (G + μ)⁻¹ (c − G λ)
            lambda += regular.solve(&rest);
            rest = &c - &g * &lambda;
            if rest.amax() <= self.tolerance * scale {
                outcome = Outcome::Solved;
            } else if (&g * &rest).amax() <= UNREACHABLE * peak * rest.amax() {
                outcome = Outcome::LeastSquares;
            }
        }
        let force = equations.constraint_force(lambda.as_slice());
        let change = factors.applied(Ltdl::solve, &force)?;
        let acceleration = free.iter().zip(change).map(|(free, change)| free + change).collect();
        let solution = equations.judged(acceleration, lambda.as_slice().to_vec())?;
        Ok(Solution { outcome, iterations, mu: Some(mu), ..solution })
    }
}
