//! The tests of the report as one program: they share what is compiled for them.

mod imports;
mod joints;
mod report;
mod support;
mod truth;
mod written;
