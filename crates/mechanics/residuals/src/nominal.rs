//! A nominal model: any rigid-body dynamics that a residual corrects.

use crate::ResidualError;
use featherbench_dynamics::{Aba, Crba, Rnea, TreeSparse};
use featherbench_model::Model;
use nalgebra::DMatrix;

/// Rigid-body dynamics of a robot: inverse and forward dynamics, and the mass matrix. Coordinates, frames and units are those of
/// CONVENTIONS.md.
pub trait Nominal {
    /// The length of q.
    fn nq(&self) -> usize;

    /// Degrees of freedom.
    fn nv(&self) -> usize;

    /// τ = M(q) a + h(q, v), into `tau`.
    ///
    /// # Errors
    /// [`ResidualError`] when an argument does not fit or there is no answer.
    fn inverse(&mut self, q: &[f64], v: &[f64], a: &[f64], tau: &mut [f64]) -> Result<(), ResidualError>;

    /// a = M⁻¹(τ − h), into `a`.
    ///
    /// # Errors
    /// As [`Nominal::inverse`].
    fn forward(&mut self, q: &[f64], v: &[f64], tau: &[f64], a: &mut [f64]) -> Result<(), ResidualError>;

    /// M(q), both triangles.
    ///
    /// # Errors
    /// As [`Nominal::inverse`].
    fn mass_matrix(&mut self, q: &[f64]) -> Result<DMatrix<f64>, ResidualError>;
}

/// Our own kernels: RNEA, ABA and CRBA.
#[derive(Clone, Debug)]
pub struct Rigid<'a> {
    model: &'a Model<f64>,
    rnea: Rnea<f64>,
    aba: Aba<f64>,
    crba: Crba<f64>,
    matrix: TreeSparse<f64>,
}

impl<'a> Rigid<'a> {
    /// The dynamics of a model.
    pub fn new(model: &'a Model<f64>) -> Self {
        let tree = &model.topology;
        Self { model, rnea: Rnea::new(tree), aba: Aba::new(tree), crba: Crba::new(tree), matrix: TreeSparse::new(tree) }
    }

    /// The model.
    pub fn model(&self) -> &'a Model<f64> {
        self.model
    }
}

impl Nominal for Rigid<'_> {
    fn nq(&self) -> usize {
        self.model.topology.nq()
    }

    fn nv(&self) -> usize {
        self.model.topology.nv()
    }

    fn inverse(&mut self, q: &[f64], v: &[f64], a: &[f64], tau: &mut [f64]) -> Result<(), ResidualError> {
        Ok(self.rnea.run(self.model, q, v, a, None, tau)?)
    }

    fn forward(&mut self, q: &[f64], v: &[f64], tau: &[f64], a: &mut [f64]) -> Result<(), ResidualError> {
        Ok(self.aba.run(self.model, q, v, tau, None, a)?)
    }

    fn mass_matrix(&mut self, q: &[f64]) -> Result<DMatrix<f64>, ResidualError> {
        self.crba.run(self.model, q, &mut self.matrix)?;
        Ok(self.matrix.to_dense())
    }
}
