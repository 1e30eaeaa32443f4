//! Sensitivities forward along a trajectory: the derivative of its end in given directions of its variables.
//!
//! Computes `δx_{k+1} = ∂Φ/∂x δx_k + ∂Φ/∂u δu_k` for the discrete step Φ of an integrator: the variational equation of the steps, not of the
//! differential equation. Source: Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I* (1993), §I.14.
//! Shapes: a direction has [`Rollout::variables`] numbers; the derivative of the end has `2·nv`, the tangent of q, then v.
//! Cost: one linearised step per step, and `O(nv²)` per stage and direction. [`Forward::run`] does not allocate.

use super::{IntegrationError, Integrator, Linearise, Rollout};
use crate::error::expect;
use featherbench_model::Topology;
use featherbench_spatial::Angle;

/// The workspace of sensitivities.
#[derive(Clone, Debug)]
pub struct Forward<T> {
    topology: Topology,
    q: Vec<T>,
    v: Vec<T>,
    inputs: Vec<T>,
}

impl<T: Angle> Forward<T> {
    /// A workspace for trajectories of this tree with this many controls and parameters together.
    pub fn new(topology: &Topology, inputs: usize) -> Self {
        let zeros = |count| vec![T::zero(); count];
        Self { topology: topology.clone(), q: zeros(topology.nq()), v: zeros(topology.nv()), inputs: zeros(inputs) }
    }

    /// The state at the end.
    pub fn end(&self) -> (&[T], &[T]) {
        (&self.q, &self.v)
    }

    /// The derivatives of the end, one after another, for directions one after another.
    ///
    /// # Errors
    /// [`IntegrationError`] when an argument does not fit, or of the first step that fails.
    pub fn run<I: Integrator<T>, F: Linearise<T>>(
        &mut self,
        integrator: &mut I,
        f: &mut F,
        rollout: &Rollout<'_, T>,
        directions: &[T],
        result: &mut [T],
    ) -> Result<(), IntegrationError> {
        rollout.begin(&self.topology, f)?;
        let (nv, variables, controls) = (self.topology.nv(), rollout.variables(), f.controls());
        let count = directions.len() / variables;
        expect("directions", count * variables, directions.len())?;
        expect("derivatives of the end", count * 2 * nv, result.len())?;
        expect("inputs of the workspace", controls + f.parameters(), self.inputs.len())?;
        self.q.copy_from_slice(rollout.q);
        self.v.copy_from_slice(rollout.v);
        for (direction, result) in directions.chunks_exact(variables).zip(result.chunks_exact_mut(2 * nv)) {
            result.copy_from_slice(&direction[..2 * nv]);
        }
        let mut t = rollout.start;
        for (step, &h) in rollout.steps.iter().enumerate() {
            f.set_controls(rollout.controls_of(step))?;
            integrator.linearise(f, t, h, &mut self.q, &mut self.v)?;
            t += h;
            for (direction, result) in directions.chunks_exact(variables).zip(result.chunks_exact_mut(2 * nv)) {
                self.inputs[..controls].copy_from_slice(&direction[rollout.place_of_controls(step)]);
                self.inputs[controls..].copy_from_slice(&direction[rollout.place_of_parameters()]);
                let (dq, dv) = result.split_at_mut(nv);
                integrator.push(dq, dv, &self.inputs);
            }
        }
        Ok(())
    }
}

/// The derivatives of the end of a trajectory in these directions ([`Forward::run`]); it allocates.
///
/// # Errors
/// [`IntegrationError`] when an argument does not fit, or of the first step that fails.
pub fn sensitivity<T: Angle, I: Integrator<T>, F: Linearise<T>>(
    topology: &Topology,
    integrator: &mut I,
    f: &mut F,
    rollout: &Rollout<'_, T>,
    directions: &[T],
) -> Result<Vec<T>, IntegrationError> {
    let mut result = vec![T::zero(); directions.len() / rollout.variables() * 2 * topology.nv()];
    Forward::new(topology, f.controls() + f.parameters()).run(integrator, f, rollout, directions, &mut result)?;
    Ok(result)
}
