//! The tests of continua as one program: they share what is compiled for them.

mod answers;
mod beams;
mod coupling;
mod errors;
mod laws;
mod motion;
mod prefactors;
mod statics;
mod wide;
