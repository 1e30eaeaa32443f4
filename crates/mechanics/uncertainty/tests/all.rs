//! The tests of uncertainty as one program: they share what is compiled for them.

mod methods;
mod points;
mod robots;
mod variables;
