//! The tests of constraints and constrained dynamics as one program: they share what is compiled for them.

mod common;
mod delassus;
mod laws;
mod refusals;
mod solve;
