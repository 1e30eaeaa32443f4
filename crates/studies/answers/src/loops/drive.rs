//! What drives a robot with loops beside gravity: constant forces of its joints and springs between points. As forces of the joints, and as a
//! potential, which a motion exchanges with the robot's own energy.
//!
//! ```text
//! τ = τ₀ + Σ k (d − l)/d (J₁ − J₂)ᵀ (x₂ − x₁)        V = −τ₀·q + Σ ½ k (d − l)²        d = |x₂ − x₁|
//! ```
//!
//! Points x and their Jacobians J are in world axes, m. τ₀·q is over joints with one degree of freedom. It allocates.

use featherbench_bench::{LoopDrive, LoopSpring, NoAnswer};
use featherbench_dynamics::{Jacobian, Kinematics};
use featherbench_model::Model;
use featherbench_spatial::Vec3;
use featherbench_study::known::failed;

/// A drive of a model.
pub(super) struct Driven<'a> {
    pub drive: &'a LoopDrive,
    pub model: &'a Model<f64>,
}

/// An end of a spring: its place, and the compiled body with the arm from its origin, where it is on one.
struct Place {
    at: Vec3<f64>,
    body: Option<(usize, Vec3<f64>)>,
}

impl Driven<'_> {
    fn places(&self, q: &[f64], spring: &LoopSpring) -> Result<[Place; 2], NoAnswer> {
        let still = vec![0.0; self.model.topology.nv()];
        let mut kinematics = Kinematics::new(&self.model.topology);
        kinematics.run(self.model, q, &still, &still).map_err(failed)?;
        let place = |side: usize| -> Result<Place, NoAnswer> {
            let point = Vec3::from_array(spring.points[side]);
            let Some(body) = spring.bodies[side] else { return Ok(Place { at: point, body: None }) };
            let missing = || NoAnswer::Failed(format!("a spring is on body {body}, which is not there"));
            let compiled = *self.model.described.get(body).ok_or_else(missing)?;
            let placement = kinematics.body(compiled).ok_or_else(missing)?.placement;
            let arm = placement.rotation * point;
            Ok(Place { at: placement.translation + arm, body: Some((compiled, arm)) })
        };
        Ok([place(0)?, place(1)?])
    }

    /// Adds the forces at a configuration to those of the joints.
    pub fn add(&self, q: &[f64], tau: &mut [f64]) -> Result<(), NoAnswer> {
        for (sum, constant) in tau.iter_mut().zip(&self.drive.tau) {
            *sum += constant;
        }
        let mut jacobian = Jacobian::new(&self.model.topology);
        for spring in &self.drive.springs {
            let ends = self.places(q, spring)?;
            let way = ends[1].at - ends[0].at;
            let distance = way.dot(way).sqrt();
            let pull = spring.stiffness * (distance - spring.length) / distance;
            for (end, sign) in ends.iter().zip([pull, -pull]) {
                let Some((body, arm)) = end.body else { continue };
                for (sum, column) in tau.iter_mut().zip(jacobian.run(self.model, q, body).map_err(failed)?) {
                    *sum += sign * (column.lin + column.ang.cross(arm)).dot(way);
                }
            }
        }
        Ok(())
    }

    /// The potential at a configuration, J.
    pub fn potential(&self, q: &[f64]) -> Result<f64, NoAnswer> {
        let single = self.model.topology.joints().iter().filter(|joint| joint.kind.nv() == 1);
        let mut sum = -single.map(|joint| self.drive.tau[joint.v] * q[joint.q]).sum::<f64>();
        for spring in &self.drive.springs {
            let [first, second] = self.places(q, spring)?;
            let way = second.at - first.at;
            sum += 0.5 * spring.stiffness * (way.dot(way).sqrt() - spring.length).powi(2);
        }
        Ok(sum)
    }
}
