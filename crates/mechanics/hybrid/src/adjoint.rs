//! The gradient of a function of a run's end and of its event times, backward: the discrete adjoint.
//!
//! It goes through the records of a run from the last to the first. Each step is pulled back stage by stage, each event by Ξᵀ. So the
//! gradient is that of the numbers that the run gave, for any number of parameters at the cost of one pass.

use crate::error::{HybridError, expect};
use crate::extrapolation::Extrapolation;
use crate::run::{Record, Run};
use crate::saltation::Saltation;
use crate::system::Hybrid;
use featherbench_spatial::Real;

/// A gradient with respect to the start and the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient<T> {
    /// n numbers.
    pub state: Vec<T>,
    /// p numbers.
    pub parameters: Vec<T>,
}

/// The gradient of φ(x(end), t*₁, t*₂, …) from its derivatives: `of_state` has n numbers, `of_times` one per event.
///
/// ```
/// use featherbench_hybrid::systems::BouncingBall;
/// use featherbench_hybrid::{Settings, Start, adjoint, simulate};
/// let (theta, start) = ([9.81, 0.8], Start { mode: 0, time: 0.0, state: vec![1.0, 0.0, 0.0] });
/// let run = simulate(&BouncingBall, &theta, &start, 0.7, &Settings::default())?;
/// // The speed after one bounce grows with e by the speed before it.
/// let gradient = adjoint(&BouncingBall, &theta, &run, &[0.0, 1.0, 0.0], &[0.0])?;
/// assert!((gradient.parameters[1] - (2.0_f64 * 9.81).sqrt()).abs() < 1e-13);
/// # Ok::<(), featherbench_hybrid::HybridError>(())
/// ```
///
/// # Errors
/// [`HybridError`] if the lists do not fit, or an event has no derivative.
pub fn adjoint<S: Hybrid, T: Real>(
    system: &S,
    theta: &[T],
    run: &Run<T>,
    of_state: &[T],
    of_times: &[T],
) -> Result<Gradient<T>, HybridError> {
    expect("parameters", theta, system.parameters())?;
    run.expect(system)?;
    expect("of_state", of_state, system.states())?;
    expect("of_times", of_times, run.events.len())?;
    let method = Extrapolation::new(run.columns);
    let (mut state, mut parameters) = (of_state.to_vec(), vec![T::zero(); theta.len()]);
    for record in run.records.iter().rev() {
        match record {
            Record::Step(step) => method.pull(system, theta, step, &mut state, &mut parameters),
            Record::Event(index) => {
                let saltation = Saltation::of(system, theta, &run.events[*index])?;
                state = saltation.pull(&state, of_times[*index], &mut parameters);
            }
        }
    }
    Ok(Gradient { state, parameters })
}
