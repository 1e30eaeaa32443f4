//! The engines: whatever answers questions.
//!
//! - [`Featherbench`] runs the kernels of this workspace; it is the crate `kernels`.
//! - [`Oracle`] asks a program that follows the protocol of `oracles/PROTOCOL.md`.
//! - [`alone`] measures our kernels in a process of their own.
//! - [`native`] serves an engine's native library by the same protocol.
//! - [`Recorded`] repeats the recorded answers of an oracle.
//!
//! To add an engine, write such a program, in Rust too (`oracles/rapier`), or implement [`Engine`](featherbench_bench::Engine) in a new
//! file here.

pub mod alone;
mod coding;
pub mod conformance;
pub mod native;
mod oracle;
mod recorded;
mod reproducer;
mod request;
mod shape;

pub use featherbench_kernels::{Featherbench, counted, timed};
pub use featherbench_protocol::{Clock, Limits, SystemClock};
pub use oracle::{Oracle, OracleResidual};
pub use recorded::{EngineRecording, Recorded, Recording, RecordingError, Recordings, read_recordings, recording_name};
pub use reproducer::reproduce;
