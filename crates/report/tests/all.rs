//! The tests of the report as one program: so shared modules are compiled once.

mod imports;
mod joints;
mod report;
mod support;
mod truth;
mod written;
