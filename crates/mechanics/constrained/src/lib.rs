//! Robots with loops: the graph, constraints on its spanning tree, and constrained dynamics.
//!
//! - [`Graph`] has links and joints with loops: spanning tree, cut joints, fundamental [`Cycle`]s, Grübler's count. [`Mechanism`] is a
//!   description with its loops. [`Mobility`] is the truth that the count misses.
//! - [`Constraint`] holds points, frames, distances, gears and joints that follow others. [`Rows`] are residual φ, Jacobian J and
//!   bias J̇v of all of them at a state.
//! - [`delassus`] computes `G = J M⁻¹ Jᵀ` by three routes.
//! - [`Constrained`] forms the equations of motion, and a [`Method`] solves them: [`Kkt`], [`RangeSpace`], [`Proximal`]. Redundant rows are
//!   found by rank, with a tolerance that is stated. Each [`Solution`] has its residuals.
//! - [`accelerations`] solves the equations in double-double arithmetic: the truth for the methods, and for engines.
//! - [`stabilise`] keeps loops closed in time, and measures their drift.
//! - [`systems`] has robots with loops whose motion is known.
//!
//! Conventions: units are SI. Rows have the axes of the first frame of their constraint. Multipliers act on the second frame as they are
//! named, and opposite on the first. "The book" is R. Featherstone, *Rigid Body Dynamics Algorithms* (2008).
//!
//! ```
//! use featherbench_constrained::{Constrained, Kkt, systems::Ladder};
//! // A parallelogram four-bar: one loop, of five rows of which two are independent.
//! let ladder = Ladder::default();
//! let four_bar = ladder.mechanism()?;
//! let mut dynamics = Constrained::new(&four_bar.model, &four_bar.constraints)?;
//! let solution = dynamics.run(&ladder.spread(0.5), &ladder.spread(0.0), &[0.0; 3], &Kkt::default())?;
//! assert_eq!(solution.rank, Some(2));
//! assert!((solution.acceleration[0] - ladder.acceleration(0.5)).abs() < 1e-13);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod attachment;
mod constraint;
pub mod delassus;
mod error;
mod graph;
mod laws;
mod malformed;
mod mechanism;
mod mobility;
mod rows;
mod solve;
pub mod stabilise;
pub mod systems;
mod truth;

pub use attachment::Attachment;
pub use constraint::{Constraint, Constraints, Law};
pub use error::Error;
pub use featherbench_model::LoopMotion;
pub use graph::{BadGraph, Cycle, Edge, Graph};
pub use laws::Row;
pub use malformed::{BadConstraint, Defect};
pub use mechanism::{BadMechanism, Mechanism, gruebler_in_plane};
pub use mobility::{Mobility, RANK};
pub use rows::Rows;
pub use solve::{CONSISTENCY, Constrained, Equations, Kkt, Method, Outcome, Proximal, RangeSpace, Solution};
pub use truth::{REDUNDANT, accelerations};
