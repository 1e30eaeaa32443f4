//! The tests of hybrid simulation as one program: they share what is compiled for them.

mod bad_input;
mod closed_forms;
mod derivatives;
mod ends;
mod penalty;
mod saltation;
mod zeno;
