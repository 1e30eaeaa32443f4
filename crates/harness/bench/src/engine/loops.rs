//! The trait [`LoopSolver`]: an engine that holds loops. Oracles offer it by the operations `loops`, `loop_accelerations` and `loop_motion`.

use crate::NoAnswer;
use featherbench_model::Description;
use serde_json::Value;
use std::time::Duration;

/// States of a robot with loops, in neutral coordinates, state after state.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct LoopStates {
    /// How many there are.
    pub count: usize,
    /// Positions.
    pub q: Vec<f64>,
    /// Velocities.
    pub v: Vec<f64>,
    /// Forces of the joints.
    pub tau: Vec<f64>,
}

/// Accelerations.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopAccelerations {
    /// nv numbers of each state.
    pub acceleration: Vec<f64>,
    /// The engine's own time of all of them, in all repeats.
    pub time: Duration,
    /// What they depend on: regularisation, softness, tolerances.
    pub settings: Value,
}

/// The steps of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopSteps {
    /// The length of a step, s.
    pub dt: f64,
    /// How many.
    pub steps: usize,
    /// After how many of them the state is told; a divisor of `steps`.
    pub every: usize,
}

/// A linear spring without mass between two points of bodies: a pull of `stiffness · (distance − length)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopSpring {
    /// The body of each end, by its index in the description; `None` is the world.
    pub bodies: [Option<usize>; 2],
    /// The ends, in axes of their bodies, m.
    pub points: [[f64; 3]; 2],
    /// Its stiffness, N/m.
    pub stiffness: f64,
    /// Its length without force, m.
    pub length: f64,
}

/// What drives a robot beside gravity.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct LoopDrive {
    /// Constant forces of the joints.
    pub tau: Vec<f64>,
    /// Springs.
    pub springs: Vec<LoopSpring>,
}

/// A motion.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopMotion {
    /// nq numbers of each state that is told.
    pub q: Vec<f64>,
    /// nv numbers of each state that is told.
    pub v: Vec<f64>,
    /// The engine's own time of all steps.
    pub time: Duration,
    /// What the motion depends on beside its steps.
    pub settings: Value,
}

/// An engine that holds loops. The robot is a canonical description with its section `loops`.
pub trait LoopSolver {
    /// Its methods for accelerations, the usual one first.
    fn acceleration_methods(&self) -> Vec<String>;

    /// Its methods for motions, the usual one first.
    fn motion_methods(&self) -> Vec<String>;

    /// Accelerations under gravity, the joints' forces and those of the loops; all states `repeats` times.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine does not offer the robot, a loop of it or the method, or fails.
    fn loop_accelerations(
        &self,
        robot: &Description,
        method: &str,
        states: &LoopStates,
        repeats: usize,
    ) -> Result<LoopAccelerations, NoAnswer>;

    /// A motion from a state under gravity, a drive if there is one, and the loops' forces.
    ///
    /// # Errors
    /// As of [`LoopSolver::loop_accelerations`].
    fn loop_motion(
        &self,
        robot: &Description,
        drive: Option<&LoopDrive>,
        method: &str,
        state: (&[f64], &[f64]),
        steps: LoopSteps,
    ) -> Result<LoopMotion, NoAnswer>;
}
