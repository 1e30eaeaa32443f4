//! The tests of these studies as one program: so shared modules are compiled once.

mod accounted_readings;
mod anywhere;
mod asked_variants;
mod bad_oracle;
mod conditioning;
mod convicted;
mod derivatives;
mod drawn_causes;
mod excused;
mod import;
mod invariance;
mod over_best;
mod planted;
mod planted_answers;
mod planted_readings;
mod repeatability;
mod reproductions;
#[path = "../../../mechanics/robots/tests/share.rs"]
mod share;
mod single;
mod singular;
mod steps;
mod truth;
