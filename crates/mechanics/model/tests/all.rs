//! The tests of models as one program: they share what is compiled for them.

mod anything;
mod arbitrary;
mod continua;
mod descriptions;
mod loops;
mod normalisation;
#[path = "../../robots/tests/share.rs"]
mod share;
