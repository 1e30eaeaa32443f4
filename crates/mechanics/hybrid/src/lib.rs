//! Hybrid systems: flows, guards and resets; runs through their events; derivatives of whole runs.
//!
//! - [`Hybrid`] is a system: a flow per mode, guards with a direction, a reset per guard, generic over the scalar.
//! - [`simulate`] runs it. Events are located in time; a [`Run`] says how it ended: finished, [`Status::Zeno`], [`Status::Grazing`],
//!   [`Status::Ambiguous`] (several guards at once whose order matters), or at a cap.
//! - [`Saltation`] is the derivative of an event; [`sensitivity`] that of a whole run, forward; [`adjoint`] is its transpose.
//! - [`library`] has systems with closed forms.
//! - [`penalty`] is the law by which a spring-damper ground approaches the rigid one.
//!
//! Measured with the default settings in f64, as the tests print it:
//!
//! | what | against | error |
//! |---|---|---|
//! | t∞ and path of 41 balls | closed forms | 3·10⁻¹⁴, 2·10⁻¹⁴, relative |
//! | their impact times | closed forms | 3·10⁻¹⁵, relative |
//! | derivatives of runs of 8 systems, and of 40 drawn throws | re-simulation in double-double | 3·10⁻¹⁴ of the largest entry of a row |
//! | the adjoint | the forward derivative | 1·10⁻¹⁴, likewise |
//! | slope and prefactor of the penalty law | −½ and its closed form | 6·10⁻⁴, 6·10⁻⁵ relative |
//!
//! Conventions: SI units. t is time, x the state, θ the parameters; a minus marks what is before an event, a plus what is after it.

mod adjoint;
mod crossing;
mod dense;
mod error;
mod extrapolation;
mod instant;
pub mod library;
pub mod penalty;
mod run;
mod saltation;
mod sensitivity;
mod settings;
mod simulate;
mod system;
mod zeno;

pub use adjoint::{Gradient, adjoint};
pub use error::HybridError;
pub use run::{Cap, Event, Record, Run, Settled, Simultaneous, Start, Status, Step};
pub use saltation::Saltation;
pub use sensitivity::{Sensitivity, sensitivity};
pub use settings::{Settings, Zeno};
pub use simulate::simulate;
pub use system::{Direction, Hybrid};
pub use zeno::{Limit, Tail};
