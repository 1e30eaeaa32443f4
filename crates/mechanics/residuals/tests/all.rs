//! The tests of residuals as one program: they share what is compiled for them.

mod bad_input;
mod conventions;
mod described;
mod dry;
mod inner;
mod known;
mod linear;
mod passive;
mod power;
mod support;
mod well_posed;
