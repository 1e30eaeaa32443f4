//! The tests of the lesson as one program: they share what is compiled for them.

mod decided;
mod languages;
mod pipeline;
mod symbols;
