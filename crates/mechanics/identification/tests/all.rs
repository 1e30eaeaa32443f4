//! The tests of identification as one program: they share what is compiled for them.

mod arms;
mod consistency;
mod estimators;
mod excitation;
mod identified;
mod logs;
mod ranks;
#[path = "../../robots/tests/share.rs"]
mod share;
