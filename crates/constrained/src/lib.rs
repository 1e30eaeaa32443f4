//! Robots with loops: constraints on a tree, and their dynamics.

mod attachment;
mod constraint;
pub mod delassus;
mod error;
mod graph;
mod laws;
mod malformed;
pub mod library;
mod mechanism;
mod mobility;
mod rows;
mod singular;
mod solve;
pub mod stabilise;

pub use attachment::Attachment;
pub use constraint::{Constraint, Constraints, Law, LoopMotion};
pub use error::Error;
pub use graph::{BadGraph, Cycle, Edge, Graph};
pub use laws::Row;
pub use malformed::{BadConstraint, Defect};
pub use mechanism::{BadMechanism, LoopJoint, Mechanism};
pub use mobility::{Mobility, RANK};
pub use rows::Rows;
pub use singular::singular_values;
pub use solve::{CONSISTENCY, Constrained, Equations, Kkt, Method, Outcome, Proximal, RangeSpace, Solution};
