//! What a hybrid system is: modes with a flow each, guards with a direction, and a reset per guard.
//!
//! Everything that depends on the state is generic over the scalar. So the Jacobians of the flow, of the guards and of the resets come from
//! dual numbers through the same text.

use crate::error::HybridError;
use featherbench_spatial::{Dual, Real};

/// Which crossing of g = 0 is an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From g > 0 to g < 0.
    Falling,
    /// From g < 0 to g > 0.
    Rising,
    /// Both.
    Either,
}

/// A hybrid system with n states x and p parameters θ.
///
/// ```text
/// flow   ẋ = f(t, x, θ)      in each mode
/// event  g(t, x, θ) = 0      crossed in the guard's direction
/// reset  x⁺ = R(t, x⁻, θ)    and the next mode
/// ```
///
/// Units are the system's own; t is in seconds. The functions are smooth near the points where they are asked, and they have no memory.
/// Those that take a mode or a guard are asked only for modes below [`Hybrid::modes`] and guards below [`Hybrid::guards`].
///
/// ```
/// use featherbench_hybrid::{Direction, Hybrid};
/// use featherbench_spatial::Real;
/// /// x grows with the rate 1 until it is θ; then it starts again at zero.
/// struct Sawtooth;
/// impl Hybrid for Sawtooth {
///     fn states(&self) -> usize { 1 }
///     fn parameters(&self) -> usize { 1 }
///     fn direction(&self, _: usize, _: usize) -> Direction { Direction::Rising }
///     fn flow<T: Real>(&self, _: usize, _: T, _: &[T], _: &[T], rate: &mut [T]) { rate[0] = T::one(); }
///     fn guard<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], theta: &[T]) -> T { x[0] - theta[0] }
///     fn reset<T: Real>(&self, _: usize, _: usize, _: T, _: &[T], _: &[T], after: &mut [T]) { after[0] = T::zero(); }
/// }
/// use featherbench_hybrid::{Settings, Start, simulate};
/// let run = simulate(&Sawtooth, &[0.4_f64], &Start { mode: 0, time: 0.0, state: vec![0.0] }, 1.0, &Settings::default())?;
/// assert_eq!(run.events.len(), 2);
/// assert!((run.state[0] - 0.2).abs() < 1e-14);
/// # Ok::<(), featherbench_hybrid::HybridError>(())
/// ```
pub trait Hybrid {
    /// n.
    fn states(&self) -> usize;

    /// p.
    fn parameters(&self) -> usize;

    /// The number of modes. Without another definition there is one.
    fn modes(&self) -> usize {
        1
    }

    /// The number of guards of a mode. Without another definition there is one.
    fn guards(&self, _mode: usize) -> usize {
        1
    }

    /// Which crossings of a guard are events. Without another definition g falls.
    fn direction(&self, _mode: usize, _guard: usize) -> Direction {
        Direction::Falling
    }

    /// f, into `rate`.
    fn flow<T: Real>(&self, mode: usize, t: T, x: &[T], theta: &[T], rate: &mut [T]);

    /// g.
    fn guard<T: Real>(&self, mode: usize, guard: usize, t: T, x: &[T], theta: &[T]) -> T;

    /// R, into `after`. Without another definition the state stays.
    fn reset<T: Real>(&self, _mode: usize, _guard: usize, _t: T, x: &[T], _theta: &[T], after: &mut [T]) {
        after.copy_from_slice(x);
    }

    /// The mode after an event, from the state after the reset. Without another definition it stays.
    fn target(&self, mode: usize, _guard: usize, _t: f64, _after: &[f64], _theta: &[f64]) -> usize {
        mode
    }
}

/// A system with its parameters, in one mode.
pub(crate) struct Bound<'a, S, T> {
    pub(crate) system: &'a S,
    pub(crate) theta: &'a [T],
    pub(crate) mode: usize,
}

impl<S: Hybrid, T: Real> Bound<'_, S, T> {
    pub(crate) fn flow(&self, t: T, x: &[T], rate: &mut [T]) {
        self.system.flow(self.mode, t, x, self.theta, rate);
    }

    pub(crate) fn rate(&self, t: T, x: &[T]) -> Vec<T> {
        let mut rate = vec![T::zero(); x.len()];
        self.flow(t, x, &mut rate);
        rate
    }

    /// g, and its derivative where time runs with the rate 1 and the state with `rate`.
    pub(crate) fn guard(&self, guard: usize, t: T, x: &[T], rate: &[T]) -> (T, T) {
        let g = self.system.guard(self.mode, guard, Dual::new(t, T::one()), &moving(x, rate), &constants(self.theta));
        (g.value, g.derivative)
    }

    /// What rounding does to g: 16ε(Σ|∂g/∂xᵢ||xᵢ| + |∂g/∂t||t|), where the factor stands for the few operations of a guard and of a last
    /// step.
    pub(crate) fn noise(&self, guard: usize, t: T, x: &[T]) -> f64 {
        let theta = constants(self.theta);
        let along = |t: Dual<T>, moving: usize| self.system.guard(self.mode, guard, t, &seeded(x, moving), &theta).derivative.min_lane();
        let of_state = |(index, x): (usize, &T)| (along(Dual::constant(t), index) * x.min_lane()).abs();
        let of_time = (along(Dual::new(t, T::one()), x.len()) * t.min_lane()).abs();
        16.0 * rounding::<T>() * x.iter().enumerate().map(of_state).fold(of_time, |sum, part| sum + part)
    }

    pub(crate) fn reset(&self, guard: usize, t: T, x: &[T]) -> Vec<T> {
        let mut after = vec![T::zero(); x.len()];
        self.system.reset(self.mode, guard, t, x, self.theta, &mut after);
        after
    }

    pub(crate) fn target(&self, guard: usize, t: T, after: &[T]) -> usize {
        let plain = |numbers: &[T]| -> Vec<f64> { numbers.iter().map(|number| number.min_lane()).collect() };
        self.system.target(self.mode, guard, t.min_lane(), &plain(after), &plain(self.theta))
    }
}

/// The relative rounding of a scalar: that of double-double if it keeps 2⁻⁶⁰ beside one, else that of f64.
pub(crate) fn rounding<T: Real>() -> f64 {
    let small = T::from_f64(2.0_f64.powi(-60));
    let kept = (T::one() + small - T::one()).min_lane() != 0.0;
    if kept { f64::EPSILON * f64::EPSILON } else { f64::EPSILON }
}

/// An error unless the system has this mode.
pub(crate) fn expect_mode<S: Hybrid>(system: &S, mode: usize) -> Result<(), HybridError> {
    if mode < system.modes() { Ok(()) } else { Err(HybridError::Mode { mode, modes: system.modes() }) }
}

/// Numbers that move with the given rates.
pub(crate) fn moving<T: Real>(numbers: &[T], rates: &[T]) -> Vec<Dual<T>> {
    numbers.iter().zip(rates).map(|(number, rate)| Dual::new(*number, *rate)).collect()
}

/// Numbers that do not move.
pub(crate) fn constants<T: Real>(numbers: &[T]) -> Vec<Dual<T>> {
    numbers.iter().map(|number| Dual::constant(*number)).collect()
}

/// The numbers, of which one moves with the rate 1; none for an index beyond them.
pub(crate) fn seeded<T: Real>(numbers: &[T], moving: usize) -> Vec<Dual<T>> {
    let rate = |index| if index == moving { T::one() } else { T::zero() };
    numbers.iter().enumerate().map(|(index, number)| Dual::new(*number, rate(index))).collect()
}
