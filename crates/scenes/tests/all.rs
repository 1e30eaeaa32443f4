//! All tests of the crate: one program, which is linked once.

mod answers;
mod laws;
mod loads;
mod refusals;
