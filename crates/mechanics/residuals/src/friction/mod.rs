//! Friction of the joints, per dof. All oppose the motion: vᵀr ≥ 0.
//!
//! | residual | r of a dof |
//! |---|---|
//! | [`Viscous`] | B v |
//! | [`SmoothCoulomb`] | F tanh(v / w) |
//! | [`Stribeck`] | (F + (S − F) exp(−(v / u)²)) tanh(v / w) + B v |
//! | [`DryFriction`] | F Sgn(v), an interval at rest |

mod coulomb;
mod dry;
mod stribeck;
mod viscous;

pub use coulomb::SmoothCoulomb;
pub use dry::{DryFriction, Forces};
pub use stribeck::Stribeck;
pub use viscous::Viscous;
