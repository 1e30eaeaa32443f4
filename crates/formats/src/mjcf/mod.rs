//! MJCF, MuJoCo's format: writing it. Reading it is MuJoCo's own business (defaults, includes, classes): its oracle does that.

mod joints;
mod quaternion;
mod write;

pub use write::{to_string, write};
