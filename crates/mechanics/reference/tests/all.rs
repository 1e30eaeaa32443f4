//! The tests of the slow truth as one program: they share what is compiled for them.

mod closed;
mod golden;
mod integrators;
mod numbers;
mod routes;
#[path = "../../robots/tests/share.rs"]
mod share;
mod support;
mod witness;
