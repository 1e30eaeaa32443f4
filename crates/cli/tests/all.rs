//! The tests of the command line as one program: so shared modules are compiled once.

mod alone;
mod bad_input;
mod command_line;
mod conventions;
mod damage;
mod datasets;
mod described;
mod direction;
mod elsewhere;
mod explain;
mod external;
mod folds;
mod history_diff;
mod paper;
mod parsers;
mod planted;
mod pythons;
mod residuals;
mod resume;
mod schema;
mod sections;
mod shards;
#[path = "../../mechanics/robots/tests/share.rs"]
mod share;
mod support;
mod uncertainty;
