//! The error measures against numbers worked out by hand: every magnitude of two small robots, every entry of every quantity, and the scales
//! of forward dynamics.

mod condition;
mod entries;
mod forward;
mod magnitudes;
mod robots;

/// Whether two numbers are equal but for the rounding of a few dozen operations on numbers without cancellation; infinity is close to
/// nothing.
fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-13 * a.abs().min(b.abs())
}

/// Asserts that two lists are the same but for rounding, and names the first number that is not.
#[track_caller]
fn assert_close(what: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}: {found:?} instead of {expected:?}");
    for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!(close(*found, *expected), "{what}, number {k}: {found} instead of {expected}");
    }
}
