//! The tests of these studies as one program: so shared modules are compiled once.

mod offers;
mod registry;
mod sections;
