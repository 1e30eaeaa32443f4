//! What can be wrong with the numbers of a contact problem. Each error names its field.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use thiserror::Error;

/// A contact problem whose numbers are not one.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("field '{field}': {defect}")]
pub struct Malformed {
    /// The path of the field, such as `delassus[1][0]` or `contacts[2].friction`.
    pub field: String,
    /// What is wrong with it.
    pub defect: Defect,
}

/// What is wrong with a field.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Defect {
    /// No contact.
    #[error("a problem has at least one contact")]
    NoContact,
    /// A matrix or vector of another size.
    #[error("has {found} entries, but the contacts need {expected}")]
    Size {
        /// What is there.
        found: usize,
        /// What is needed: the rows of all contacts, or the dofs.
        expected: usize,
    },
    /// NaN or infinite.
    #[error("is {value}; give a finite number")]
    NotFinite {
        /// The number.
        value: f64,
    },
    /// A matrix that differs from its transpose.
    #[error("is {value}, but the entry across the diagonal is {across}; a matrix of masses is symmetric")]
    NotSymmetric {
        /// The entry.
        value: f64,
        /// Its mirror image.
        across: f64,
    },
    /// A Delassus matrix with a negative eigenvalue.
    #[error("has the eigenvalue {eigenvalue:e}; J M⁻¹ Jᵀ has none below zero")]
    Indefinite {
        /// The smallest eigenvalue.
        eigenvalue: f64,
    },
    /// A mass matrix without a Cholesky factor.
    #[error("is not positive definite; a mass matrix is")]
    NotPositiveDefinite,
    /// A negative coefficient of friction.
    #[error("the coefficient of friction is {value}; it is at least 0")]
    NegativeFriction {
        /// The coefficient.
        value: f64,
    },
    /// One or two coefficients are possible.
    #[error("has {found} numbers; give 1 for a planar contact and 2 for a spatial one")]
    Tangents {
        /// How many there are.
        found: usize,
    },
    /// A direction that is not a unit vector.
    #[error("has the length {length}; give a unit vector")]
    NotUnit {
        /// Its length.
        length: f64,
    },
    /// A pyramid that does not contain zero.
    #[error("the hull of the vertices does not contain zero; give vertices all around, at least 3")]
    Pyramid,
    /// Restitution outside [0, 1].
    #[error("the coefficient of restitution is {value}; it is between 0 and 1")]
    Restitution {
        /// The coefficient.
        value: f64,
    },
    /// Restitution needs velocities.
    #[error("the coefficient of restitution is {value}, but a problem at the level of forces has no impact; give 0")]
    RestitutionOfForces {
        /// The coefficient.
        value: f64,
    },
}

impl Malformed {
    pub(crate) fn new(field: impl Into<String>, defect: Defect) -> Self {
        Self { field: field.into(), defect }
    }
}

pub(crate) fn finite(value: f64, field: impl FnOnce() -> String) -> Result<(), Malformed> {
    if value.is_finite() { Ok(()) } else { Err(Malformed::new(field(), Defect::NotFinite { value })) }
}

pub(crate) fn vector(vector: &DVector<f64>, field: &str, expected: usize) -> Result<(), Malformed> {
    if vector.len() != expected {
        return Err(Malformed::new(field, Defect::Size { found: vector.len(), expected }));
    }
    vector.iter().enumerate().try_for_each(|(k, value)| finite(*value, || format!("{field}[{k}]")))
}

pub(crate) fn matrix(matrix: &DMatrix<f64>, field: &str, (rows, columns): (usize, usize)) -> Result<(), Malformed> {
    if matrix.nrows() != rows {
        return Err(Malformed::new(field, Defect::Size { found: matrix.nrows(), expected: rows }));
    }
    if matrix.ncols() != columns {
        return Err(Malformed::new(format!("{field}[0]"), Defect::Size { found: matrix.ncols(), expected: columns }));
    }
    for row in 0..rows {
        for column in 0..columns {
            finite(matrix[(row, column)], || format!("{field}[{row}][{column}]"))?;
        }
    }
    Ok(())
}

/// Mirror images may differ by the rounding of their computation, not by more.
pub(crate) fn symmetric(matrix: &DMatrix<f64>, field: &str) -> Result<(), Malformed> {
    let allowed = rounding(matrix);
    for row in 0..matrix.nrows() {
        for column in 0..row {
            let (value, across) = (matrix[(row, column)], matrix[(column, row)]);
            if (value - across).abs() > allowed {
                return Err(Malformed::new(format!("{field}[{row}][{column}]"), Defect::NotSymmetric { value, across }));
            }
        }
    }
    Ok(())
}

pub(crate) fn semidefinite(matrix: &DMatrix<f64>, field: &str) -> Result<(), Malformed> {
    let eigenvalue = SymmetricEigen::new(matrix.clone()).eigenvalues.min();
    // A NaN is no eigenvalue at all.
    if eigenvalue >= -rounding(matrix) { Ok(()) } else { Err(Malformed::new(field, Defect::Indefinite { eigenvalue })) }
}

/// What rounding does to J M⁻¹ Jᵀ and to its eigenvalues: 16 n ε of the largest entry. The products have n terms, and M⁻¹ has its own error.
pub(crate) fn rounding(matrix: &DMatrix<f64>) -> f64 {
    16.0 * matrix.nrows() as f64 * f64::EPSILON * matrix.amax()
}
