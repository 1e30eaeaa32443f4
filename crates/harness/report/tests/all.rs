//! The tests of the report as one program: so shared modules are compiled once.

mod figures;
mod frame;
mod layers;
mod robot;
mod runs;
mod written;
