//! The tests of continua as one program: they share what is compiled for them.
