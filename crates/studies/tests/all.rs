//! The tests of studies as one program: they share what is compiled for them.

mod accounted_readings;
mod accuracy;
mod bad_oracle;
mod convicted;
mod planted;
mod planted_answers;
mod planted_readings;
mod reading;
mod repeatability;
mod reproductions;
mod step_limit;
mod support;
mod timing;
mod truth;
