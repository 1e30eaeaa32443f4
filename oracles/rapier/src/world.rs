//! One robot at one state in a rapier world.

use crate::coordinates::{self, Change};
use crate::refusal::Refusal;
use featherbench_model::{BodyDescription, Description, JointType};
use nalgebra::{DMatrix, Matrix3, SymmetricEigen};
use rapier3d_f64::math::{Matrix, Rotation, Vector};
use rapier3d_f64::prelude::MassProperties;
use rapier3d_f64::prelude::{Multibody, MultibodyJointHandle, PhysicsWorld, RigidBody, RigidBodyBuilder, RigidBodyHandle};

/// The settings of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Settings {
    /// No damping, one substep: the mechanics of the robot.
    Plain,
    /// Rapier's own settings: damping of 0.1 on every angular axis, four substeps.
    Default,
}

/// The robot, hung on one fixed body.
pub struct World<'a> {
    robot: &'a Description,
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
    joint: MultibodyJointHandle,
    /// T and b at the state that was set.
    pub change: Change,
}

impl<'a> World<'a> {
    /// Builds the robot at a state.
    pub fn new(robot: &'a Description, q: &[f64], v: &[f64], settings: Settings) -> Result<Self, Refusal> {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::from(robot.gravity);
        let root = world.insert_body(RigidBodyBuilder::fixed());
        let mut bodies = Vec::with_capacity(robot.bodies.len());
        let mut last = None;
        for body in &robot.bodies {
            let mass = mass_properties(body)?;
            let handle = world.insert_body(RigidBodyBuilder::dynamic().additional_mass_properties(mass).can_sleep(false));
            world.bodies[handle].recompute_mass_properties_from_colliders(&world.colliders);
            let parent = body.parent.map_or(root, |parent| bodies[parent]);
            last = world.insert_multibody_joint(parent, handle, coordinates::joint(body)?);
            bodies.push(handle);
        }
        let joint = last.ok_or_else(|| Refusal::Unsupported("rapier has no robot without a joint".into()))?;
        let mut made = Self { robot, world, bodies, joint, change: Change::new(robot, q, v) };
        let velocity = made.change.forth(v);
        let armature: Vec<f64> = robot.bodies.iter().flat_map(|body| per_dof(&body.joint.armature, body.joint.kind.nv())).collect();
        // A swap changes a diagonal like a vector. Where T is a rotation, `check` has rejected armature.
        let armature = made.change.forth(&armature);
        let (multibody, bodies) = made.split()?;
        multibody.forward_kinematics(bodies, true);
        multibody.armature_mut().copy_from_slice(&armature);
        if settings == Settings::Plain {
            multibody.damping_mut().fill(0.0);
        }
        multibody.apply_displacements(&coordinates::displacement(robot, q));
        multibody.forward_kinematics(bodies, false);
        multibody.update_rigid_bodies(bodies, true);
        multibody.generalized_velocity_mut().copy_from_slice(&velocity);
        if settings == Settings::Plain {
            made.world.integration_parameters.num_solver_iterations = 1;
        }
        Ok(made)
    }

    /// The multibody, and the bodies that it is made of.
    fn split(&mut self) -> Result<(&mut Multibody, &mut rapier3d_f64::prelude::RigidBodySet), Refusal> {
        match self.world.multibody_joints.get_mut(self.joint) {
            Some((multibody, _)) => Ok((multibody, &mut self.world.bodies)),
            None => Err(Refusal::Failed("rapier lost the multibody".into())),
        }
    }

    /// The rigid bodies, in the description's order.
    pub fn bodies(&self) -> impl Iterator<Item = &RigidBody> {
        self.bodies.iter().map(|&handle| &self.world.bodies[handle])
    }

    /// M, armature included, in neutral coordinates, multiplied together from rapier's LU factors.
    pub fn mass_matrix(&mut self) -> Result<DMatrix<f64>, Refusal> {
        let (multibody, bodies) = self.split()?;
        multibody.dof_inverse_inertia(bodies);
        let (permutation, lower, upper) = multibody.inv_augmented_mass().clone().unpack();
        let mut mass = lower * upper;
        permutation.inv_permute_rows(&mut mass);
        for _ in 0..2 {
            for mut column in mass.column_iter_mut() {
                self.change.back(column.as_mut_slice());
            }
            mass.transpose_mut();
        }
        Ok(mass)
    }

    /// J of a body's origin, [angular; linear] in world axes, 6 rows of nv numbers.
    pub fn jacobian(&mut self, body: usize) -> Result<Vec<f64>, Refusal> {
        let handle = self.bodies[body];
        let arm = self.world.bodies[handle].position().translation - self.world.bodies[handle].center_of_mass();
        let link = self.world.multibody_joints.rigid_body_link(handle).map_or(0, |link| link.id);
        let (multibody, _) = self.split()?;
        let at_com = multibody.body_jacobian(link);
        let mut rows = vec![Vec::new(); 6];
        for column in at_com.column_iter() {
            let (linear, angular) = (Vector::new(column[0], column[1], column[2]), Vector::new(column[3], column[4], column[5]));
            let of_origin = linear + angular.cross(arm);
            for (row, number) in rows.iter_mut().zip(angular.to_array().into_iter().chain(of_origin.to_array())) {
                row.push(number);
            }
        }
        for row in &mut rows {
            self.change.back(row);
        }
        Ok(rows.concat())
    }

