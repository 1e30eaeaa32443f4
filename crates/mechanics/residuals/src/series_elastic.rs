//! Series elastic drives: the motor turns a spring, and the spring the link.
//!
//! The inner state is [θ; θ̇], angle and speed of each motor on the link's side of its gear. With the commanded motor force u:
//!
//! ```text
//! s = K (θ − q) + D (θ̇ − v)        M a + h = s        B θ̈ = u − s        so r = u − s
//! ```
//!
//! The nominal model must hold no armature for these dofs: the motor's inertia B is here. Source: M. Spong (1987), with damping.

use crate::error::{demand, expect};
use crate::{Residual, ResidualError, State};

/// Series elastic drives, one per dof, of a robot with nq = nv.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesElastic {
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    motor: Vec<f64>,
}

impl SeriesElastic {
    /// Of stiffness K (N·m/rad), damping D and motor inertia B (kg·m², seen from the link) per dof.
    ///
    /// # Errors
    /// [`ResidualError`] if the lengths differ, K or B is not positive, D is negative, or a number is not finite.
    pub fn new(stiffness: Vec<f64>, damping: Vec<f64>, motor: Vec<f64>) -> Result<Self, ResidualError> {
        expect("dampings of the drives", stiffness.len(), damping.len())?;
        expect("motor inertias", stiffness.len(), motor.len())?;
        demand("stiffness of a drive", &stiffness, "it must be finite and positive", |x| x > 0.0)?;
        demand("damping of a drive", &damping, "it must be finite and not negative", |x| x >= 0.0)?;
        demand("motor inertia", &motor, "it must be finite and positive", |x| x > 0.0)?;
        Ok(Self { stiffness, damping, motor })
    }

    /// The force s of the spring and damper of a dof.
    fn spring(&self, k: usize, state: &State<'_>) -> f64 {
        let [angle, speed] = [state.inner[k], state.inner[self.motor.len() + k]];
        self.stiffness[k] * (angle - state.q[k]) + self.damping[k] * (speed - state.v[k])
    }
}

impl Residual for SeriesElastic {
    fn nv(&self) -> usize {
        self.motor.len()
    }

    /// One number of q per dof: an angle of a motor has no place beside a quaternion.
    fn nq(&self) -> Option<usize> {
        Some(self.motor.len())
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        let command = state.commanded()?;
        for (k, r) in r.iter_mut().enumerate() {
            *r += command[k] - self.spring(k, state);
        }
        Ok(())
    }

    fn inner(&self) -> usize {
        2 * self.motor.len()
    }

    fn inner_rate(&self, state: &State<'_>, rate: &mut [f64]) -> Result<(), ResidualError> {
        let command = state.commanded()?;
        let n = self.motor.len();
        for k in 0..n {
            rate[k] = state.inner[n + k];
            rate[n + k] = (command[k] - self.spring(k, state)) / self.motor[k];
        }
        Ok(())
    }
}
