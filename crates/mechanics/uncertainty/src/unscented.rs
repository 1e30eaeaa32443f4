//! The unscented transform: 2n + 1 points that have the mean and covariance of the variables.
//!
//! Source: S. Julier and J. Uhlmann, 1997. Points μ and μ ± √(n + κ) C eₖ with Σ = C Cᵀ; weights κ/(n + κ) and ½/(n + κ).

use crate::response::at_each;
use crate::{Error, Response, Space};
use nalgebra::{DMatrix, DVector};

/// Mean and covariance of the answers.
#[derive(Clone, Debug, PartialEq)]
pub struct Propagated {
    /// One per output.
    pub mean: DVector<f64>,
    /// Outputs × outputs.
    pub covariance: DMatrix<f64>,
}

/// Mean and covariance by the transform. κ must be above −n; 3 − n is usual for few variables, and 0 for three or more: it has no negative weight.
///
/// # Errors
/// [`Error`] when a point is outside the support of its variable, or has no finite answer.
pub fn unscented<R: Response>(space: &Space, response: &R, kappa: f64) -> Result<Propagated, Error> {
    let n = space.len();
    let scale = n as f64 + kappa;
    if scale.is_nan() || scale <= 0.0 {
        return Err(Error::Unbounded("the unscented transform needs κ above minus the number of variables"));
    }
    // The symmetric root of Σ always exists: correlated variables may have a singular one.
    let eigen = space.covariance().clone().symmetric_eigen();
    let root = &eigen.eigenvectors * DMatrix::from_diagonal(&eigen.eigenvalues.map(|x| x.max(0.0).sqrt())) * eigen.eigenvectors.transpose();
    let means = space.means();
    let coordinate = |point: usize, i: usize| match point {
        0 => means[i],
        k if k <= n => means[i] + scale.sqrt() * root[(i, k - 1)],
        k => means[i] - scale.sqrt() * root[(i, k - n - 1)],
    };
    for point in 0..=2 * n {
        for (variable, known) in space.variables().iter().enumerate() {
            let value = coordinate(point, variable);
            let [low, high] = known.support();
            // A uniform variable may be left, as long as nothing changes its sign: the transform knows two moments alone.
            if !value.is_finite() || (low >= 0.0 && value <= 0.0) || (high <= 0.0 && value >= 0.0) {
                return Err(Error::OutsideSupport { method: "unscented transform", variable, value });
            }
        }
    }
    let answers = at_each(response, 2 * n + 1, |point, x| x.iter_mut().enumerate().for_each(|(i, x)| *x = coordinate(point, i)));
    let outputs = response.outputs();
    if let Some(place) = answers.iter().position(|y| !y.is_finite()) {
        return Err(Error::NotFinitePoint { method: "unscented transform", point: place / outputs });
    }
    let weight = |point: usize| if point == 0 { kappa / scale } else { 0.5 / scale };
    let answer = |point: usize| DVector::from_column_slice(&answers[point * outputs..(point + 1) * outputs]);
    let mean = (0..=2 * n).fold(DVector::zeros(outputs), |sum, point| sum + answer(point) * weight(point));
    let covariance = (0..=2 * n).fold(DMatrix::zeros(outputs, outputs), |sum, point| {
        let from_mean = answer(point) - &mean;
        sum + &from_mean * from_mean.transpose() * weight(point)
    });
    Ok(Propagated { mean, covariance })
}
