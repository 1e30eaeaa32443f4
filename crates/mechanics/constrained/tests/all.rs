//! The tests of constraints and constrained dynamics as one program: they share what is compiled for them.

mod common;
mod delassus;
mod errors;
mod extended;
mod files;
mod graph;
mod laws;
mod library;
mod solve;
mod squeezer;
mod stabilise;
