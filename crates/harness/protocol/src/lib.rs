//! The protocol of `oracles/PROTOCOL.md`: messages to an oracle, and its process.
//!
//! - [`Message`] is a line of JSON with the blocks of doubles that it announces. Every request and every answer is one.
//! - [`Process`] is a running oracle. It sends a request and waits for the answer, within [`Limits`] of time and memory.
//! - [`Memory`] is how much memory a process has.
//! - [`Clock`] is the time of those who wait, so that a test can set it.
//!
//! What the requests mean is the business of those who send them: quantities and robots are unknown here.

mod clock;
mod memory;
mod message;
mod process;

pub use clock::{Clock, SystemClock};
pub use memory::Memory;
pub use message::{Block, Message, MessageError};
pub use process::{Limits, Process};

/// The version of the protocol.
pub const VERSION: u64 = 1;
