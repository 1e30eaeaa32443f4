//! The tests of constraints and constrained dynamics as one program: they share what is compiled for them.

mod common;
mod delassus;
mod errors;
mod files;
mod graph;
mod laws;
mod planar;
mod solve;
mod squeezer;
mod stabilise;
mod truth;