    /// The acceleration that one step of `dt` seconds begins with, under gravity and the generalized forces `tau`.
    ///
    /// Rapier takes no generalized force. The force of a joint is a force and a torque on its body, and their opposites on the parent.
    pub fn acceleration(&mut self, tau: &[f64], dt: f64) -> Result<Vec<f64>, Refusal> {
        self.push(&self.change.forth(tau));
        self.step(dt);
        let (multibody, _) = self.split()?;
        let mut a: Vec<f64> = multibody.generalized_acceleration().iter().copied().collect();
        self.change.acceleration(&mut a);
        Ok(a)
    }

    /// One step of `dt` seconds.
    pub fn step(&mut self, dt: f64) {
        self.world.integration_parameters.dt = dt;
        self.world.step();
    }

    /// Puts rapier's generalized forces on the bodies.
    fn push(&mut self, tau: &[f64]) {
        let mut at = 0;
        for (body, &handle) in self.robot.bodies.iter().zip(&self.bodies) {
            let kind = body.joint.kind;
            let tau = &tau[at..at + kind.nv()];
            at += tau.len();
            let parent = body.parent.map(|parent| self.bodies[parent]);
            let above = parent.map_or(Rotation::IDENTITY, |parent| self.world.bodies[parent].position().rotation);
            let axes = above * coordinates::placement(body).rotation;
            let (force, torque) = match (kind, kind.axis()) {
                (JointType::Prismatic { .. }, Some(axis)) => (tau[0] * Vector::from(axis), Vector::ZERO),
                (JointType::Cylindrical { .. }, Some(axis)) => (tau[0] * Vector::from(axis), tau[1] * Vector::from(axis)),
                (JointType::Translation, _) => (Vector::from_slice(tau), Vector::ZERO),
                (JointType::Planar, _) => (Vector::new(tau[0], tau[1], 0.0), Vector::new(0.0, 0.0, tau[2])),
                (JointType::Free, _) => (Vector::from_slice(tau), Vector::from_slice(&tau[3..])),
                (_, Some(axis)) => (Vector::ZERO, tau[0] * Vector::from(axis)),
                (_, None) => (Vector::ZERO, Vector::from_slice(tau)),
            };
            let (force, torque, point) = (axes * force, axes * torque, self.world.bodies[handle].position().translation);
            for (handle, sign) in [(Some(handle), 1.0), (parent, -1.0)] {
                if let Some(handle) = handle {
                    let body = &mut self.world.bodies[handle];
                    body.add_force_at_point(sign * force, point, true);
                    body.add_torque(sign * torque, true);
                }
            }
        }
    }

    /// The numbers that rapier holds of each body, in the layout of a read-back.
    pub fn readback(&mut self) -> Result<Vec<f64>, Refusal> {
        let handles = self.bodies.clone();
        let mut numbers = Vec::with_capacity(22 * handles.len());
        for handle in handles {
            let held = self.world.bodies[handle].mass_properties().local_mprops;
            let inertia = held.reconstruct_inertia_matrix();
            let link = self.world.multibody_joints.rigid_body_link(handle).map_or(0, |link| link.id);
            let (multibody, _) = self.split()?;
            let link = multibody.link(link).ok_or_else(|| Refusal::Failed("rapier lost a link".into()))?;
            let placement = coordinates::placement_of(&link.joint().data);
            numbers.push(held.mass());
            numbers.extend(held.local_com.to_array());
            numbers.extend([inertia.x_axis.x, inertia.y_axis.x, inertia.z_axis.x, inertia.y_axis.y, inertia.z_axis.y, inertia.z_axis.z]);
            numbers.extend(row_major(Matrix::from_quat(placement.rotation)));
            numbers.extend(placement.translation.to_array());
        }
        Ok(numbers)
    }

    /// Kinetic energy of all bodies, with their velocities of the last step.
    pub fn kinetic_energy(&self) -> f64 {
        self.bodies().map(RigidBody::kinetic_energy).sum()
    }

    /// Potential energy of all bodies, zero at the world's origin. Rapier's own is that of half a step earlier.
    pub fn potential_energy(&self) -> f64 {
        self.bodies().map(|body| -body.mass() * self.world.gravity.dot(body.center_of_mass())).sum()
    }
}

/// Rapier keeps the inverses of the mass and the principal inertias: all must be positive.
fn mass_properties(body: &BodyDescription) -> Result<MassProperties, Refusal> {
    let [xx, xy, xz, yy, yz, zz] = body.inertia;
    let eigen = SymmetricEigen::new(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz));
    let smallest = eigen.eigenvalues.min();
    if body.mass <= 0.0 || smallest.is_nan() || smallest <= 0.0 {
        let message = format!("rapier keeps the inverses of mass and principal inertias: those of {} must be positive", body.name);
        return Err(Refusal::Unsupported(message));
    }
    let axes = eigen.eigenvectors * eigen.eigenvectors.determinant().signum();
    let frame = Rotation::from_mat3(&Matrix::from_cols_slice(axes.as_slice())).normalize();
    let principal = Vector::from_slice(eigen.eigenvalues.as_slice());
    Ok(MassProperties::with_principal_inertia_frame(Vector::from(body.com), body.mass, principal, frame))
}

/// The rows of a matrix, one after another.
pub fn row_major(matrix: Matrix) -> [f64; 9] {
    matrix.transpose().to_cols_array()
}

/// A list that may be empty for "all zero".
fn per_dof(numbers: &[f64], dofs: usize) -> Vec<f64> {
    if numbers.is_empty() { vec![0.0; dofs] } else { numbers.to_vec() }
}
