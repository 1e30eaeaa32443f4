//! What can go wrong: a slice of the wrong length, or a matrix that is not positive definite.

pub use featherbench_model::DimensionError;
use thiserror::Error;

/// A factorization met a pivot that is zero, negative or not a number.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "the joint-space inertia matrix is not positive definite: pivot {pivot:e} at dof {dof}; \
     give the bodies that this dof moves mass or inertia, or the dof armature, and look for NaN in the input"
)]
pub struct NotPositiveDefinite {
    /// The dof whose pivot it is.
    pub dof: usize,
    /// The pivot.
    pub pivot: f64,
}

/// The errors of forward dynamics and factorizations.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Error {
    /// An argument has the wrong size.
    #[error(transparent)]
    Dimension(#[from] DimensionError),
    /// The joint-space inertia matrix is not positive definite.
    #[error(transparent)]
    NotPositiveDefinite(#[from] NotPositiveDefinite),
}

/// An error if a count is not the expected one.
#[inline(always)]
pub(crate) fn expect(what: &'static str, expected: usize, found: usize) -> Result<(), DimensionError> {
    DimensionError::expect(what, expected, found)
}

/// The smallest pivot so far, or the first one that is not positive. Pivots after that one have no meaning.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pivot {
    dof: usize,
    value: f64,
}

impl Pivot {
    /// Before the first pivot.
    pub(crate) fn none() -> Self {
        Self { dof: 0, value: f64::INFINITY }
    }

    /// Takes note of the pivot of a dof.
    #[inline(always)]
    pub(crate) fn note(&mut self, dof: usize, value: f64) {
        let smaller_or_nan = value < self.value || value.is_nan();
        if self.value > 0.0 && smaller_or_nan {
            *self = Self { dof, value };
        }
    }

    /// The same with dofs counted from another one.
    pub(crate) fn behind(self, first: usize) -> Self {
        Self { dof: first + self.dof, ..self }
    }

    /// Of two that were noted apart, the one that one pass from the leaves to the root would have noted.
    pub(crate) fn leaves_first(self, other: Self) -> Self {
        self.first_by(other, |dof, other| dof > other)
    }

    /// Of two that were noted apart, the one that one pass from the root to the leaves would have noted.
    pub(crate) fn root_first(self, other: Self) -> Self {
        self.first_by(other, |dof, other| dof < other)
    }

    fn first_by(self, other: Self, comes_first: impl Fn(usize, usize) -> bool) -> Self {
        match (self.check(), other.check()) {
            (Err(_), Err(_)) if comes_first(self.dof, other.dof) => self,
            (Err(_), Ok(())) => self,
            (Ok(()), Ok(())) if self.value < other.value => self,
            _ => other,
        }
    }

    /// The error, unless every pivot was positive.
    pub(crate) fn check(self) -> Result<(), NotPositiveDefinite> {
        if self.value > 0.0 { Ok(()) } else { Err(NotPositiveDefinite { dof: self.dof, pivot: self.value }) }
    }
}
