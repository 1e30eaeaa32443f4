//! The tests of these studies as one program: so shared modules are compiled once.

mod growth;
mod scaling;
mod singular;
mod timing;
