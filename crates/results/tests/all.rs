//! The tests of rows and runs as one program: they share what is compiled for them.

mod diff;
mod integrity;
mod round_trip;
