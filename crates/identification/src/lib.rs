//! Identification of robots: which parameters the torques depend on, what a log says of them, and how well.
//!
//! The torques are linear in the unknowns θ ([`LinearModel`]). Only combinations of these have an effect: the base parameters ([`Base`]).
//!
//! - `linear.rs`, `unknowns.rs`: the regressor with the columns of armature, friction and offset;
//! - `information.rs`: stacked equations in triangular form;
//! - `base.rs`: rank and base parameters;
//! - `arms.rs`: arms whose ranks are known;
//! - `pseudo.rs`, `log_cholesky.rs`: which parameters a body can have;
//! - `excitation.rs`: trajectories that tell much;
//! - `estimate/`: least squares, consistent estimates, residuals;

mod arms;
mod base;
mod error;
mod estimate;
mod excitation;
mod information;
mod linear;
mod log_cholesky;
mod pseudo;
mod samples;
mod unknowns;

pub use arms::{Arm, Gravity};
pub use base::{Base, INDEPENDENT, Motion, NO_EFFECT, RANK};
pub use error::IdentificationError;
pub use estimate::{
    Consistent, ConsistentSettings, Estimate, Fit, LAGS, Whiteness, fit, log_cholesky, ordinary, student, total, weighted, whiteness,
};
pub use excitation::{Excitation, Fourier, Search, excite};
pub use information::{Information, Stacking};
pub use linear::{LinearModel, Rows};
pub use log_cholesky::LogCholesky;
pub use pseudo::{Consistency, PseudoInertia, ZERO};
pub use samples::Samples;
pub use unknowns::{Dof, Kind, Terms, Unknown};
