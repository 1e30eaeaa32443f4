//! The tests of uncertainty as one program: they share what is compiled for them.

mod coverage;
mod methods;
mod points;
mod robots;
mod variables;

#[path = "../../robots/tests/share.rs"]
mod share;
