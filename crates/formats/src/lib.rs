//! How a robot is written: the neutral description file ([`neutral`]), URDF ([`urdf`]) and, to write only, MJCF ([`mjcf`]);
//! and how numbers about it are sent and kept ([`frame`]).
//!
//! Reading never panics and never repairs silently: what is wrong is a typed error that names file, line and field, what was left out is a
//! note. Sizes are limited, nothing recurses on the input.

mod export;
pub mod frame;
pub mod mjcf;
pub mod neutral;
mod text;
pub mod urdf;

pub use export::{ExportError, Loss, OnLoss, Reason};
pub use text::{Place, TextError};
