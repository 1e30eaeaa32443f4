//! MJCF, MuJoCo's format: writing it. Only MuJoCo itself imports it (defaults, includes, classes), through its oracle. Some of what a file
//! holds besides is found here.

mod contents;
mod equality;
mod joints;
mod quaternion;
mod write;

pub use contents::{Contents, contents};
pub use write::{to_string, write};
