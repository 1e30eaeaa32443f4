//! rapier3d in double precision, in this process: its reduced-coordinate multibodies.
//!
//! Rapier is asked for what it has: M (it keeps LU factors of it), Jacobians, poses, velocities, kinetic energy, and the acceleration with
//! which a step begins. A step is implicit in the velocity-dependent terms, so that its acceleration is the true one in the limit dt → 0 only:
//! forward dynamics is a step so short that nothing of dt is left in the arithmetic, and [`Stepper`] answers at any dt.
//!
//! A step solves (M + dt·C) a = τ − h, where C is what the bias h changes by with the velocities (`Multibody::update_mass_matrix`,
//! `update_acceleration`). From dt·max|v| = [`GUARD`] on it compares the energy that this a adds with the work of the forces; where it is more,
//! by over a hundredth of the kinetic energy, a is M⁻¹ (τ − h) instead (`free_velocity_energy_guard`). So at a fast state a long step may begin
//! with the true acceleration to the last digit, and a shorter one with an error of first order.

mod coordinates;
mod world;

use harness::{Identity, Prepared, Problem, Quantity, Refusal, Stepper, Subject};
use model::{JointType, StateBatch};
use rapier3d_f64::math::Matrix;
use rapier3d_f64::prelude::RigidBody;
use record::EngineSource;
use std::collections::BTreeMap;
use std::ops::Range;
use world::{Settings, World, row_major};

/// Version of the crate that Cargo.lock holds; a test compares.
const VERSION: &str = "0.36.1";

/// So short a step, in seconds, that dt times anything vanishes against what it is added to (at 0 rapier does not step).
const INSTANT: f64 = 1e-30;

/// dt·max|v| from which on rapier looks whether the implicit term adds energy, and may leave it out.
const GUARD: f64 = 1e-3;

/// The method of steps without damping and substeps, and that of rapier's own settings.
const METHODS: [(&str, Settings); 2] = [("step", Settings::Plain), ("step_default", Settings::Default)];

/// Rapier.
pub struct Rapier {
    identity: Identity,
}

impl Rapier {
    /// The engine of this build.
    pub fn new() -> Self {
        let build = BTreeMap::from([("language".to_owned(), "Rust (crate rapier3d-f64, in process)".to_owned())]);
        Self { identity: Identity { name: "rapier".into(), version: VERSION.into(), source: EngineSource::Live, build } }
    }
}

impl Default for Rapier {
    fn default() -> Self {
        Self::new()
    }
}

impl Subject for Rapier {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        let methods: &[&str] = match quantity {
            Quantity::Readback => &["build"],
            Quantity::MassMatrix | Quantity::MassMatrixProbe => &["lu"],
            Quantity::ForwardDynamics => &["step"],
            Quantity::KineticEnergy => &["bodies"],
            Quantity::BodyPlacement => &["poses"],
            Quantity::BodyVelocity => &["velocities"],
            Quantity::BodyJacobian => &["body_jacobian"],
            _ => &[],
        };
        methods.iter().map(|&method| method.to_owned()).collect()
    }

    fn prepare<'a>(
        &'a self,
        problem: &'a Problem,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Prepared + 'a>, Refusal> {
        if !self.methods(quantity).iter().any(|offered| offered == method) {
            return Err(Refusal::Unsupported(format!("rapier offers no method {method} for {}", quantity.name())));
        }
        check(problem, states)?;
        if quantity == Quantity::KineticEnergy && has_armature(problem) {
            return Err(Refusal::Unsupported("rapier's kinetic energy has no armature".into()));
        }
        Ok(Box::new(Ready { problem, quantity, states, values: Vec::new() }))
    }

    fn stepper(&self) -> Option<&dyn Stepper> {
        Some(self)
    }
}

/// What rapier cannot do, found before it would panic.
fn check(problem: &Problem, states: &StateBatch) -> Result<(), Refusal> {
    states.check(&problem.model).map_err(|error| Refusal::Failed(error.to_string()))?;
    for body in &problem.description.bodies {
        coordinates::joint(body)?;
        let turned = matches!(body.joint.kind, JointType::Spherical | JointType::Free);
        if turned && body.joint.armature.iter().any(|&armature| armature != 0.0) {
            let message = format!("rapier's armature of {} would act in joint-frame axes, not in the body's", body.joint.name);
            return Err(Refusal::Unsupported(message));
        }
    }
    Ok(())
}

