//! The tests of learned models as one program: they share what is compiled for them.

mod bad_input;
mod basis;
mod energy;
mod fits;
mod support;
