//! The derivative of a whole run, forward: the variational equation between events, and saltation at them.
//!
//! Between events each step is differentiated as it was taken: a direction is pushed through its stages by dual numbers. At an event the
//! direction becomes Ξ δx + Ξ_θ δθ. So the result is the derivative of the state at the fixed time [`Run::time`], and of each event time,
//! to the rounding of the numbers and the error of the integrator. A run that ended at an event gives the derivative right after it.

use crate::error::{HybridError, expect};
use crate::extrapolation::Extrapolation;
use crate::run::{Record, Run, Step};
use crate::saltation::Saltation;
use crate::system::{Hybrid, constants, moving};
use featherbench_spatial::{Dual, Real};

/// The derivative of a run with respect to n states at its start and p parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity<T> {
    /// The columns of ∂x/∂x₀ and then of ∂x/∂θ: n + p, each of n numbers.
    pub columns: Vec<Vec<T>>,
    /// For each event ∂t*/∂x₀ and then ∂t*/∂θ: n + p numbers.
    pub times: Vec<Vec<T>>,
}

/// The derivative of a run.
///
/// ```
/// use featherbench_hybrid::systems::BouncingBall;
/// use featherbench_hybrid::{Settings, Start, sensitivity, simulate};
/// // One bounce of a ball from rest: t₁ = √(2h/g), so ∂t₁/∂h = t₁/(2h).
/// let (theta, start) = ([9.81, 0.8], Start { mode: 0, time: 0.0, state: vec![1.0, 0.0, 0.0] });
/// let run = simulate(&BouncingBall, &theta, &start, 0.7, &Settings::default())?;
/// let derivative = sensitivity(&BouncingBall, &theta, &run)?;
/// let known: f64 = 0.5 * run.events[0].time;
/// assert!((derivative.times[0][0] - known).abs() < 1e-14);
/// # Ok::<(), featherbench_hybrid::HybridError>(())
/// ```
///
/// # Errors
/// [`HybridError`] if the run is another system's, or an event has no derivative.
pub fn sensitivity<S: Hybrid, T: Real>(system: &S, theta: &[T], run: &Run<T>) -> Result<Sensitivity<T>, HybridError> {
    expect("parameters", theta, system.parameters())?;
    run.expect(system)?;
    let (states, inputs) = (system.states(), system.states() + system.parameters());
    let unit = |input: usize, index: usize| if input == index { T::one() } else { T::zero() };
    let mut columns: Vec<Vec<T>> = (0..inputs).map(|input| (0..states).map(|k| unit(input, k)).collect()).collect();
    let parameters: Vec<Vec<T>> = (0..inputs).map(|input| (0..theta.len()).map(|k| unit(input, states + k)).collect()).collect();
    let method = Extrapolation::new(run.columns);
    let mut times = Vec::new();
    for record in &run.records {
        match record {
            Record::Step(step) => {
                for (column, parameters) in columns.iter_mut().zip(&parameters) {
                    *column = push(system, theta, &method, step, column, parameters);
                }
            }
            Record::Event(index) => {
                let saltation = Saltation::of(system, theta, &run.events[*index])?;
                let pushed: Vec<(Vec<T>, T)> =
                    columns.iter().zip(&parameters).map(|(column, parameters)| saltation.push(column, parameters)).collect();
                let (after, time) = pushed.into_iter().unzip();
                columns = after;
                times.push(time);
            }
        }
    }
    Ok(Sensitivity { columns, times })
}

/// The derivative of a step times a direction.
fn push<S: Hybrid, T: Real>(
    system: &S,
    theta: &[T],
    method: &Extrapolation<Dual<T>>,
    step: &Step<T>,
    deviation: &[T],
    parameters: &[T],
) -> Vec<T> {
    let (x, theta) = (moving(&step.state, deviation), moving(theta, parameters));
    let (time, length) = (Dual::constant(step.time), Dual::constant(step.length));
    let mut first = constants(&step.state);
    system.flow(step.mode, time, &x, &theta, &mut first);
    let field = |t: Dual<T>, x: &[Dual<T>], rate: &mut [Dual<T>]| system.flow(step.mode, t, x, &theta, rate);
    method.step(field, time, length, &x, &first).end.iter().map(|number| number.derivative).collect()
}
