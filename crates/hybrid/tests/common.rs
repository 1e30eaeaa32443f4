//! What the tests share.

/// The largest magnitude; NaN if any number is.
pub fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().map(f64::abs).fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}
