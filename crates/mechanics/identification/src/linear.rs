//! The model that is linear in its unknowns: `τ = Y(q, v, v̇) θ`.

use crate::unknowns::{Dof, Kind, Terms, Unknown, dofs, positions, unknowns};
use crate::{IdentificationError, Samples};
use featherbench_dynamics::{DimensionError, PARAMETERS, Regressor, RegressorMatrix, inertial_parameters};
use featherbench_model::{Description, Model};
use nalgebra::DMatrix;

/// A robot as identification sees it: its torques are linear in the unknowns θ.
///
/// ```text
/// τ = Y(q, v, v̇) π + I_a ∘ v̇ + f_v ∘ v + f_c ∘ sign(v) + f_0
/// ```
///
/// θ is π (ten numbers per body), followed by those of the [`Terms`] that are identified. What is not identified and not zero in the
/// description (armature, damping, dry friction) is taken as known: [`LinearModel::known`] gives its torques.
#[derive(Clone, Debug)]
pub struct LinearModel {
    description: Description,
    model: Model<f64>,
    terms: Terms,
    dofs: Vec<Dof>,
    positions: Vec<String>,
    unknowns: Vec<Unknown>,
}

impl LinearModel {
    /// The linear model of a robot.
    ///
    /// # Errors
    /// [`IdentificationError::Malformed`] when the description is no robot.
    pub fn new(description: &Description, terms: Terms) -> Result<Self, IdentificationError> {
        let description = description.canonical()?;
        let model = Model::build(&description)?;
        let (dofs, positions) = (dofs(&description), positions(&description));
        let unknowns = unknowns(description.bodies.len(), &dofs, terms);
        Ok(Self { description, model, terms, dofs, positions, unknowns })
    }

    /// The canonical description.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The compiled model.
    pub fn model(&self) -> &Model<f64> {
        &self.model
    }

    /// What is identified beside the inertial parameters.
    pub fn terms(&self) -> Terms {
        self.terms
    }

    /// The dofs, as logs name them.
    pub fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// The names of the numbers of q, as logs have them.
    pub fn positions(&self) -> &[String] {
        &self.positions
    }

    /// The unknowns, in the order of θ.
    pub fn unknowns(&self) -> &[Unknown] {
        &self.unknowns
    }

    /// The values of θ that the description states; an offset is 0.
    pub fn nominal(&self) -> Vec<f64> {
        let pi: Vec<f64> = inertial_parameters(&self.model);
        let value = |unknown: &Unknown| match unknown.kind {
            Kind::Inertial(which) => pi[PARAMETERS * unknown.of + which],
            Kind::Armature => self.model.armature[unknown.of],
            Kind::Viscous => self.model.damping[unknown.of],
            Kind::Coulomb => self.model.friction[unknown.of],
            Kind::Offset => 0.0,
        };
        self.unknowns.iter().map(value).collect()
    }

    /// The torque that is not identified: armature, damping and dry friction of the description, as far as they are no unknowns.
    pub fn known(&self, dof: usize, v: f64, a: f64) -> f64 {
        let plain = self.dofs[dof].position.is_some();
        let known = |identified: bool, coefficient: f64, column: f64| if identified && plain { 0.0 } else { coefficient * column };
        known(self.terms.armature, self.model.armature[dof], a)
            + known(self.terms.viscous, self.model.damping[dof], v)
            + known(self.terms.coulomb, self.model.friction[dof], sign(v))
    }

    /// The torques of parameters θ at each sample, `count × nv`.
    ///
    /// # Errors
    /// [`IdentificationError`] when θ or the samples do not fit the robot.
    pub fn torques(&self, samples: &Samples, theta: &[f64]) -> Result<Vec<f64>, IdentificationError> {
        samples.check(self)?;
        if theta.len() != self.unknowns.len() {
            let (found, expected) = (theta.len(), self.unknowns.len());
            return Err(IdentificationError::Length { array: "theta", found, samples: 1, expected });
        }
        let mut rows = Rows::new(self);
        let mut torques = Vec::with_capacity(samples.tau.len());
        for k in 0..samples.count() {
            let (q, v, a) = samples.state(self, k);
            let block = rows.at(self, q, v, a)?;
            for (dof, row) in block.row_iter().enumerate() {
                let sum: f64 = row.iter().zip(theta).map(|(y, x)| y * x).sum();
                torques.push(sum + self.known(dof, v[dof], a[dof]));
            }
        }
        Ok(torques)
    }
}

/// The sign, 0 at rest.
pub(crate) fn sign(v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { v.signum() }
}

/// The workspace of the rows of one state.
#[derive(Clone, Debug)]
pub struct Rows {
    regressor: Regressor<f64>,
    matrix: RegressorMatrix<f64>,
    block: DMatrix<f64>,
}

impl Rows {
    /// A workspace for a robot.
    pub fn new(linear: &LinearModel) -> Self {
        let (model, unknowns) = (&linear.model, linear.unknowns.len());
        let block = DMatrix::zeros(model.topology.nv(), unknowns);
        Self { regressor: Regressor::new(&model.topology), matrix: RegressorMatrix::new(model), block }
    }

    /// The rows of one state: `nv` × unknowns.
    pub fn at(&mut self, linear: &LinearModel, q: &[f64], v: &[f64], a: &[f64]) -> Result<&DMatrix<f64>, DimensionError> {
        self.regressor.torque(&linear.model, q, v, a, &mut self.matrix)?;
        self.block.fill(0.0);
        for (column, dofs, entries) in self.matrix.iter() {
            for (&dof, &entry) in dofs.iter().zip(entries) {
                self.block[(dof, column)] = entry;
            }
        }
        for (column, unknown) in linear.unknowns.iter().enumerate() {
            let dof = unknown.of;
            let entry = match unknown.kind {
                Kind::Inertial(_) => continue,
                Kind::Armature => a[dof],
                Kind::Viscous => v[dof],
                Kind::Coulomb => sign(v[dof]),
                Kind::Offset => 1.0,
            };
            self.block[(dof, column)] = entry;
        }
        Ok(&self.block)
    }
}
