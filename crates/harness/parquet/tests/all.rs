//! The tests of Parquet as one program: so shared modules are compiled once.

mod program;
mod rows;
mod table;
