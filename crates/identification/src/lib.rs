//! Identification of robots: which parameters the torques depend on, what a log says of them, and how well.
//!
//! The torques are linear in the unknowns θ ([`LinearModel`]). Only combinations of these have an effect: the base parameters ([`Base`]).
//!
//! - `linear.rs`, `unknowns.rs`: the regressor with the columns of armature, friction and offset;
//! - `information.rs`: stacked equations in triangular form;
//! - `base.rs`: rank and base parameters;
//! - `arms.rs`: arms whose ranks are known;
//! - `pseudo.rs`: which parameters a body can have;

mod arms;
mod base;
mod error;
mod information;
mod linear;
mod pseudo;
mod samples;
mod unknowns;

pub use arms::{Arm, Gravity};
pub use base::{Base, INDEPENDENT, Motion, NO_EFFECT, RANK};
pub use error::IdentificationError;
pub use information::{Information, Stacking};
pub use linear::{LinearModel, Rows};
pub use pseudo::{Consistency, PseudoInertia, ZERO};
pub use samples::Samples;
pub use unknowns::{Dof, Kind, Terms, Unknown};
