//! The right-hand side v̇ = a(t, q, v): forward dynamics with forces that depend on time, state, controls and parameters.
//!
//! Computes: a = M⁻¹ (τ − h + Σ Jᵀf) by [`Aba`], with τ and f from a [`System`]. Frames, shapes and units: as in [`Aba`].
//! Cost: that of [`Aba::run`] and of the system's forces. A call does not allocate.

use crate::error::expect;
use crate::{Aba, DimensionError, Error};
use featherbench_model::Model;
use featherbench_spatial::{Angle, Force, Lift};

/// The acceleration of a state.
///
/// Closures of the same arguments have it too.
pub trait Acceleration<T> {
    /// The acceleration `a` at time `t`, configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`Error`] when an argument does not fit, or a joint meets no inertia.
    fn acceleration(&mut self, t: T, q: &[T], v: &[T], a: &mut [T]) -> Result<(), Error>;
}

impl<T, F: FnMut(T, &[T], &[T], &mut [T]) -> Result<(), Error>> Acceleration<T> for F {
    fn acceleration(&mut self, t: T, q: &[T], v: &[T], a: &mut [T]) -> Result<(), Error> {
        self(t, q, v, a)
    }
}

/// What forces may depend on.
#[derive(Clone, Copy, Debug)]
pub struct Instant<'a, T> {
    /// The time.
    pub time: T,
    /// The configuration.
    pub q: &'a [T],
    /// The velocity.
    pub v: &'a [T],
    /// The controls, constant during a step.
    pub controls: &'a [T],
    /// The parameters, constant for all time.
    pub parameters: &'a [T],
}

/// What acts on a robot, and which of its numbers are parameters.
///
/// The text is generic over the scalar. So it can be differentiated by duals.
pub trait System {
    /// The number of controls.
    fn controls(&self) -> usize {
        0
    }

    /// The number of parameters.
    fn parameters(&self) -> usize {
        0
    }

    /// Whether external wrenches act. If not, `wrenches` of [`System::forces`] is empty.
    fn has_wrenches(&self) -> bool {
        false
    }

    /// Adds the joint forces to `tau`, and the external wrenches [moment; force] to `wrenches`: one per compiled body, in its described axes at
    /// its origin.
    fn forces<T: Angle>(&self, at: &Instant<'_, T>, tau: &mut [T], wrenches: &mut [Force<T>]);

    /// Writes the parameters into the model, for example masses.
    fn adjust<T: Angle>(&self, _parameters: &[T], _model: &mut Model<T>) {}
}

/// No forces but gravity.
#[derive(Clone, Copy, Debug, Default)]
pub struct Passive;

impl System for Passive {
    fn forces<T: Angle>(&self, _: &Instant<'_, T>, _: &mut [T], _: &mut [Force<T>]) {}
}

/// One control per motor: the force or torque of a dof.
#[derive(Clone, Debug, Default)]
pub struct Motors {
    /// The dof of each motor.
    pub dofs: Vec<usize>,
}

impl System for Motors {
    fn controls(&self) -> usize {
        self.dofs.len()
    }

    fn forces<T: Angle>(&self, at: &Instant<'_, T>, tau: &mut [T], _: &mut [Force<T>]) {
        for (&dof, &control) in self.dofs.iter().zip(at.controls) {
            tau[dof] += control;
        }
    }
}

/// A model with a system of forces: the usual right-hand side of integrators, with its workspace.
#[derive(Clone, Debug)]
pub struct Dynamics<S, T> {
    system: S,
    model: Model<T>,
    aba: Aba<T>,
    tau: Vec<T>,
    wrenches: Vec<Force<T>>,
    controls: Vec<T>,
    parameters: Vec<T>,
}

impl<S: System, T: Angle> Dynamics<S, T>
where
    f64: Lift<T>,
{
    /// The dynamics of a model under a system, with these values of its parameters and controls of zero.
    ///
    /// # Errors
    /// [`DimensionError`] when the number of parameters is not the system's.
    pub fn new(model: &Model<f64>, system: S, parameters: &[T]) -> Result<Self, DimensionError> {
        let (topology, zero) = (&model.topology, T::zero());
        let mut dynamics = Self {
            aba: Aba::new(topology),
            tau: vec![zero; topology.nv()],
            wrenches: vec![Force::zero(); if system.has_wrenches() { topology.bodies() } else { 0 }],
            controls: vec![zero; system.controls()],
            parameters: vec![zero; system.parameters()],
            model: model.lift(),
            system,
        };
        dynamics.set_parameters(parameters)?;
        Ok(dynamics)
    }
}

impl<S: System, T: Angle> Dynamics<S, T> {
    /// Gives the controls these values.
    ///
    /// # Errors
    /// [`DimensionError`] when there are more or fewer than the system has.
    pub fn set_controls(&mut self, controls: &[T]) -> Result<(), DimensionError> {
        expect("controls", self.controls.len(), controls.len())?;
        self.controls.copy_from_slice(controls);
        Ok(())
    }

    /// Gives the parameters these values, in the model too.
    ///
    /// # Errors
    /// [`DimensionError`] when there are more or fewer than the system has.
    pub fn set_parameters(&mut self, parameters: &[T]) -> Result<(), DimensionError> {
        expect("parameters", self.parameters.len(), parameters.len())?;
        self.parameters.copy_from_slice(parameters);
        self.system.adjust(&self.parameters, &mut self.model);
        Ok(())
    }

    /// The joint forces and wrenches of a state; slices of the sizes of the model.
    pub(super) fn forces(&self, t: T, q: &[T], v: &[T], tau: &mut [T], wrenches: &mut [Force<T>]) {
        tau.fill(T::zero());
        wrenches.fill(Force::zero());
        let Self { system, controls, parameters, .. } = self;
        system.forces(&Instant { time: t, q, v, controls, parameters }, tau, wrenches);
    }

    /// The model with its parameters.
    pub fn model(&self) -> &Model<T> {
        &self.model
    }
}

impl<S: System, T: Angle> Acceleration<T> for Dynamics<S, T> {
    fn acceleration(&mut self, t: T, q: &[T], v: &[T], a: &mut [T]) -> Result<(), Error> {
        let Self { system, model, aba, tau, wrenches, controls, parameters, .. } = self;
        expect("configuration q", model.topology.nq(), q.len())?;
        expect("velocity v", model.topology.nv(), v.len())?;
        tau.fill(T::zero());
        wrenches.fill(Force::zero());
        system.forces(&Instant { time: t, q, v, controls, parameters }, tau, wrenches);
        aba.run(model, q, v, tau, if wrenches.is_empty() { None } else { Some(wrenches) }, a)
    }
}
