//! First order: the answer is linear about the means. Mean y(μ), covariance J Σ Jᵀ.

use crate::unscented::Propagated;
use crate::{Error, Space};
use nalgebra::{DMatrix, DVector};

/// An answer and its derivatives at the means of the variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// The means, where it is linear.
    pub at: Vec<f64>,
    /// y(μ).
    pub value: DVector<f64>,
    /// J: a row per output, a column per variable.
    pub jacobian: DMatrix<f64>,
}

/// Mean and covariance of a linear answer.
///
/// # Errors
/// [`Error::Dimension`] when the derivatives are of another number of variables.
pub fn first_order(space: &Space, linear: &Linear) -> Result<Propagated, Error> {
    featherbench_model::DimensionError::expect("columns of the derivatives", space.len(), linear.jacobian.ncols())?;
    let covariance = &linear.jacobian * space.covariance() * linear.jacobian.transpose();
    Ok(Propagated { mean: linear.value.clone(), covariance })
}
