//! The tests of our engine as one program.

mod batch;
mod second_derivatives;
