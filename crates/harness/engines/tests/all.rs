//! The tests of engines as one program: they share what is compiled for them.

#[path = "conformance/main.rs"]
mod conformance;
#[path = "oracle/main.rs"]
mod oracle;
mod recorded;
mod with_residual;
