//! Hybrid systems: flows, guards and resets; runs through their events; derivatives of whole runs.
//!
//! - [`Hybrid`] is a system: a flow per mode, guards with a direction, a reset per guard, generic over the scalar.
//! - [`simulate`] runs it. Events are located in time; a [`Run`] says how it ended: finished, [`Status::Zeno`], [`Status::Grazing`],
//!   [`Status::Ambiguous`] (several guards at once whose order matters), or at a cap.
//! - [`Saltation`] is the derivative of an event; [`sensitivity`] that of a whole run, forward; [`adjoint`] is its transpose.
//! - [`systems`] has systems with closed forms.
//! - [`penalty`] is the law by which a spring-damper ground approaches the rigid one.
//!
//! Measured errors: `docs/kernels/hybrid.md`.
//!
//! Conventions: SI units. t is time, x the state, θ the parameters; a minus marks what is before an event, a plus what is after it.

mod adjoint;
mod crossing;
mod dense;
mod error;
mod extrapolation;
mod instant;
pub mod penalty;
mod run;
mod saltation;
mod sensitivity;
mod settings;
mod simulate;
mod system;
pub mod systems;
mod zeno;

pub use adjoint::{Gradient, adjoint};
pub use error::HybridError;
pub use run::{Cap, Event, Limit, Record, Run, Settled, Simultaneous, Start, Status, Step, Tail};
pub use saltation::Saltation;
pub use sensitivity::{Sensitivity, sensitivity};
pub use settings::{Settings, Zeno};
pub use simulate::simulate;
pub use system::{Direction, Hybrid};
