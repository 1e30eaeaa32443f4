//! The tests of the library as one program.

mod allocation;
mod common;
mod conventions;
mod dynamics;
mod errors;
mod mjcf;
mod sources;
