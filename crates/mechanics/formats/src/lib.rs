//! File formats of robots: the neutral description file ([`neutral`]), URDF ([`urdf`]), MJCF ([`mjcf`]) and USD ([`usd`], written alone).
//!
//! Reading never panics, and repairs nothing without a note. An error is typed and names file, line and field. What was left out is a note.
//! Sizes are limited; nothing recurses on the input.

mod export;
pub mod mjcf;
pub mod neutral;
#[cfg(test)]
#[path = "../../robots/tests/share.rs"]
mod share;
mod solid;
mod text;
pub mod urdf;
pub mod usd;

pub use export::{ExportError, Loss, OnLoss, Reason};
pub use text::{FileError, Place, TextError};
