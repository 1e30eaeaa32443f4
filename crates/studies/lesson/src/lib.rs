//! A course's lesson on open problems of robot models, as claims that a program decides.
//!
//! - [`claims`] has each lab and problem of the lesson: what it says, what is right, and the number that separates them. Every right number
//!   has a second route: a closed form, extended precision, dual numbers or another formulation.
//! - [`Algebra`] is a small store of expressions: derivatives, values in any scalar, and source text in Rust, C and Python.
//! - [`Equations`] are the equations of motion of a Lagrangian; [`arm`] has those of the lesson's planar arm.
//! - [`pipeline`] generates a robot and models it in stages.
//!
//! Conventions: SI units; r is what the true robot has and the nominal one lacks, `true = nominal + r`, so the lesson's d is −r.

mod algebra;
pub mod arm;
mod claim;
pub mod claims;
mod lagrange;
pub mod pipeline;
mod quadrature;

pub use algebra::{Algebra, AlgebraError, Expression, Language};
pub use claim::{Claim, Failure, Holds, Number, Stated};
pub use lagrange::Equations;
pub use quadrature::Rule;
