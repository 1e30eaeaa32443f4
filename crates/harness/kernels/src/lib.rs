//! Our engine: the registry of our kernels, which the studies ask and the timing study times.
//!
//! It is the only crate of the harness that is compiled with the optimisation of kernels. So it holds no other code.

mod batch;
mod derivatives;
mod factors;
mod kernel;
mod method;
mod own;
mod parallel;
mod second_derivatives;

pub use kernel::{counted, reads_description, timed};
pub use own::Featherbench;
