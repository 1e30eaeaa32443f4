//! Error measures: each difference is divided by the magnitude of the terms that were added to form the number.
//!
//! A norm over mixed units hides small numbers behind large ones. A relative error of one number explodes where terms cancel.
//! So every entry is measured against the sum of the magnitudes of its own terms ([`Magnitudes`]), and entries of M against √(M_ii·M_jj).
//! Derivatives are measured as matrices without units, over their largest entry.
//! Forward dynamics has the kinetic-energy norm and the backward error. `guide/measures.md` explains them.

mod derivative;
mod forward;
mod magnitudes;
mod ratio;
mod scaled;

pub use derivative::derivative_size;
pub use forward::ForwardScale;
pub use magnitudes::Magnitudes;
pub use ratio::{ratio, worst};
pub use scaled::scaled_error;
