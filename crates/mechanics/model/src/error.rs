//! A slice of the wrong length.

use thiserror::Error;

/// The size of a slice, workspace or matrix is not the size that the model needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{what}: expected {expected}, found {found}; size it by the topology of the model that you pass")]
pub struct DimensionError {
    /// The argument, and what is counted in it.
    pub what: &'static str,
    /// The count that the model needs.
    pub expected: usize,
    /// The count that was found.
    pub found: usize,
}

impl DimensionError {
    /// An error if a count is not the expected one.
    ///
    /// # Errors
    /// The error that says so.
    #[inline(always)]
    pub fn expect(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if expected == found { Ok(()) } else { Err(Self { what, expected, found }) }
    }
}
