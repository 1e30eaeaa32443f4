//! The tests of constraints and constrained dynamics as one program: they share what is compiled for them.

mod common;
mod delassus;
mod drawn;
mod errors;
mod files;
mod graph;
mod laws;
mod planar;
#[path = "../../robots/tests/share.rs"]
mod share;
mod solve;
mod squeezer;
mod stabilise;
mod truth;
