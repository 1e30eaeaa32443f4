//! A difference over its magnitude, and the larger of two errors.

/// The larger of two errors; NaN when either is, so that a fold keeps every NaN.
pub fn worst(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// A difference over the magnitude of its terms; zero over zero is zero, anything else over zero is infinite; NaN when either is.
pub fn ratio(difference: f64, magnitude: f64) -> f64 {
    if difference == 0.0 && !magnitude.is_nan() { 0.0 } else { difference.abs() / magnitude }
}
