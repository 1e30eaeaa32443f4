//! A robot that rapier can hold, and what it answers about it.
//!
//! Rapier gives M (it keeps LU factors of it), Jacobians, poses, velocities, kinetic energy, and the acceleration with which a step begins.
//!
//! A step solves (M + dt·C) a = τ − h, with C the change of the bias h with the velocities (`Multibody::update_mass_matrix`,
//! `update_acceleration`). It is implicit in the velocity-dependent terms, so a is the true acceleration only in the limit dt → 0. Forward
//! dynamics is a step so short that dt has no effect in the arithmetic. The operation `step` answers at any dt.
//!
//! From dt·max|v| = [`GUARD`] on, rapier compares the energy that a adds with the work of the forces (`free_velocity_energy_guard`). If the first
//! is larger by more than a hundredth of the kinetic energy, a is M⁻¹ (τ − h) instead. So at a fast state a long step may begin with the true
//! acceleration to the last digit, and a shorter one with an error of first order.
//!
//! The world is built again at each state, because rapier's coordinates can only be changed by differences.

use crate::coordinates;
use crate::refusal::{Refusal, failed};
use crate::world::{Settings, World, row_major};
use featherbench_model::{Description, JointType};
use rapier3d_f64::math::Matrix;
use rapier3d_f64::prelude::RigidBody;

/// The quantities that are answered, each with its one method.
pub const QUANTITIES: [(&str, &str); 7] = [
    ("mass_matrix", "lu"),
    ("mass_matrix_probe", "lu"),
    ("fd", "step"),
    ("kinetic_energy", "bodies"),
    ("body_placement", "poses"),
    ("body_velocity", "velocities"),
    ("body_jacobian", "body_jacobian"),
];

/// The method of steps without damping and substeps, and that of rapier's own settings.
pub const STEPS: [(&str, Settings); 2] = [("step", Settings::Plain), ("step_default", Settings::Default)];

/// dt·max|v| from which on rapier checks whether the implicit term adds energy, and may leave it out.
pub const GUARD: f64 = 1e-3;

/// A step, in seconds, so short that terms with dt are lost in rounding (at 0 rapier does not step).
const INSTANT: f64 = 1e-30;

/// A robot that rapier can hold.
pub struct Robot {
    description: Description,
}

/// One state.
#[derive(Clone, Copy)]
pub struct State<'a> {
    pub q: &'a [f64],
    pub v: &'a [f64],
    pub tau: &'a [f64],
    /// The four vectors that M is multiplied with, row after row.
    pub probe: &'a [f64],
}

impl Robot {
    /// The robot, if rapier can hold it.
    pub fn new(description: Description) -> Result<Self, Refusal> {
        for (at, body) in description.bodies.iter().enumerate() {
            if body.parent.is_some_and(|parent| parent >= at) {
                return Err(failed(format!("{} comes before its parent", body.name)));
            }
            coordinates::joint(body)?;
            let turned = matches!(body.joint.kind, JointType::Spherical | JointType::Free);
            if turned && body.joint.armature.iter().any(|&armature| armature != 0.0) {
                let message = format!("rapier's armature of {} would act in joint-frame axes, not in the body's", body.joint.name);
                return Err(Refusal::Unsupported(message));
            }
        }
        Ok(Self { description })
    }

    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The numbers that rapier holds of each body, in the layout of a read-back.
    pub fn readback(&self) -> Result<Vec<f64>, Refusal> {
        let mut q = Vec::with_capacity(self.description.nq());
        for kind in self.description.bodies.iter().map(|body| body.joint.kind) {
            q.resize(q.len() + kind.nq(), 0.0);
            if let (JointType::Spherical | JointType::Free, Some(last)) = (kind, q.last_mut()) {
                *last = 1.0;
            }
        }
        World::new(&self.description, &q, &vec![0.0; self.description.nv()], Settings::Plain)?.readback()
    }

    /// A quantity's numbers at a state; `body` is the one whose Jacobian is asked for.
    pub fn value(&self, quantity: &str, state: State, body: usize) -> Result<Vec<f64>, Refusal> {
        if quantity == "kinetic_energy" {
            self.without_armature()?;
        }
        let mut world = self.world(state, Settings::Plain)?;
        Ok(match quantity {
            // Column-major and row-major agree up to rounding, because M is symmetric. Each triangle is rapier's own.
            "mass_matrix" => world.mass_matrix()?.transpose().as_slice().to_vec(),
            "mass_matrix_probe" => {
                let mass = world.mass_matrix()?;
                let probe = nalgebra::DMatrix::from_column_slice(mass.nrows(), 4, state.probe);
                let products = &mass * probe;
                products.iter().chain(mass.diagonal().iter()).chain(mass.row(mass.nrows() - 1).iter()).copied().collect()
            }
            "fd" => world.acceleration(state.tau, INSTANT)?,
            "body_jacobian" => world.jacobian(body)?,
            "body_placement" => {
                let poses = world.bodies().map(|body| *body.position());
                poses.flat_map(|pose| row_major(Matrix::from_quat(pose.rotation)).into_iter().chain(pose.translation.to_array())).collect()
            }
            // Rapier computes velocities of bodies when it steps.
            "kinetic_energy" => {
                world.step(INSTANT);
                vec![world.kinetic_energy()]
            }
            "body_velocity" => {
                world.step(INSTANT);
                let velocity = |body: &RigidBody| [body.angvel(), body.velocity_at_point(body.position().translation)];
                world.bodies().flat_map(|body| velocity(body).into_iter().flat_map(|part| part.to_array())).collect()
            }
            _ => return Err(Refusal::Unsupported(format!("rapier has no {quantity}"))),
        })
    }

    /// The acceleration that a step of `dt` seconds begins with.
    pub fn step(&self, state: State, settings: Settings, dt: f64) -> Result<Vec<f64>, Refusal> {
        self.world(state, settings)?.acceleration(state.tau, dt)
    }

    /// The energy after each of some steps of `dt` seconds under gravity alone.
    pub fn fall(&self, state: State, settings: Settings, dt: f64, steps: usize) -> Result<Vec<f64>, Refusal> {
        self.without_armature()?;
        let mut world = self.world(state, settings)?;
        let energy = |_| {
            world.step(dt);
            world.kinetic_energy() + world.potential_energy()
        };
        Ok((0..steps).map(energy).collect())
    }

    fn world(&self, state: State, settings: Settings) -> Result<World<'_>, Refusal> {
        World::new(&self.description, state.q, state.v, settings)
    }

    fn without_armature(&self) -> Result<(), Refusal> {
        let mut armature = self.description.bodies.iter().flat_map(|body| &body.joint.armature);
        if armature.any(|&armature| armature != 0.0) {
            return Err(Refusal::Unsupported("rapier's kinetic energy has no armature".into()));
        }
        Ok(())
    }
}
