//! Speed and scale: how long, how much memory, and how both grow.
//!
//! - [`operations`]: are the counts of the sparse algorithms the integers of the theory?
//! - [`scaling`]: what do sparsity and errors become as robots grow?
//! - [`growth`]: how do time and memory grow with the robot, and where does each engine stop?
//! - [`contact_timing`]: how long do solvers take for the contacts of standing robots, at the same residual?
//! - [`timing`]: how long does each candidate take, in a paired experiment?

pub mod contact_timing;
pub mod growth;
pub mod operations;
pub mod scaling;
pub mod timing;

pub use contact_timing::ContactTiming;
pub use growth::{Growth, Settings as GrowthSettings};
pub use operations::OperationCounts;
pub use scaling::{Scaling, Settings as ScalingSettings};
pub use timing::{InstructionCounts, Settings as TimingSettings, Timing, disturbed, instructions};
