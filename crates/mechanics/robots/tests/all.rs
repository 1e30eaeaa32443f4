//! The tests of generated robots and states as one program: they share what is compiled for them.

#[path = "../../model/tests/arbitrary.rs"]
mod arbitrary;
mod families;
mod share;
mod states;
