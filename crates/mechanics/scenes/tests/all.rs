//! All tests of the crate: one program, which is linked once.

mod answers;
mod errors;
mod laws;
mod loads;
