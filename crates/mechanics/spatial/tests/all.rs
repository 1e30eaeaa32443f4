//! The tests of spatial algebra as one program: they share what is compiled for them.

mod algebra;
#[path = "double_double/main.rs"]
mod double_double;
mod exponential;
mod lanes;
#[path = "../../robots/tests/share.rs"]
mod share;
