//! All variables together: marginals, and a Gaussian copula where they are correlated.
//!
//! x_i = F_i⁻¹(Φ(z_i)) with z normal, of mean zero and correlation R = L Lᵀ. Independent variables need no normal ones: x_i = F_i⁻¹(u_i).

use crate::Error;
use crate::quadrature::Recurrence;
use crate::variable::{ORDERS, Variable, normal_quantile};
use featherbench_model::{Distribution, Uncertain};
use nalgebra::DMatrix;

/// Points of the rule for a covariance in each of two normal variables.
const POINTS: usize = 32;

/// The variables of a problem.
#[derive(Clone, Debug)]
pub struct Space {
    variables: Vec<Variable>,
    /// Rows of L, if any two are correlated.
    factor: Option<Vec<Vec<f64>>>,
    covariance: DMatrix<f64>,
}

impl Space {
    /// Independent variables.
    ///
    /// # Errors
    /// [`Error`] when there is none, or one is no distribution.
    pub fn independent(distributions: &[Distribution]) -> Result<Self, Error> {
        if distributions.is_empty() {
            return Err(Error::NoVariables);
        }
        let made = distributions.iter().enumerate();
        let made =
            made.map(|(variable, distribution)| Variable::new(*distribution).map_err(|defect| Error::Distribution { variable, defect }));
        let variables = made.collect::<Result<Vec<Variable>, Error>>()?;
        let variances: Vec<f64> = variables.iter().map(Variable::variance).collect();
        let covariance = DMatrix::from_fn(variances.len(), variances.len(), |i, j| if i == j { variances[i] } else { 0.0 });
        Ok(Self { variables, factor: None, covariance })
    }

    /// The variables of a description.
    ///
    /// # Errors
    /// [`Error`] when there is none, one is no distribution, or no variables are correlated so.
    pub fn of(uncertain: &Uncertain) -> Result<Self, Error> {
        let distributions: Vec<Distribution> = uncertain.variables.iter().map(|variable| variable.distribution).collect();
        let mut space = Self::independent(&distributions)?;
        if uncertain.correlations.iter().any(|correlation| correlation.value != 0.0) {
            let defect = |pivot| featherbench_model::UncertainDefect::Indefinite { pivot };
            let bad = |pivot| featherbench_model::Malformed::Uncertain { name: "correlations".into(), place: None, defect: defect(pivot) };
            space.factor = Some(uncertain.correlation_factor().map_err(bad)?);
            space.correlate();
        }
        Ok(space)
    }

    /// Fills in the covariances of correlated pairs, by Gauss–Hermite quadrature in two independent normal variables.
    fn correlate(&mut self) {
        let Some(factor) = &self.factor else { return };
        let rule = Recurrence::hermite(POINTS).rule(POINTS);
        for i in 0..self.variables.len() {
            for j in 0..i {
                let correlation: f64 = factor[i].iter().zip(&factor[j]).map(|(a, b)| a * b).sum();
                if correlation == 0.0 {
                    continue;
                }
                let (first, second) = (&self.variables[i], &self.variables[j]);
                let other = (1.0 - correlation * correlation).max(0.0).sqrt();
                let mut sum = 0.0;
                for (a, weight_a) in rule.nodes.iter().zip(&rule.weights) {
                    let x = first.of_normal(*a) - first.mean();
                    for (b, weight_b) in rule.nodes.iter().zip(&rule.weights) {
                        sum += weight_a * weight_b * x * (second.of_normal(correlation * a + other * b) - second.mean());
                    }
                }
                (self.covariance[(i, j)], self.covariance[(j, i)]) = (sum, sum);
            }
        }
    }

    /// How many variables there are.
    pub fn len(&self) -> usize {
        self.variables.len()
    }

    /// There is one at least.
    pub fn is_empty(&self) -> bool {
        self.variables.is_empty()
    }

    /// The variables.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Whether any two are correlated.
    pub fn is_correlated(&self) -> bool {
        self.factor.is_some()
    }

    /// Their means.
    pub fn means(&self) -> Vec<f64> {
        self.variables.iter().map(Variable::mean).collect()
    }

    /// Their covariance.
    pub fn covariance(&self) -> &DMatrix<f64> {
        &self.covariance
    }

    /// The point of the variables for a point of the unit cube. All slices have one number per variable; `normal` is scratch.
    pub fn map(&self, unit: &[f64], normal: &mut [f64], x: &mut [f64]) {
        if self.factor.is_some() {
            normal.iter_mut().zip(unit).for_each(|(z, u)| *z = normal_quantile(*u));
            self.of_normals(normal, x);
        } else {
            for ((x, u), variable) in x.iter_mut().zip(unit).zip(&self.variables) {
                *x = variable.quantile(*u);
            }
        }
    }

    /// The point of the variables for independent standard normal ones.
    pub fn of_normals(&self, normal: &[f64], x: &mut [f64]) {
        for (i, (x, variable)) in x.iter_mut().zip(&self.variables).enumerate() {
            let z = match &self.factor {
                Some(factor) => factor[i].iter().zip(normal).map(|(l, z)| l * z).sum(),
                None => normal[i],
            };
            *x = variable.of_normal(z);
        }
    }

    /// The polynomials of the germ in each direction: those of the variables, or of the normal variables behind correlated ones.
    pub(crate) fn polynomials(&self) -> Vec<Recurrence> {
        let of = |variable: &Variable| if self.is_correlated() { Recurrence::hermite(ORDERS) } else { variable.polynomials() };
        self.variables.iter().map(of).collect()
    }

    /// The point of the variables for a point of germs.
    pub(crate) fn of_germs(&self, germs: &[f64], x: &mut [f64]) {
        if self.is_correlated() {
            self.of_normals(germs, x);
        } else {
            for ((x, t), variable) in x.iter_mut().zip(germs).zip(&self.variables) {
                *x = variable.of_germ(*t);
            }
        }
    }
}
