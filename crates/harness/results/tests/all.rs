//! The tests of rows and runs as one program: so shared modules are compiled once.

mod diff;
mod integrity;
mod round_trip;
mod trend;
