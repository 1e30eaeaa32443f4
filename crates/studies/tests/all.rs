//! The tests of studies as one program: so shared modules are compiled once.

mod accounted_readings;
mod bad_oracle;
mod catalogue;
mod conditioning;
mod convicted;
mod derivatives;
mod growth;
mod import;
mod over_best;
mod planted;
mod planted_answers;
mod planted_readings;
mod reduce;
mod registry;
mod repeatability;
mod reproductions;
mod scaling;
mod sections;
#[path = "../../robots/tests/share.rs"]
mod share;
mod singular;
mod steps;
mod support;
mod timing;
mod truth;
