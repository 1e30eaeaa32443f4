//! The tests of continua as one program: they share what is compiled for them.

mod answers;
mod beams;
mod coupling;
mod laws;
mod motion;
mod prefactors;
mod refusals;
mod statics;
mod wide;