fn has_armature(problem: &Problem) -> bool {
    problem.description.bodies.iter().flat_map(|body| &body.joint.armature).any(|&armature| armature != 0.0)
}

/// A quantity of a robot that rapier can hold; the world is built anew at each state, because rapier's coordinates can only be moved by
/// differences.
struct Ready<'a> {
    problem: &'a Problem,
    quantity: Quantity,
    states: &'a StateBatch,
    values: Vec<f64>,
}

impl Prepared for Ready<'_> {
    fn run(&mut self, range: Range<usize>) -> Result<(), Refusal> {
        self.values.clear();
        for k in range {
            let values = self.value(k)?;
            self.values.extend(values);
        }
        Ok(())
    }

    fn read(&self) -> &[f64] {
        &self.values
    }
}

impl Ready<'_> {
    fn value(&self, k: usize) -> Result<Vec<f64>, Refusal> {
        let mut world = World::new(self.problem, self.states.q(k), self.states.v(k), Settings::Plain)?;
        let nv = self.states.nv;
        Ok(match self.quantity {
            Quantity::Readback => world.readback()?,
            // Column-major or row-major is one: up to rounding M is symmetric, and each triangle is rapier's own.
            Quantity::MassMatrix => world.mass_matrix()?.transpose().as_slice().to_vec(),
            Quantity::MassMatrixProbe => {
                let mass = world.mass_matrix()?;
                let probe = nalgebra::DMatrix::from_column_slice(nv, 4, &self.problem.probe());
                let products = &mass * probe;
                products.iter().chain(mass.diagonal().iter()).chain(mass.row(nv - 1).iter()).copied().collect()
            }
            Quantity::ForwardDynamics => world.acceleration(self.states.tau(k), INSTANT)?,
            Quantity::BodyJacobian => world.jacobian(self.problem.deepest_body())?,
            Quantity::BodyPlacement => {
                let poses = world.bodies().map(|body| *body.position());
                poses.flat_map(|pose| row_major(Matrix::from_quat(pose.rotation)).into_iter().chain(pose.translation.to_array())).collect()
            }
            // Rapier computes velocities of bodies when it steps.
            Quantity::KineticEnergy => {
                world.step(INSTANT);
                vec![world.kinetic_energy()]
            }
            Quantity::BodyVelocity => {
                world.step(INSTANT);
                let velocity = |body: &RigidBody| [body.angvel(), body.velocity_at_point(body.position().translation)];
                world.bodies().flat_map(|body| velocity(body).into_iter().flat_map(|part| part.to_array())).collect()
            }
            _ => return Err(Refusal::Unsupported(format!("rapier has no {}", self.quantity.name()))),
        })
    }
}

impl Stepper for Rapier {
    fn step_methods(&self) -> Vec<String> {
        METHODS.iter().map(|(name, _)| (*name).to_owned()).collect()
    }

    fn step_acceleration(&self, problem: &Problem, method: &str, states: &StateBatch, k: usize, dt: f64) -> Result<Vec<f64>, Refusal> {
        check(problem, states)?;
        World::new(problem, states.q(k), states.v(k), settings(method)?)?.acceleration(states.tau(k), dt)
    }

    fn guard(&self) -> Option<f64> {
        Some(GUARD)
    }

    fn fall(&self, problem: &Problem, method: &str, states: &StateBatch, k: usize, dt: f64, steps: usize) -> Result<Vec<f64>, Refusal> {
        check(problem, states)?;
        if has_armature(problem) {
            return Err(Refusal::Unsupported("rapier's kinetic energy has no armature".into()));
        }
        let mut world = World::new(problem, states.q(k), states.v(k), settings(method)?)?;
        let energy = |_| {
            world.step(dt);
            world.kinetic_energy() + world.potential_energy()
        };
        Ok((0..steps).map(energy).collect())
    }
}

fn settings(method: &str) -> Result<Settings, Refusal> {
    let found = METHODS.iter().find(|(name, _)| *name == method);
    found.map(|&(_, settings)| settings).ok_or_else(|| Refusal::Unsupported(format!("rapier has no steps by {method}")))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_version_is_that_of_the_lock_file() {
        let lock = include_str!("../../../../Cargo.lock");
        let entry = lock.split("[[package]]").find(|entry| entry.contains("name = \"rapier3d-f64\"")).unwrap();
        assert!(entry.contains(&format!("version = \"{}\"", super::VERSION)), "{entry}");
    }
}
