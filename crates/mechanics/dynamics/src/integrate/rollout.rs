//! A trajectory to compute: its start, the lengths of its steps, and its inputs.

use super::{IntegrationError, Integrator, Linearise};
use crate::DimensionError;
use crate::error::expect;
use featherbench_model::Topology;
use featherbench_spatial::Angle;

/// The numbers that determine a trajectory of a given robot and integrator.
///
/// Directions and gradients of a trajectory have its *variables* one after another: the tangent of q (`nv` numbers), v (`nv`), the controls of
/// each step, the parameters.
#[derive(Clone, Copy, Debug)]
pub struct Rollout<'a, T> {
    /// The time at the start.
    pub start: T,
    /// The length of each step.
    pub steps: &'a [T],
    /// The configuration at the start.
    pub q: &'a [T],
    /// The velocity at the start.
    pub v: &'a [T],
    /// The controls of the first step, of the second, …
    pub controls: &'a [T],
    /// The parameters.
    pub parameters: &'a [T],
}

impl<T: Angle> Rollout<'_, T> {
    /// The number of variables: `2·nv + controls + parameters`, the controls of all steps counted.
    pub fn variables(&self) -> usize {
        2 * self.v.len() + self.controls.len() + self.parameters.len()
    }

    /// The controls of a step.
    pub fn controls_of(&self, step: usize) -> &[T] {
        let each = self.controls_per_step();
        &self.controls[step * each..(step + 1) * each]
    }

    /// Checks the sizes against a tree and a right-hand side, and gives that the parameters.
    pub(super) fn begin<F: Linearise<T>>(&self, topology: &Topology, f: &mut F) -> Result<(), DimensionError> {
        expect("configuration q", topology.nq(), self.q.len())?;
        expect("velocity v", topology.nv(), self.v.len())?;
        expect("controls", f.controls() * self.steps.len(), self.controls.len())?;
        f.set_parameters(self.parameters)
    }

    /// Where the controls of a step are among the variables.
    pub(super) fn place_of_controls(&self, step: usize) -> std::ops::Range<usize> {
        let each = self.controls_per_step();
        let begin = 2 * self.v.len() + step * each;
        begin..begin + each
    }

    fn controls_per_step(&self) -> usize {
        self.controls.len().checked_div(self.steps.len()).unwrap_or(0)
    }

    /// Where the parameters are among the variables.
    pub(super) fn place_of_parameters(&self) -> std::ops::Range<usize> {
        self.variables() - self.parameters.len()..self.variables()
    }
}

/// The states of a trajectory, the start included: configurations and velocities, state after state; it allocates.
///
/// # Errors
/// [`IntegrationError`] of the first step that fails.
pub fn rollout<T: Angle, I: Integrator<T>, F: Linearise<T>>(
    topology: &Topology,
    integrator: &mut I,
    f: &mut F,
    rollout: &Rollout<'_, T>,
) -> Result<(Vec<T>, Vec<T>), IntegrationError> {
    rollout.begin(topology, f)?;
    let (mut t, mut q, mut v) = (rollout.start, rollout.q.to_vec(), rollout.v.to_vec());
    let (mut qs, mut vs) = (q.clone(), v.clone());
    for (step, &h) in rollout.steps.iter().enumerate() {
        f.set_controls(rollout.controls_of(step))?;
        integrator.step(f, t, h, &mut q, &mut v)?;
        t += h;
        qs.extend_from_slice(&q);
        vs.extend_from_slice(&v);
    }
    Ok((qs, vs))
}
