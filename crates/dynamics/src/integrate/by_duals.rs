//! The right-hand side with its derivatives: the interface, and one that uses dual numbers.
//!
//! Computes a(t, q, v, u), and ∂a/∂q on the tangent space of q, ∂a/∂v, ∂a/∂u. Inputs u are the controls, then the parameters.
//! Source: forward-mode differentiation, one direction at a time; the direction δq enters as `q ⊕ ε δq`.
//! Shapes: matrices are dense, row after row, `nv` rows. Units: as in [`crate::Aba`].
//! Cost: 2·nv + inputs times that of [`crate::Aba::run`] over duals, about twice as many operations. A call does not allocate.

use super::dynamics::{Acceleration, Dynamics, System};
use crate::error::expect;
use crate::{DimensionError, Error};
use featherbench_model::{Model, Topology};
use featherbench_spatial::{Angle, Dual, Lift, Real};

/// The derivatives of the acceleration at one state.
#[derive(Clone, Debug)]
pub struct Linearisation<T> {
    /// ∂a/∂q, on the tangent space of q: nv × nv, row after row.
    pub by_q: Vec<T>,
    /// ∂a/∂v: nv × nv.
    pub by_v: Vec<T>,
    /// ∂a/∂u: nv × inputs.
    pub by_input: Vec<T>,
}

impl<T: Real> Linearisation<T> {
    /// Room for a tree of this many dofs with this many inputs.
    pub fn new(nv: usize, inputs: usize) -> Self {
        let zeros = |count| vec![T::zero(); count];
        Self { by_q: zeros(nv * nv), by_v: zeros(nv * nv), by_input: zeros(nv * inputs) }
    }
}

/// An acceleration that depends on inputs, with its derivatives.
pub trait Linearise<T>: Acceleration<T> {
    /// The number of controls.
    fn controls(&self) -> usize;

    /// The number of parameters.
    fn parameters(&self) -> usize;

    /// Gives the controls these values.
    ///
    /// # Errors
    /// [`DimensionError`] when there are more or fewer.
    fn set_controls(&mut self, controls: &[T]) -> Result<(), DimensionError>;

    /// Gives the parameters these values.
    ///
    /// # Errors
    /// [`DimensionError`] when there are more or fewer.
    fn set_parameters(&mut self, parameters: &[T]) -> Result<(), DimensionError>;

    /// The acceleration `a` with its derivatives.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit, or a joint meets no inertia.
    fn linearise(&mut self, t: T, q: &[T], v: &[T], a: &mut [T], result: &mut Linearisation<T>) -> Result<(), Error>;
}

/// [`Dynamics`] and their derivatives by dual numbers.
#[derive(Clone, Debug)]
pub struct ByDuals<S, T> {
    plain: Dynamics<S, T>,
    dual: Dynamics<S, Dual<T>>,
    topology: Topology,
    controls: Vec<Dual<T>>,
    parameters: Vec<Dual<T>>,
    q: Vec<Dual<T>>,
    v: Vec<Dual<T>>,
    a: Vec<Dual<T>>,
}

impl<S: System + Clone, T: Angle> ByDuals<S, T>
where
    f64: Lift<T>,
{
    /// The dynamics of a model under a system, with these values of its parameters and controls of zero.
    ///
    /// # Errors
    /// [`DimensionError`] when the number of parameters is not the system's.
    pub fn new(model: &Model<f64>, system: S, parameters: &[T]) -> Result<Self, DimensionError>
    where
        f64: Lift<Dual<T>>,
    {
        let topology = model.topology.clone();
        let constants = |values: &[T]| values.iter().map(|x| Dual::constant(*x)).collect::<Vec<_>>();
        let (controls, parameters_dual) = (constants(&vec![T::zero(); system.controls()]), constants(parameters));
        let zeros = |count| constants(&vec![T::zero(); count]);
        Ok(Self {
            plain: Dynamics::new(model, system.clone(), parameters)?,
            dual: Dynamics::new(model, system, &parameters_dual)?,
            controls,
            parameters: parameters_dual,
            q: zeros(topology.nq()),
            v: zeros(topology.nv()),
            a: zeros(topology.nv()),
            topology,
        })
    }
}

