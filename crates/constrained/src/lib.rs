//! Robots with loops: constraints on a tree, and their dynamics.

mod attachment;
mod constraint;
pub mod delassus;
mod error;
mod laws;
mod malformed;
mod rows;

pub use attachment::Attachment;
pub use constraint::{Constraint, Constraints, Law, LoopMotion};
pub use error::Error;
pub use laws::Row;
pub use malformed::{BadConstraint, Defect};
pub use rows::Rows;
