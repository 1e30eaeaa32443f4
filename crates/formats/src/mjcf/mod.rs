//! MJCF, MuJoCo's format: writing it. Only MuJoCo itself imports it (defaults, includes, classes), through its oracle.

mod joints;
mod quaternion;
mod write;

pub use write::{to_string, write};
