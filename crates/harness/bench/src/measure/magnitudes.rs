//! Sums of the magnitudes of the terms of a robot's kinematics and forces.
//!
//! They come from the recursions of the Newton–Euler algorithm (the book, table 5.1). Every vector term is replaced by its length, and
//! every sum by the sum of lengths. Lengths do not depend on the axes: so the magnitudes belong to the robot and its state, not to an
//! algorithm. In products, angular velocities keep their true length. Their sums hardly cancel, and squared sums of lengths would make the
//! measure too weak.
//!
//! The first moment of a body is a sum over its mass, too, and it cancels if the body is balanced. So it has a least length
//! ([`Magnitudes::lever`]).

use super::ratio::worst;
use crate::Robot;
use featherbench_model::JointKind;
use featherbench_spatial::{Motion, Vec3};

/// The magnitudes at one state. Per body they refer to the body's origin.
#[derive(Clone, Debug)]
pub struct Magnitudes {
    /// The state's index.
    pub state: usize,
    /// Length of the path from the world's origin to each body, m.
    pub reach: Vec<f64>,
    /// Size of each body, m: the distance from its origin to its centre of mass or to the farthest joint on it, whichever is larger, or its
    /// least length if that is larger.
    pub size: Vec<f64>,
    /// First moment of each body, kg m: its length, and at least its mass times its least length. That is an eighth of its radius of
    /// gyration about its origin or 2⁻¹⁰ of the largest body's size, whichever is larger.
    pub lever: Vec<f64>,
    /// Per dof, the least √M_ii: that of the body's mass at 2⁻¹⁰ of its radius of gyration or of the largest body's size.
    pub least_root: Vec<f64>,
    /// Angular velocity, rad/s.
    pub angular_velocity: Vec<f64>,
    /// Linear velocity, m/s.
    pub linear_velocity: Vec<f64>,
    /// Angular acceleration, rad/s².
    pub angular_acceleration: Vec<f64>,
    /// Linear acceleration without gravity, m/s².
    pub linear_acceleration: Vec<f64>,
    /// Joint force per dof: the terms that are added to form τ.
    pub joint_force: Vec<f64>,
    /// The same with the external wrenches of the state.
    pub joint_force_wrench: Vec<f64>,
    /// The same for the bias force: accelerations are zero.
    pub bias_force: Vec<f64>,
}

/// Moment and force magnitudes on one body.
#[derive(Clone, Copy, Default)]
struct Load {
    moment: f64,
    force: f64,
}

impl Robot {
    /// The magnitudes at each state.
    pub fn magnitudes(&self) -> Vec<Magnitudes> {
        (0..self.states.count()).map(|k| Magnitudes::new(self, k)).collect()
    }
}

impl Magnitudes {
    /// The magnitudes of state `k`.
    pub fn new(robot: &Robot, k: usize) -> Self {
        let states = &robot.states;
        let zero = vec![0.0; states.nv];
        let still = Recursion::outward(robot, k, &zero);
        let moving = Recursion::outward(robot, k, states.a(k));
        let none = vec![0.0; states.wrench(k).len()];
        let Lengths { size, lever, least_root } = Lengths::of(robot);
        Self {
            state: k,
            joint_force: moving.inward(robot, &lever, states.a(k), &none),
            joint_force_wrench: moving.inward(robot, &lever, states.a(k), states.wrench(k)),
            bias_force: still.inward(robot, &lever, &zero, &none),
            size,
            lever,
            least_root,
            reach: moving.reach,
            angular_velocity: moving.angular_velocity,
            linear_velocity: moving.linear_velocity,
            angular_acceleration: moving.angular_acceleration,
            linear_acceleration: moving.linear_acceleration,
        }
    }
}

/// The share of a body's radius of gyration that its first moment counts at least. The first moment of a body that is balanced in the file is
/// rounding of what was summed, some 5 ε of mass times that radius. Gates allow 45 ε, so an eighth leaves it rounding.
const OF_GYRATION: f64 = 0.125;
/// The share for a point mass on its axis, which has no such radius, and for M. An engine rounds by the distance between bodies there, by a
/// few ε. Where import differs by that, a comparison allows 4500 ε.
const OF_ROBOT: f64 = 1.0 / 1024.0;

/// The lengths that belong to the robot and not to its state.
struct Lengths {
    size: Vec<f64>,
    lever: Vec<f64>,
    least_root: Vec<f64>,
}

impl Lengths {
    fn of(robot: &Robot) -> Self {
        let model = &robot.model;
        let joints = model.topology.joints();
        let center = |i: usize| if model.inertias[i].mass > 0.0 { model.inertias[i].com().norm() } else { 0.0 };
        let mut size: Vec<f64> = (0..joints.len()).map(center).collect();
        let mut mount = 0.0;
        for (joint, placement) in joints.iter().zip(&model.placements) {
            match joint.parent {
                Some(parent) => size[parent] = worst(size[parent], placement.translation.norm()),
                None => mount = worst(mount, placement.translation.norm()),
            }
        }
        let largest = size.iter().copied().fold(0.0, worst);
        // Where no body has a size, the bases' distance from the world's origin is the only length.
        let largest = if largest > 0.0 { largest } else { mount };
        let gyration = |i: usize| {
            let inertia = &model.inertias[i];
            let half_trace = 0.5 * (inertia.rotational.xx + inertia.rotational.yy + inertia.rotational.zz);
            if inertia.mass > 0.0 { (half_trace / inertia.mass).max(0.0).sqrt() } else { 0.0 }
        };
        let (mut lever, mut least_root) = (Vec::with_capacity(joints.len()), Vec::with_capacity(model.topology.nv()));
        for (i, joint) in joints.iter().enumerate() {
            let (mass, gyration) = (model.inertias[i].mass, gyration(i));
            let least = worst(OF_GYRATION * gyration, OF_ROBOT * largest);
            size[i] = worst(size[i], least);
            lever.push(worst(model.inertias[i].first_moment.norm(), mass * least));
            let root = mass.max(0.0).sqrt() * OF_ROBOT;
            let (turn, slide) = (root * worst(gyration, largest), root);
            match joint.kind {
                JointKind::Free => least_root.extend([slide, slide, slide, turn, turn, turn]),
                JointKind::Spherical => least_root.extend([turn; 3]),
                _ => least_root.push(worst(model.subspaces[i].ang.norm() * turn, model.subspaces[i].lin.norm() * slide)),
            }
        }
        Self { size, lever, least_root }
    }
}

