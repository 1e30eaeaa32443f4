//! The tests of the protocol as one program: they share what is compiled for them.

mod process;
