//! The tests of the harness as one program: they share what is compiled for them.

#[path = "by_hand/main.rs"]
mod by_hand;
mod classes;
mod configuration;
mod degenerate;
mod derivatives;
mod external;
mod gates;
mod measures;
mod normalised;
mod processes;
mod properties;
mod resume;
#[path = "../../../mechanics/robots/tests/share.rs"]
mod share;
mod statistics;
mod truth;
