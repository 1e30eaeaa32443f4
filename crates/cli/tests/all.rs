//! The tests of the command line as one program: they share what is compiled for them.

mod bad_input;
mod conventions;
mod datasets;
mod direction;
mod elsewhere;
mod explain;
mod external;
mod folds;
mod history_diff;
mod parsers;
mod resume;
mod support;
