//! The tests of continua as one program: they share what is compiled for them.

mod answers;
mod beams;
mod coupling;
mod errors;
mod laws;
mod motion;
mod prefactors;
#[path = "../../robots/tests/share.rs"]
mod share;
mod statics;
mod wide;