impl<S: System, T: Angle> ByDuals<S, T> {
    /// The derivative of a in the direction that the duals now have, into column `column` of a matrix with `width` columns.
    fn column(&mut self, t: T, matrix: &mut [T], width: usize, column: usize) -> Result<(), Error> {
        self.dual.acceleration(Dual::constant(t), &self.q, &self.v, &mut self.a)?;
        for (row, a) in self.a.iter().enumerate() {
            matrix[row * width + column] = a.derivative;
        }
        Ok(())
    }
}

impl<S: System, T: Angle> Acceleration<T> for ByDuals<S, T> {
    fn acceleration(&mut self, t: T, q: &[T], v: &[T], a: &mut [T]) -> Result<(), Error> {
        self.plain.acceleration(t, q, v, a)
    }
}

impl<S: System, T: Angle> Linearise<T> for ByDuals<S, T> {
    fn controls(&self) -> usize {
        self.controls.len()
    }

    fn parameters(&self) -> usize {
        self.parameters.len()
    }

    fn set_controls(&mut self, controls: &[T]) -> Result<(), DimensionError> {
        self.plain.set_controls(controls)?;
        copy(&mut self.controls, controls);
        self.dual.set_controls(&self.controls)
    }

    fn set_parameters(&mut self, parameters: &[T]) -> Result<(), DimensionError> {
        self.plain.set_parameters(parameters)?;
        copy(&mut self.parameters, parameters);
        self.dual.set_parameters(&self.parameters)
    }

    fn linearise(&mut self, t: T, q: &[T], v: &[T], a: &mut [T], result: &mut Linearisation<T>) -> Result<(), Error> {
        let nv = self.topology.nv();
        let (controls, parameters) = (self.controls.len(), self.parameters.len());
        let inputs = controls + parameters;
        expect("derivatives by q", nv * nv, result.by_q.len())?;
        expect("derivatives by v", nv * nv, result.by_v.len())?;
        expect("derivatives by inputs", nv * inputs, result.by_input.len())?;
        self.plain.acceleration(t, q, v, a)?;
        copy(&mut self.q, q);
        copy(&mut self.v, v);

        for joint in 0..self.topology.bodies() {
            let joint = self.topology.joints()[joint];
            let (at, width) = (joint.q, joint.kind.nq());
            let mut still = [Dual::constant(T::zero()); 7];
            still[..width].copy_from_slice(&self.q[at..at + width]);
            for k in 0..joint.kind.nv() {
                let mut direction = [Dual::constant(T::zero()); 6];
                direction[k].derivative = T::one();
                joint.kind.integrate(&still, &direction, &mut self.q[at..]);
                self.column(t, &mut result.by_q, nv, joint.v + k)?;
            }
            self.q[at..at + width].copy_from_slice(&still[..width]);
        }
        for dof in 0..nv {
            self.v[dof].derivative = T::one();
            self.column(t, &mut result.by_v, nv, dof)?;
            self.v[dof].derivative = T::zero();
        }
        for k in 0..controls {
            self.controls[k].derivative = T::one();
            self.dual.set_controls(&self.controls)?;
            self.column(t, &mut result.by_input, inputs, k)?;
            self.controls[k].derivative = T::zero();
        }
        self.dual.set_controls(&self.controls)?;
        for k in 0..parameters {
            self.parameters[k].derivative = T::one();
            self.dual.set_parameters(&self.parameters)?;
            self.column(t, &mut result.by_input, inputs, controls + k)?;
            self.parameters[k].derivative = T::zero();
        }
        if parameters > 0 {
            self.dual.set_parameters(&self.parameters)?;
        }
        Ok(())
    }
}

/// Values as constants.
pub(super) fn copy<T: Real>(duals: &mut [Dual<T>], values: &[T]) {
    for (dual, value) in duals.iter_mut().zip(values) {
        *dual = Dual::constant(*value);
    }
}
