//! The tests of constraints and constrained dynamics as one program: they share what is compiled for them.

mod common;
mod delassus;
mod extended;
mod files;
mod graph;
mod laws;
mod library;
mod refusals;
mod solve;
mod squeezer;
mod stabilise;
