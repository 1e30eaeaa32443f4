//! A payload: a mass that a body carries and the nominal model does not know.
//!
//! Inverse dynamics is linear in the inertias. So r is the inverse dynamics of the robot whose bodies have no mass but the payload, and ∂r/∂a its
//! mass matrix, which is positive semidefinite: a payload is always well-posed.

use crate::error::{demand, finite};
use crate::{Residual, ResidualError, State};
use featherbench_dynamics::{inverse_dynamics, mass_matrix};
use featherbench_model::{Description, Malformed, Model};
use nalgebra::DMatrix;
use thiserror::Error;

/// A rigid payload of a body.
#[derive(Clone, Debug)]
pub struct Payload {
    weightless: Model<f64>,
}

/// Why a payload cannot be put on a robot.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PayloadError {
    /// A number or the body is wrong.
    #[error(transparent)]
    Residual(#[from] ResidualError),
    /// The robot is malformed.
    #[error(transparent)]
    Malformed(#[from] Malformed),
}

impl Payload {
    /// A payload of body `body` of the description: `mass` (kg), centre of mass in the body's frame (m), and rotational inertia about it in
    /// body axes (xx, xy, xz, yy, yz, zz), kg·m².
    ///
    /// # Errors
    /// [`PayloadError`] if there is no such body, the mass is negative, a number is not finite, or the robot is malformed.
    pub fn new(robot: &Description, body: usize, mass: f64, com: [f64; 3], inertia: [f64; 6]) -> Result<Self, PayloadError> {
        demand("mass of the payload", &[mass], "it must be finite and not negative", |x| x >= 0.0)?;
        finite("centre of mass of the payload", &com)?;
        finite("inertia of the payload", &inertia)?;
        let mut weightless = robot.clone();
        for body in &mut weightless.bodies {
            (body.mass, body.com, body.inertia) = (0.0, [0.0; 3], [0.0; 6]);
            body.joint.armature.clear();
        }
        let bodies = weightless.bodies.len();
        let carrier = weightless.bodies.get_mut(body).ok_or(ResidualError::NoBody { body, bodies })?;
        (carrier.mass, carrier.com, carrier.inertia) = (mass, com, inertia);
        Ok(Self { weightless: Model::build(&weightless)? })
    }
}

impl Residual for Payload {
    fn nv(&self) -> usize {
        self.weightless.topology.nv()
    }

    fn nq(&self) -> Option<usize> {
        Some(self.weightless.topology.nq())
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        let forces = inverse_dynamics(&self.weightless, state.q, state.v, state.a)?;
        r.iter_mut().zip(forces).for_each(|(r, force)| *r += force);
        Ok(())
    }

    fn has_acceleration(&self) -> bool {
        true
    }

    fn add_by_acceleration(&self, state: &State<'_>, matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
        *matrix += mass_matrix(&self.weightless, state.q)?.to_dense();
        Ok(())
    }
}
