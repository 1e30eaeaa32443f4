//! The tests of the harness as one program: they share what is compiled for them.

#[path = "by_hand/main.rs"]
mod by_hand;
mod configuration;
mod external;
mod gates;
mod measures;
mod normalised;
mod resume;
mod truth;
