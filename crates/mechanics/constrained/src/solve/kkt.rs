//! The KKT equations by sparse factors: M by the tree, the Schur complement in factored form.
//!
//! Computes, with `M = RᵀR` and `Y = R⁻ᵀ Jᵀ`:
//!
//! ```text
//! [M  Jᵀ]   [Rᵀ   0] [1   0 ] [R  Y]
//! [J  0 ] = [Yᵀ   1] [0 −YᵀY] [0  1]        v̇ = R⁻¹ (R⁻ᵀ(τ − h) + z),   z the shortest with Yᵀ z = b − Yᵀ R⁻ᵀ (τ − h),   Y λ = z
//! ```
//!
//! YᵀY is never formed: Y gets an orthogonal factorization with column pivots, so κ(J) enters once and not squared. The rank is the number
//! of rows whose rest is longer than `tolerance` times the longest row, in the metric of M⁻¹.
//! Source: J. Carpentier, R. Budhiraja and N. Mansard, *Proximal and sparse resolution of constrained dynamic equations* (RSS 2021),
//! for the sparse factors; Å. Björck, *Numerical Methods for Least Squares Problems* (1996), for the orthogonal ones.
//! Cost: that of the factors of M, D1 per row, and 2 n m r for rank r. It allocates.

use super::rank::Revealed;
use super::{Equations, Method, Solution, check_tolerance};
use crate::delassus::half_solved;
use crate::error::Error;
use featherbench_dynamics::Ltdl;

/// The direct method on the KKT equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kkt {
    /// What a row's rest may be of the longest row, and count as none.
    pub tolerance: f64,
}

impl Default for Kkt {
    /// 10⁻¹⁰: rounding leaves 10⁻¹⁶·κ(M)^½ of a dependent row, and less than 10⁻¹⁰ of a loop is within its tolerance.
    fn default() -> Self {
        Self { tolerance: 1e-10 }
    }
}

impl Method for Kkt {
    fn name(&self) -> &'static str {
        "kkt"
    }

    fn solve(&self, equations: &Equations<'_>) -> Result<Solution, Error> {
        check_tolerance("tolerance of the KKT method", self.tolerance)?;
        let mut factors = Ltdl::new(&equations.model.topology);
        factors.run(equations.mass)?;
        let half = half_solved(equations.rows.jacobian(), &factors)?;
        let revealed = Revealed::of(half, self.tolerance);
        let free = factors.applied(Ltdl::solve, equations.force)?;
        let z = revealed.shortest(&equations.shortfall(&free)?);
        let multipliers = revealed.multipliers(&z);
        let change = factors.applied(Ltdl::solve_root, z.as_slice())?;
        let acceleration = free.iter().zip(change).map(|(free, change)| free + change).collect();
        let solution = equations.judged(acceleration, multipliers)?;
        equations.consistent(solution, &free, revealed.rank())
    }
}
