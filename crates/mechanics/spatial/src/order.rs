//! The larger and the smaller of two numbers, for folds, and the largest magnitude. `f64::max` and `f64::min` lose a NaN: the largest of some errors would be a number
//! although one of them is none.

/// The larger of two numbers; NaN if one of them is.
///
/// ```
/// use featherbench_spatial::larger;
/// assert_eq!([1.0, 3.0, 2.0].into_iter().fold(0.0, larger), 3.0);
/// assert!([f64::NAN, 3.0].into_iter().fold(0.0, larger).is_nan());
/// ```
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}

/// The smaller of two numbers; NaN if one of them is.
///
/// ```
/// use featherbench_spatial::smaller;
/// assert_eq!([3.0, 1.0, 2.0].into_iter().fold(f64::INFINITY, smaller), 1.0);
/// assert!([3.0, f64::NAN].into_iter().fold(f64::INFINITY, smaller).is_nan());
/// ```
pub fn smaller(a: f64, b: f64) -> f64 {
    if a.is_nan() || b >= a { a } else { b }
}

/// The largest magnitude of some numbers; NaN if one of them is; zero of none.
///
/// ```
/// use featherbench_spatial::largest;
/// assert_eq!(largest([1.0, -3.0, 2.0]), 3.0);
/// assert!(largest([f64::NAN, 3.0]).is_nan());
/// ```
pub fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().map(f64::abs).fold(0.0, larger)
}