struct Recursion {
    step: Vec<f64>,
    spin: Vec<f64>,
    reach: Vec<f64>,
    angular_velocity: Vec<f64>,
    linear_velocity: Vec<f64>,
    angular_acceleration: Vec<f64>,
    linear_acceleration: Vec<f64>,
}

impl Recursion {
    /// From the root outwards: paths, velocities, accelerations.
    fn outward(robot: &Robot, k: usize, a: &[f64]) -> Self {
        let (model, states) = (&robot.model, &robot.states);
        let bodies = model.topology.bodies();
        let column = || Vec::with_capacity(bodies);
        let mut r = Self {
            step: column(),
            spin: column(),
            reach: column(),
            angular_velocity: column(),
            linear_velocity: column(),
            angular_acceleration: column(),
            linear_acceleration: column(),
        };
        let mut omega: Vec<Vec3<f64>> = Vec::with_capacity(bodies);
        for (i, joint) in model.topology.joints().iter().enumerate() {
            let x = model.joint_transform(i, states.q(k));
            let (mount, subspace) = (model.placements[i].translation, &model.subspaces[i]);
            let velocity: Motion<f64> = joint.kind.motion(subspace, &states.v(k)[joint.v..]);
            let acceleration: Motion<f64> = joint.kind.motion(subspace, &a[joint.v..]);
            let step = mount.norm() + (x.translation - mount).norm();
            let at = |values: &[f64]| joint.parent.map_or(0.0, |parent| values[parent]);
            let parent_omega = joint.parent.map_or(Vec3::zero(), |parent| omega[parent]);
            let (carried, across) = (parent_omega.norm(), velocity.ang.norm());
            let turned = x.rotation.transpose_mul(parent_omega) + velocity.ang;
            let spin = turned.norm();

            r.reach.push(at(&r.reach) + step);
            r.linear_velocity.push(at(&r.linear_velocity) + at(&r.angular_velocity) * step + velocity.lin.norm());
            r.angular_velocity.push(at(&r.angular_velocity) + across);
            // a = a_p + α_p × r + ω_p × (ω_p × r) + (2ω_p + ω) × v_J + a_J
            let transport = (2.0 * carried + spin) * velocity.lin.norm();
            let swing = (at(&r.angular_acceleration) + carried * carried) * step;
            r.linear_acceleration.push(at(&r.linear_acceleration) + swing + transport + acceleration.lin.norm());
            // α = α_p + (ω_p + ω_J) × ω_J + α_J: that ω_J × ω_J is zero is a cancellation too
            r.angular_acceleration.push(at(&r.angular_acceleration) + (carried + across) * across + acceleration.ang.norm());
            r.step.push(step);
            r.spin.push(spin);
            omega.push(turned);
        }
        r
    }

    /// From the leaves inwards: loads, and the part of them at each joint.
    fn inward(&self, robot: &Robot, lever: &[f64], a: &[f64], wrench: &[f64]) -> Vec<f64> {
        let model = &robot.model;
        let gravity = model.gravity.norm();
        let mut loads: Vec<Load> = (0..model.topology.bodies())
            .map(|i| {
                let inertia = &model.inertias[i];
                let [xx, xy, xz, yy, yz, zz] = inertia.rotational.to_array();
                let rotational = (xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + xz * xz + yz * yz)).sqrt();
                let turning = self.angular_acceleration[i] + self.spin[i] * self.spin[i];
                // The spatial acceleration differs from the classical one by ω × v. An algorithm may use either, so this term is in the
                // sum.
                let falling = self.linear_acceleration[i] + gravity + self.spin[i] * self.linear_velocity[i];
                let lever = lever[i];
                Load { moment: rotational * turning + lever * falling, force: inertia.mass * falling + lever * turning }
            })
            .collect();
        for (described, w) in model.described.iter().zip(wrench.chunks_exact(6)) {
            loads[*described].moment += Vec3::new(w[0], w[1], w[2]).norm();
            loads[*described].force += Vec3::new(w[3], w[4], w[5]).norm();
        }
        let mut tau = vec![0.0; model.topology.nv()];
        for (i, joint) in model.topology.joints().iter().enumerate().rev() {
            let Load { moment, force } = loads[i];
            let subspace = &model.subspaces[i];
            match joint.kind {
                JointKind::Free => {
                    tau[joint.v..joint.v + 3].fill(force);
                    tau[joint.v + 3..joint.v + 6].fill(moment);
                }
                JointKind::Spherical => tau[joint.v..joint.v + 3].fill(moment),
                _ => tau[joint.v] = subspace.ang.norm() * moment + subspace.lin.norm() * force,
            }
            if let Some(parent) = joint.parent {
                loads[parent].force += force;
                loads[parent].moment += moment + self.step[i] * force;
            }
        }
        for (k, tau) in tau.iter_mut().enumerate() {
            *tau += model.armature[k] * a[k].abs();
        }
        tau
    }
}
