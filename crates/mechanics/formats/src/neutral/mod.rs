//! The neutral description file: a robot as JSON, `"format": 1`.
//!
//! ```json
//! {"format":1,"name":"pendulum","gravity":[0.0,0.0,-9.81],
//!  "bodies":[
//!   {"name":"rod","mass":1.0,"com":[0.5,0.0,0.0],"inertia":[0.01,0.0,0.0,0.08,0.0,0.08],"parent":-1,
//!    "joint":{"name":"hinge","type":"revolute","axis":[0.0,1.0,0.0],
//!     "placement":{"rotation":[1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0],"translation":[0.0,0.0,0.0]}}}
//!  ]}
//! ```
//!
//! The page `datasets/models/FORMAT.md` describes every field. In short:
//! - `format` must be 1. A key that is not listed there is an error. Keys may be in any order.
//! - `parent` is an index into `bodies`, or −1 for the world. Bodies may be in any order; [`write()`](fn@write) keeps it.
//! - `type` is `fixed` or one of the joint types of the oracle protocol. `axis` belongs to revolute, prismatic, helical and cylindrical
//!   joints, `pitch` to helical ones.
//! - `armature`, `damping`, `friction`, `lower`, `upper`, `velocity`, `effort` have one number per degree of freedom, or are left out.
//! - `frames`, `loops`, `continua`, `residuals`, `uncertain` and `provenance` are optional. An empty section is not written.
//! - The sections `actuation` and `contacts` are errors that name the section, until a study supports them.
//! - Numbers are written as the shortest decimal that reads back to the same bits, and read exactly.

mod continua;
mod error;
mod fields;
mod loops;
mod read;
mod residuals;
mod uncertain;
mod write;

pub use error::{NeutralError, NeutralProblem};
pub use read::{parse, read};
pub use write::{to_line, to_line_with_loops, to_string, write, write_to};

/// The format's version that this crate reads and writes.
pub const FORMAT: u64 = 1;
/// The largest file that is read: a random tree of a million bodies.
pub const LIMIT: usize = 1 << 30;
