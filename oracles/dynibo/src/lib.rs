//! Dynibo as an oracle: a library with the C interface of `../../native/oracle.h`.
//!
//! Only dynibo's own calls are in `run`, which is timed. Conversions are in `states` and `read`.

mod coordinates;
mod robot;
mod urdf;

featherbench_interface::export!(robot::Robot);
