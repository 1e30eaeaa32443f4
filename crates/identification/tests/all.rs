//! The tests of identification as one program: they share what is compiled for them.

mod consistency;
mod estimators;
mod excitation;
mod ranks;
