//! A black box: polynomials that know nothing of mechanics, one for each direction.
//!
//! τ(q, v, a) and a(q, v, τ) are polynomials of total degree d in all 3n variables, each by ridge regression. Neither is the inverse of the other,
//! nothing is symmetric, and no energy is conserved: it shows what structure is worth.

use crate::learned::expect_state;
use crate::ridge::ridge;
use crate::{Chebyshev, Dynamics, Range, ResidualError, Sample};
use nalgebra::DMatrix;

/// A model without structure.
#[derive(Clone, Debug, PartialEq)]
pub struct BlackBox {
    inverse: Map,
    forward: Map,
}

/// A polynomial of 3n variables with n values.
#[derive(Clone, Debug, PartialEq)]
struct Map {
    basis: Chebyshev,
    /// A row per product, a column per value.
    coefficients: DMatrix<f64>,
}

impl Map {
    fn fit(
        samples: &[Sample],
        degree: usize,
        lambda: f64,
        from: fn(&Sample) -> [&Vec<f64>; 3],
        to: fn(&Sample) -> &Vec<f64>,
    ) -> Result<Self, ResidualError> {
        let joined = |sample: &Sample| from(sample).map(Vec::as_slice).concat();
        let variables = samples.first().map_or(0, |sample| joined(sample).len());
        let ranges: Result<Vec<Range>, ResidualError> = (0..variables).map(|k| Range::of(samples, |sample| joined(sample)[k])).collect();
        let basis = Chebyshev::new(ranges?, degree);
        let rows: Vec<f64> = samples.iter().flat_map(|sample| basis.values(&joined(sample))).collect();
        let features = DMatrix::from_row_slice(samples.len(), basis.len(), &rows);
        let values: Vec<f64> = samples.iter().flat_map(|sample| to(sample).clone()).collect();
        let targets = DMatrix::from_row_slice(samples.len(), variables / 3, &values);
        Ok(Self { coefficients: ridge(&features, &targets, lambda)?, basis })
    }

    fn at(&self, q: &[f64], v: &[f64], x: &[f64]) -> Result<Vec<f64>, ResidualError> {
        expect_state(self.coefficients.ncols(), q, v, x)?;
        let features = self.basis.values(&[q, v, x].concat());
        let value = |column: usize| features.iter().zip(self.coefficients.column(column).iter()).map(|(f, c)| f * c).sum();
        Ok((0..self.coefficients.ncols()).map(value).collect())
    }
}

impl BlackBox {
    /// Fits polynomials of a total degree with a ridge of λ.
    ///
    /// # Errors
    /// [`ResidualError::Learning`] if there are no samples, a variable does not vary, or λ is not positive.
    pub fn fit(samples: &[Sample], degree: usize, lambda: f64) -> Result<Self, ResidualError> {
        Ok(Self {
            inverse: Map::fit(samples, degree, lambda, |s| [&s.q, &s.v, &s.a], |s| &s.tau)?,
            forward: Map::fit(samples, degree, lambda, |s| [&s.q, &s.v, &s.tau], |s| &s.a)?,
        })
    }
}

impl Dynamics for BlackBox {
    fn nv(&self) -> usize {
        self.inverse.coefficients.ncols()
    }

    fn inverse(&self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<f64>, ResidualError> {
        self.inverse.at(q, v, a)
    }

    fn forward(&self, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Vec<f64>, ResidualError> {
        self.forward.at(q, v, tau)
    }
}
