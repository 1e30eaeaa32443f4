//! The tests of engines as one program: they share what is compiled for them.

mod batch;
#[path = "conformance/main.rs"]
mod conformance;
#[path = "oracle/main.rs"]
mod oracle;
mod recorded;
mod second_derivatives;
mod with_residual;
