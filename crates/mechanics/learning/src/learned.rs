//! What every model answers, and what it makes of it: a residual beside a nominal model.

use crate::ResidualError;
use featherbench_dynamics::{energy, forward_dynamics, inverse_dynamics};
use featherbench_model::Model;
use featherbench_residuals::{Residual, State};
use nalgebra::DMatrix;
use std::fmt::Debug;

/// Inverse and forward dynamics of a robot, however they are known. Each vector has nv numbers.
pub trait Dynamics: Debug + Send + Sync {
    /// Degrees of freedom.
    fn nv(&self) -> usize;

    /// The joint forces of an acceleration.
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit.
    fn inverse(&self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<f64>, ResidualError>;

    /// The acceleration under joint forces.
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit, or the model's mass matrix is not positive definite there.
    fn forward(&self, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Vec<f64>, ResidualError>;

    /// Its energy, J, up to a constant; `None` of a model that has none.
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit.
    fn energy(&self, _q: &[f64], _v: &[f64]) -> Result<Option<f64>, ResidualError> {
        Ok(None)
    }
}

/// A rigid-body model as what is learned from.
#[derive(Clone, Debug)]
pub struct Truth(Model<f64>);

impl Truth {
    /// Of a model with one number of q per dof.
    ///
    /// # Errors
    /// [`ResidualError::NotAVectorSpace`] for any other.
    pub fn new(model: Model<f64>) -> Result<Self, ResidualError> {
        let (nq, nv) = (model.topology.nq(), model.topology.nv());
        if nq == nv { Ok(Self(model)) } else { Err(ResidualError::NotAVectorSpace { what: "a learned model", nq, nv }) }
    }

    /// The model.
    pub fn model(&self) -> &Model<f64> {
        &self.0
    }
}

impl Dynamics for Truth {
    fn nv(&self) -> usize {
        self.0.topology.nv()
    }

    fn inverse(&self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<f64>, ResidualError> {
        Ok(inverse_dynamics(&self.0, q, v, a)?)
    }

    fn forward(&self, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Vec<f64>, ResidualError> {
        Ok(forward_dynamics(&self.0, q, v, tau)?)
    }

    fn energy(&self, q: &[f64], v: &[f64]) -> Result<Option<f64>, ResidualError> {
        let energies = energy(&self.0, q, v)?;
        Ok(Some(energies.kinetic + energies.potential))
    }
}

/// A learned model as a residual: r = its joint forces less the nominal model's.
///
/// ∂r/∂a is the difference of the mass matrices. A column is that of a unit acceleration less that of none: exact to rounding for models whose
/// torque is affine in a, as the structured ones are. The torque of a [`crate::BlackBox`] is not.
#[derive(Debug)]
pub struct Learned<D> {
    nominal: Model<f64>,
    learned: D,
}

impl<D: Dynamics> Learned<D> {
    /// Of a nominal model and a learned one of as many dofs.
    ///
    /// # Errors
    /// [`ResidualError`] if they are of different size.
    pub fn new(nominal: Model<f64>, learned: D) -> Result<Self, ResidualError> {
        let nominal = Truth::new(nominal)?.0;
        expect("dofs of the learned model", nominal.topology.nv(), learned.nv())?;
        Ok(Self { nominal, learned })
    }

    fn difference(&self, q: &[f64], v: &[f64], a: &[f64]) -> Result<Vec<f64>, ResidualError> {
        let known = inverse_dynamics(&self.nominal, q, v, a)?;
        Ok(self.learned.inverse(q, v, a)?.iter().zip(known).map(|(learned, known)| learned - known).collect())
    }
}

impl<D: Dynamics> Residual for Learned<D> {
    fn nv(&self) -> usize {
        self.learned.nv()
    }

    fn nq(&self) -> Option<usize> {
        Some(self.learned.nv())
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        r.iter_mut().zip(self.difference(state.q, state.v, state.a)?).for_each(|(r, x)| *r += x);
        Ok(())
    }

    fn has_acceleration(&self) -> bool {
        true
    }

    fn add_by_acceleration(&self, state: &State<'_>, matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
        let before = self.difference(state.q, state.v, state.a)?;
        for column in 0..self.nv() {
            let mut a = state.a.to_vec();
            a[column] += 1.0;
            let after = self.difference(state.q, state.v, &a)?;
            (0..self.nv()).for_each(|row| matrix[(row, column)] += after[row] - before[row]);
        }
        Ok(())
    }
}

/// An error if a count is not the expected one.
pub(crate) fn expect(what: &'static str, expected: usize, found: usize) -> Result<(), ResidualError> {
    Ok(featherbench_dynamics::DimensionError::expect(what, expected, found)?)
}

/// An error unless the three vectors of a state have n numbers.
pub(crate) fn expect_state(n: usize, q: &[f64], v: &[f64], x: &[f64]) -> Result<(), ResidualError> {
    expect("configuration q", n, q.len())?;
    expect("velocity v", n, v.len())?;
    expect("acceleration or joint forces", n, x.len())
}

/// The solution of M x = f for a small M that must be positive definite.
pub(crate) fn solved(mass: DMatrix<f64>, f: Vec<f64>) -> Result<Vec<f64>, ResidualError> {
    match mass.cholesky() {
        Some(factor) => Ok(factor.solve(&nalgebra::DVector::from_vec(f)).as_slice().to_vec()),
        None => Err(ResidualError::Indefinite { what: "the learned mass matrix", smallest: f64::NAN }),
    }
}
