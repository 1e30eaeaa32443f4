//! Saltation: how an event changes small deviations of the state, and when it happens.
//!
//! With f₋ before and f₊ after the event, all at t*:
//!
//! ```text
//! ġ       = ∇g·f₋ + ∂g/∂t
//! δt*     = −(∇g δx + ∂g/∂θ δθ)/ġ
//! δx⁺     = DR δx + ∂R/∂θ δθ + (DR f₋ + ∂R/∂t − f₊) δt*  =  Ξ δx + Ξ_θ δθ
//! Ξ       = DR + (f₊ − DR f₋ − ∂R/∂t) ∇g/ġ
//! ```
//!
//! δx and δx⁺ are deviations at the nominal time t*, of the flows before and after the event. All derivatives are those of dual numbers.
//!
//! Sources: M. A. Aizerman and F. R. Gantmacher, *Determination of stability by linear approximation of a periodic solution of a system of
//! differential equations with discontinuous right-hand sides* (1958); N. J. Kong et al., *Saltation matrices: the essential tool for
//! linearizing hybrid dynamical systems* (Proceedings of the IEEE 112(6), 2024), with parameters and time added.

use crate::error::{HybridError, expect};
use crate::run::Event;
use crate::system::{Bound, Hybrid, constants, expect_mode, moving, seeded};
use featherbench_spatial::{Dual, Real};
use nalgebra::DMatrix;

/// The derivative of an event with n states and p parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Saltation<T> {
    /// The columns of Ξ and then of Ξ_θ: n + p, each of n numbers.
    pub columns: Vec<Vec<T>>,
    /// ∂t*/∂x and then ∂t*/∂θ: n + p numbers.
    pub time: Vec<T>,
}

impl<T: Real> Saltation<T> {
    /// The saltation of a guard that is met with the state `before`; `target` is the mode after.
    ///
    /// # Errors
    /// [`HybridError::Tangent`] where ġ = 0: Ξ grows as 1/ġ, and nothing clips it. Others if the arguments do not fit the system.
    pub fn new<S: Hybrid>(
        system: &S,
        theta: &[T],
        mode: usize,
        guard: usize,
        target: usize,
        time: T,
        before: &[T],
    ) -> Result<Self, HybridError> {
        expect("state", before, system.states())?;
        expect("parameters", theta, system.parameters())?;
        expect("time", &[time], 1)?;
        expect_mode(system, mode)?;
        expect_mode(system, target)?;
        if guard >= system.guards(mode) {
            return Err(HybridError::Size { what: "guards", expected: guard + 1, found: system.guards(mode) });
        }
        let bound = Bound { system, theta, mode };
        let field = bound.rate(time, before);
        let (_, rate) = bound.guard(guard, time, before, &field);
        let zero = rate.min_lane() == 0.0;
        if zero || !rate.min_lane().is_finite() {
            return Err(HybridError::Tangent { mode, guard, time: time.min_lane(), rate: rate.min_lane() });
        }
        // R and its derivative along the flow: DR f₋ + ∂R/∂t.
        let after = reset(system, mode, guard, Dual::new(time, T::one()), &moving(before, &field), &constants(theta));
        let reset_state: Vec<T> = after.iter().map(|number| number.value).collect();
        let field_after = Bound { system, theta, mode: target }.rate(time, &reset_state);
        let jump: Vec<T> = after.iter().zip(&field_after).map(|(after, field)| after.derivative - *field).collect();

        let (mut columns, mut event_time) = (Vec::new(), Vec::new());
        for input in 0..before.len() + theta.len() {
            let (x, theta) = (seeded(before, input), seeded(theta, input.wrapping_sub(before.len())));
            let slope = system.guard(mode, guard, Dual::constant(time), &x, &theta).derivative;
            let when = -(slope / rate);
            let moved = reset(system, mode, guard, Dual::constant(time), &x, &theta);
            columns.push(moved.iter().zip(&jump).map(|(moved, jump)| jump.mul_add(when, moved.derivative)).collect());
            event_time.push(when);
        }
        Ok(Self { columns, time: event_time })
    }

    /// The saltation of an event of a run.
    ///
    /// # Errors
    /// As [`Saltation::new`].
    pub fn of<S: Hybrid>(system: &S, theta: &[T], event: &Event<T>) -> Result<Self, HybridError> {
        Self::new(system, theta, event.mode, event.guard, event.target, event.time, &event.before)
    }

    /// Ξ, n×n.
    pub fn matrix(&self) -> DMatrix<f64> {
        let states = self.columns.first().map_or(0, Vec::len);
        DMatrix::from_fn(states, states, |row, column| self.columns[column][row].min_lane())
    }

    /// Ξ_θ, n×p.
    pub fn parameters(&self) -> DMatrix<f64> {
        let states = self.columns.first().map_or(0, Vec::len);
        DMatrix::from_fn(states, self.columns.len() - states, |row, column| self.columns[states + column][row].min_lane())
    }

    /// (Ξ δx + Ξ_θ δθ, δt*).
    pub(crate) fn push(&self, deviation: &[T], parameters: &[T]) -> (Vec<T>, T) {
        let inputs = || deviation.iter().chain(parameters);
        let row = |k: usize| self.columns.iter().zip(inputs()).fold(T::zero(), |sum, (column, input)| column[k].mul_add(*input, sum));
        let time = self.time.iter().zip(inputs()).fold(T::zero(), |sum, (time, input)| time.mul_add(*input, sum));
        ((0..deviation.len()).map(row).collect(), time)
    }

    /// The transpose: the gradients of x⁺ and t* become that of x⁻, and that of the parameters is added.
    pub(crate) fn pull(&self, gradient: &[T], of_time: T, parameters: &mut [T]) -> Vec<T> {
        let of = |input: usize| {
            let own = self.time[input] * of_time;
            self.columns[input].iter().zip(gradient).fold(own, |sum, (entry, gradient)| entry.mul_add(*gradient, sum))
        };
        for (index, parameter) in parameters.iter_mut().enumerate() {
            *parameter += of(gradient.len() + index);
        }
        (0..gradient.len()).map(of).collect()
    }
}

fn reset<S: Hybrid, T: Real>(system: &S, mode: usize, guard: usize, t: T, x: &[T], theta: &[T]) -> Vec<T> {
    Bound { system, theta, mode }.reset(guard, t, x)
}
