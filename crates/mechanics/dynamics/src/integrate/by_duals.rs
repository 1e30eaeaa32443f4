//! The right-hand side with its derivatives: the interface, and one that uses dual numbers.
//!
//! Computes a(t, q, v, u), and ∂a/∂q on the tangent space of q, ∂a/∂v, ∂a/∂u. Inputs u are the controls, then the parameters.
//! Source: forward-mode differentiation, one direction at a time; the direction δq enters as `q ⊕ ε δq`.
//! Shapes: matrices are dense, row after row, `nv` rows. Units: as in [`crate::Aba`].
//! Cost: 2·nv + inputs times that of [`crate::Aba::run`] over duals, about twice as many operations. A call does not allocate.

use super::directions::{Directions, Input, copy};
use super::dynamics::{Acceleration, Dynamics, System};
use crate::error::expect;
use crate::{DimensionError, Error};
use featherbench_model::Model;
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

    /// An error if the matrices have other sizes.
    pub(super) fn expect_size(&self, nv: usize, inputs: usize) -> Result<(), DimensionError> {
        expect("derivatives by q", nv * nv, self.by_q.len())?;
        expect("derivatives by v", nv * nv, self.by_v.len())?;
        expect("derivatives by inputs", nv * inputs, self.by_input.len())
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

/// Gives the inputs of `at` to dynamics over duals, in a direction of `input`.
fn enter<S: System, T: Angle>(f: &mut Dynamics<S, Dual<T>>, at: &Directions<T>, input: Input) -> Result<(), DimensionError> {
    // also before a parameter: without the rate of the last control
    f.set_controls(&at.controls)?;
    if input == Input::Parameter { f.set_parameters(&at.parameters) } else { Ok(()) }
}

/// Takes the rates away after the last direction of an input.
fn leave<S: System, T: Angle>(f: &mut Dynamics<S, Dual<T>>, at: &Directions<T>) -> Result<(), DimensionError> {
    f.set_controls(&at.controls)?;
    f.set_parameters(&at.parameters)
}

/// [`Dynamics`] and their derivatives by dual numbers.
#[derive(Clone, Debug)]
pub struct ByDuals<S, T> {
    plain: Dynamics<S, T>,
    dual: Dynamics<S, Dual<T>>,
    directions: Directions<T>,
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
        let directions = Directions::new(model.topology.clone(), system.controls(), parameters);
        Ok(Self {
            plain: Dynamics::new(model, system.clone(), parameters)?,
            dual: Dynamics::new(model, system, &directions.parameters)?,
            a: vec![Dual::constant(T::zero()); model.topology.nv()],
            directions,
        })
    }
}

impl<S: System, T: Angle> Acceleration<T> for ByDuals<S, T> {
    fn acceleration(&mut self, t: T, q: &[T], v: &[T], a: &mut [T]) -> Result<(), Error> {
        self.plain.acceleration(t, q, v, a)
    }
}

impl<S: System, T: Angle> Linearise<T> for ByDuals<S, T> {
    fn controls(&self) -> usize {
        self.directions.controls.len()
    }

    fn parameters(&self) -> usize {
        self.directions.parameters.len()
    }

    fn set_controls(&mut self, controls: &[T]) -> Result<(), DimensionError> {
        self.plain.set_controls(controls)?;
        copy(&mut self.directions.controls, controls);
        self.dual.set_controls(&self.directions.controls)
    }

    fn set_parameters(&mut self, parameters: &[T]) -> Result<(), DimensionError> {
        self.plain.set_parameters(parameters)?;
        copy(&mut self.directions.parameters, parameters);
        self.dual.set_parameters(&self.directions.parameters)
    }

    fn linearise(&mut self, t: T, q: &[T], v: &[T], a: &mut [T], result: &mut Linearisation<T>) -> Result<(), Error> {
        let Self { plain, dual, directions, a: rates, .. } = self;
        let (nv, inputs) = (rates.len(), directions.inputs());
        result.expect_size(nv, inputs)?;
        plain.acceleration(t, q, v, a)?;
        directions.set_state(q, v)?;

        // The derivative of a in the direction that the duals have, into a column of a matrix of this width.
        let mut column = |dual: &mut Dynamics<S, Dual<T>>, at: &Directions<T>, matrix: &mut [T], width: usize, column: usize| {
            dual.acceleration(Dual::constant(t), &at.q, &at.v, rates)?;
            rates.iter().enumerate().for_each(|(row, a)| matrix[row * width + column] = a.derivative);
            Ok(())
        };
        directions.by_q(|at, k| column(dual, at, &mut result.by_q, nv, k))?;
        directions.by_v(|at, k| column(dual, at, &mut result.by_v, nv, k))?;
        directions.by_inputs(|at, input, k| {
            enter(dual, at, input)?;
            column(dual, at, &mut result.by_input, inputs, k)
        })?;
        Ok(leave(dual, directions)?)
    }
}
