//! The trait [`Stepper`]: an engine that integrates, and one step of a given length. Oracles offer it by the operations `step` and `fall`.

use crate::{NoAnswer, Robot};
use featherbench_robots::StateBatch;

/// An engine whose acceleration is that of a step, and so depends on the step's length.
pub trait Stepper {
    /// Its methods to step, the one without numerical or physical extras first.
    fn step_methods(&self) -> Vec<String>;

    /// The acceleration (neutral coordinates, nv numbers) with which one step of `dt` seconds begins at state `k`, under gravity and the state's τ.
    ///
    /// # Errors
    /// [`NoAnswer`] when the robot or method is not supported, or the engine fails.
    fn step_acceleration(&self, robot: &Robot, method: &str, states: &StateBatch, k: usize, dt: f64) -> Result<Vec<f64>, NoAnswer>;

    /// The value of dt·max|v| from which on the engine may leave out the term that makes a step implicit; `None` if it never does. The step
    /// is then explicit, and begins with the true acceleration, whatever its length.
    fn guard(&self) -> Option<f64> {
        None
    }

    /// A motion under gravity alone from state `k`: the energy, J, after each of `steps` steps of `dt` seconds; the potential
    /// part is zero at the world's origin.
    ///
    /// # Errors
    /// [`NoAnswer`] when the robot or method is not supported, or the engine fails.
    fn fall(&self, robot: &Robot, method: &str, states: &StateBatch, k: usize, dt: f64, steps: usize) -> Result<Vec<f64>, NoAnswer>;
}
