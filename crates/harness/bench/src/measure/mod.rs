//! Error measures: each difference is divided by the magnitude of the terms that were added to form the number.
//!
//! A norm over mixed units hides small numbers behind large ones. A relative error of one number explodes where terms cancel.
//! So every entry is measured against the sum of the magnitudes of its own terms ([`Magnitudes`]), and entries of M against √(M_ii·M_jj).
//! Derivatives are measured as matrices without units, over their largest entry.
//! Forward dynamics has the kinetic-energy norm and the backward error. `guide/measures.md` explains them.

mod derivative;
mod forward;
mod magnitudes;
mod scaled;

pub use derivative::derivative_size;
pub use forward::ForwardScale;
pub use magnitudes::Magnitudes;
pub use scaled::scaled_error;

/// The larger of two errors; NaN when either is, so that a fold keeps every NaN.
pub fn worst(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// A difference over the magnitude of its terms; zero over zero is zero, anything else over zero is infinite; NaN when either is.
pub fn ratio(difference: f64, magnitude: f64) -> f64 {
    if difference == 0.0 && !magnitude.is_nan() { 0.0 } else { difference.abs() / magnitude }
}
