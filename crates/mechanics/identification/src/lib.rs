//! Identification of robots: which parameters the torques depend on, what a log says of them, and how well.
//!
//! The torques are linear in the unknowns θ ([`LinearModel`]). Only combinations of these have an effect: the base parameters ([`Base`]).
//!
//! - `linear.rs`, `unknowns.rs`: the regressor with the columns of armature, friction and offset;
//! - `information.rs`: stacked equations in triangular form;
//! - `base.rs`: rank and base parameters;
//! - `arms.rs`: arms whose ranks are known;
//! - `pseudo.rs`, `log_cholesky.rs`: which parameters a body can have;
//! - `log/`, `smooth.rs`: logs, and the samples that they become;
//! - `excitation.rs`: trajectories that tell much;
//! - `estimate/`: least squares, consistent estimates, residuals;
//! - `semidefinite.rs`: consistent estimates as a problem for a solver outside;
//! - `identify.rs`, `outcome.rs`: the whole way, and the robot with its new parameters;
//! - `scenario.rs`: robots whose true parameters are known, to measure estimators on.

mod arms;
mod base;
mod error;
mod estimate;
mod excitation;
mod identify;
mod information;
mod linear;
mod log;
mod log_cholesky;
mod outcome;
mod pseudo;
mod samples;
mod scenario;
mod semidefinite;
mod smooth;
mod unknowns;

pub use arms::{Arm, Gravity};
pub use base::{Base, INDEPENDENT, Motion, NO_EFFECT, RANK};
pub use error::IdentificationError;
pub use estimate::{
    Consistent, ConsistentSettings, Estimate, Fit, LAGS, Whiteness, fit, log_cholesky, ordinary, student, total, weighted, whiteness,
};
pub use excitation::{Excitation, Fourier, Search, excite};
pub use identify::{Identified, Method, Request, Solve, WEAK, identify};
pub use information::{Information, Stacking};
pub use linear::{LinearModel, Rows};
pub use log::{Flag, FlagKind, GAP, Log, LogError, LogProblem, SATURATED, Table};
pub use log_cholesky::LogCholesky;
pub use outcome::{Change, changes, consistency, described};
pub use pseudo::{Consistency, PseudoInertia, ZERO};
pub use samples::Samples;
pub use scenario::{Scatter, Scenario, disturbed, held_out_deviation, scatter};
pub use semidefinite::{MARGIN, Semidefinite};
pub use smooth::{Smoothing, samples};
pub use unknowns::{Dof, Kind, Terms, Unknown};
