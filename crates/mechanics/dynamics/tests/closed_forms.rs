//! Robots whose equations of motion are written out in textbooks.

use crate::common;

use common::within;
use featherbench_dynamics::{bias_force, center_of_mass, centroidal_momentum, energy, forward_dynamics, inverse_dynamics, mass_matrix};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model, Placement};
use featherbench_spatial::{Motion, Quaternion, Sym3, Vec3};

/// A few operations on numbers of size one to a hundred.
const FEW_ROUNDINGS: f64 = 64.0 * f64::EPSILON;

fn body(parent: Option<usize>, mass: f64, com: [f64; 3], inertia: [f64; 6], kind: JointType, at: [f64; 3]) -> BodyDescription {
    let placement = Placement { translation: at, ..Placement::default() };
    let name = format!("below {parent:?} at {at:?}");
    BodyDescription { name, parent, mass, com, inertia, joint: JointDescription { kind, placement, ..JointDescription::default() } }
}

fn build(gravity: [f64; 3], bodies: Vec<BodyDescription>) -> Model<f64> {
    Model::build(&Description { gravity, bodies, ..Description::default() }).expect("well formed")
}

#[test]
fn simple_pendulum() {
    // (I + m l² + armature) q̈ + m g l sin q = τ, q from the downward vertical
    let (m, l, i, g, armature) = (1.5, 0.7, 0.02, 9.81, 0.3);
    let mut pendulum = body(None, m, [0.0, 0.0, -l], [i, 0.0, 0.0, i, 0.0, i], JointType::Revolute { axis: [0.0, 1.0, 0.0] }, [0.0; 3]);
    pendulum.joint.armature = vec![armature];
    let model = build([0.0, 0.0, -g], vec![pendulum]);
    let total = i + m * l * l + armature;
    for (q, v, a) in [(0.0_f64, 0.0_f64, 0.0_f64), (0.4, 2.0, -3.0), (-2.9_f64, -7.0, 5.0)] {
        let expected = total * a + m * g * l * q.sin();
        let tau = inverse_dynamics(&model, &[q], &[v], &[a]).unwrap();
        within("pendulum torque", (tau[0] - expected).abs(), 30.0 * FEW_ROUNDINGS);
        within("pendulum acceleration", (forward_dynamics(&model, &[q], &[v], &tau).unwrap()[0] - a).abs(), 30.0 * FEW_ROUNDINGS);
        let energies = energy(&model, &[q], &[v]).unwrap();
        within("pendulum kinetic", (energies.kinetic - 0.5 * total * v * v).abs(), 30.0 * FEW_ROUNDINGS);
        within("pendulum potential", (energies.potential + m * g * l * q.cos()).abs(), 30.0 * FEW_ROUNDINGS);
    }
}

/// Two uniform rods, angles from the upward vertical, the second relative to the first: Lagrange's equations, written out.
struct TwoRods {
    m: [f64; 2],
    l: [f64; 2],
    /// Distance of each centre of mass from its joint, as a fraction of the length.
    center: f64,
    /// Moment of inertia about the centre of mass, as a fraction of m l².
    inertia: f64,
    g: f64,
}

impl TwoRods {
    fn model(&self) -> Model<f64> {
        // q > 0 tips from +z to +x: rotation about +y.
        let axis = [0.0, 1.0, 0.0];
        let rod = |k: usize, parent, at| {
            let i = self.inertia * self.m[k] * self.l[k] * self.l[k];
            body(parent, self.m[k], [0.0, 0.0, self.center * self.l[k]], [i, 0.0, 0.0, i, 0.0, 0.0], JointType::Revolute { axis }, at)
        };
        build([0.0, 0.0, -self.g], vec![rod(0, None, [0.0; 3]), rod(1, Some(0), [0.0, 0.0, self.l[0]])])
    }

    fn mass_matrix(&self, q: [f64; 2]) -> [[f64; 2]; 2] {
        let ([m1, m2], [l1, l2], c) = (self.m, self.l, self.center);
        let (i1, i2) = (self.inertia * m1 * l1 * l1, self.inertia * m2 * l2 * l2);
        let coupling = m2 * l1 * c * l2 * q[1].cos();
        let m22 = i2 + m2 * (c * l2).powi(2);
        let m11 = i1 + m1 * (c * l1).powi(2) + m2 * l1 * l1 + m22 + 2.0 * coupling;
        [[m11, m22 + coupling], [m22 + coupling, m22]]
    }

    fn bias(&self, q: [f64; 2], v: [f64; 2]) -> [f64; 2] {
        let ([m1, m2], [l1, l2], c, g) = (self.m, self.l, self.center, self.g);
        let k = m2 * l1 * c * l2 * q[1].sin();
        // V = m1 g c l1 cos q1 + m2 g (l1 cos q1 + c l2 cos(q1 + q2))
        let outer = -m2 * g * c * l2 * (q[0] + q[1]).sin();
        let inner = -(m1 * c + m2) * g * l1 * q[0].sin();
        [-k * (2.0 * v[0] * v[1] + v[1] * v[1]) + inner + outer, k * v[0] * v[0] + outer]
    }

    fn acceleration(&self, q: [f64; 2], v: [f64; 2], tau: [f64; 2]) -> [f64; 2] {
        let ([[a, b], [_, d]], h) = (self.mass_matrix(q), self.bias(q, v));
        let (x, y) = (tau[0] - h[0], tau[1] - h[1]);
        let det = a * d - b * b;
        [(d * x - b * y) / det, (a * y - b * x) / det]
    }
}

#[test]
fn double_pendulum_of_the_lesson() {
    let (q, v, tau) = ([0.3, -0.5], [0.7, 0.4], [1.0, -0.5]);
    let uniform = TwoRods { m: [2.0, 1.0], l: [1.0, 0.5], center: 0.5, inertia: 1.0 / 12.0, g: 9.81 };
    let tips = TwoRods { center: 1.0, inertia: 0.0, ..TwoRods { m: uniform.m, l: uniform.l, g: uniform.g, ..uniform } };
    // Ten decimals, from Lagrange's equations in thirty digits.
    for (rods, printed) in [(uniform, [8.8127960477, -43.1567473102]), (tips, [5.5110867986, -20.6120093841])] {
        let model = rods.model();
        let derived = rods.acceleration(q, v, tau);
        let a = forward_dynamics(&model, &q, &v, &tau).unwrap();
        // κ(M) of about 60 on accelerations of about 40
        within("2R acceleration", common::distance(&a, &derived), 60.0 * 40.0 * FEW_ROUNDINGS);
        within("2R printed", common::distance(&a, &printed), 0.5e-10 * 1.01);
        let matrix = mass_matrix(&model, &q).unwrap();
        let entries = [matrix.get(0, 0), matrix.get(0, 1), matrix.get(1, 0), matrix.get(1, 1)];
        within("2R mass matrix", common::distance(&entries, rods.mass_matrix(q).as_flattened()), FEW_ROUNDINGS);
        within("2R bias", common::distance(&bias_force(&model, &q, &v).unwrap(), &rods.bias(q, v)), 20.0 * FEW_ROUNDINGS);
    }
}

#[test]
fn prismatic_joint_is_newtons_law() {
    // m (a − g·axis) = τ
    let axis = [0.6, 0.0, 0.8];
    let model = build([0.5, -1.0, -9.81], vec![body(None, 2.5, [0.1, 0.2, 0.3], [0.1; 6], JointType::Prismatic { axis }, [0.0; 3])]);
    let tau = inverse_dynamics(&model, &[0.3], &[4.0], &[1.5]).unwrap();
    let expected = 2.5 * (1.5 - (0.6 * 0.5 - 0.8 * 9.81));
    within("prismatic", f64::abs(tau[0] - expected), 20.0 * FEW_ROUNDINGS);
}

#[test]
fn helical_joint_on_its_axis() {
    // (I + m p²) q̈ + m g p = τ for a vertical screw with the centre of mass on it
    let (m, i, p, g) = (3.0, 0.05, 0.2, 9.81);
    let kind = JointType::Helical { axis: [0.0, 0.0, 1.0], pitch: p };
    let model = build([0.0, 0.0, -g], vec![body(None, m, [0.0, 0.0, 0.4], [0.2, 0.0, 0.0, 0.2, 0.0, i], kind, [0.0; 3])]);
    let tau = inverse_dynamics(&model, &[0.9], &[3.0], &[-2.0]).unwrap();
    within("helical", (tau[0] - ((i + m * p * p) * -2.0 + m * g * p)).abs(), 10.0 * FEW_ROUNDINGS);
    let center = center_of_mass(&model, &[0.9]).unwrap();
    within("helical centre of mass", (center.position.z - (0.4 + p * 0.9)).abs(), FEW_ROUNDINGS);
}

#[test]
fn free_body_obeys_newton_and_euler() {
    // m (v̇ + ω × v − Rᵀg) = f,  I ω̇ + ω × I ω = n at the centre of mass
    let (mass, inertia) = (2.0, [0.3, 0.05, -0.02, 0.4, 0.01, 0.5]);
    let gravity = [1.0, 2.0, -9.0];
    let model = build(gravity, vec![body(None, mass, [0.0; 3], inertia, JointType::Free, [0.0; 3])]);
    let q = [0.1, -0.2, 0.3, 0.5, -0.1, 0.7, 0.5];
    let (v, tau) = ([0.4, -0.3, 0.8, 1.1, -0.6, 0.9], [1.0, -2.0, 0.5, 0.3, 0.2, -0.7]);
    let a = forward_dynamics(&model, &q, &v, &tau).unwrap();

    let (lin, omega) = (Vec3::new(v[0], v[1], v[2]), Vec3::new(v[3], v[4], v[5]));
    let (v_dot, omega_dot) = (Vec3::new(a[0], a[1], a[2]), Vec3::new(a[3], a[4], a[5]));
    let rotation = Quaternion::from_array([q[3], q[4], q[5], q[6]]).to_rotation();
    let force = (v_dot + omega.cross(lin) - rotation.transpose_mul(Vec3::from_array(gravity))) * mass;
    let i = Sym3::from_array(inertia);
    let moment = i * omega_dot + omega.cross(i * omega);
    let residual = Motion::new(moment - Vec3::new(0.3, 0.2, -0.7), force - Vec3::new(1.0, -2.0, 0.5));
    within("Newton–Euler", common::largest(&residual.to_array()), 40.0 * FEW_ROUNDINGS);

    // With the origin anywhere else in the same body, the same motion.
    let shift = Vec3::new(0.3, -0.5, 0.2);
    let moved = build(gravity, vec![body(None, mass, shift.to_array(), inertia, JointType::Free, [0.0; 3])]);
    let origin = Vec3::new(q[0], q[1], q[2]) - rotation * shift;
    let q_moved = [origin.x, origin.y, origin.z, q[3], q[4], q[5], q[6]];
    let lin_moved = lin - omega.cross(shift);
    let v_moved = [lin_moved.x, lin_moved.y, lin_moved.z, v[3], v[4], v[5]];
    let moment_moved = Vec3::new(0.3, 0.2, -0.7) + shift.cross(Vec3::new(1.0, -2.0, 0.5));
    let tau_moved = [1.0, -2.0, 0.5, moment_moved.x, moment_moved.y, moment_moved.z];
    let a_moved = forward_dynamics(&moved, &q_moved, &v_moved, &tau_moved).unwrap();
    within("angular acceleration elsewhere", common::distance(&a_moved[3..], &a[3..]), 40.0 * FEW_ROUNDINGS);
}

#[test]
fn spherical_pendulum_swings_like_a_plane_one() {
    // Released from rest: ω̇ = c × m g / (m l²) for a point-like mass at the end of a light rod
    let l = 0.8;
    let inertia = [1e-3, 0.0, 0.0, 1e-3, 0.0, 1e-3];
    let model = build([0.0, 0.0, -9.81], vec![body(None, 1.0, [l, 0.0, 0.0], inertia, JointType::Spherical, [0.0; 3])]);
    let a = forward_dynamics(&model, &[0.0, 0.0, 0.0, 1.0], &[0.0; 3], &[0.0; 3]).unwrap();
    within("spherical pendulum", common::distance(&a, &[0.0, 9.81 * l / (l * l + 1e-3), 0.0]), 20.0 * FEW_ROUNDINGS);
}

/// Like the book's example 7.1, derived here: a floating box carries a cylinder on a joint without friction.
/// The box feels the cylinder's inertia in every direction but the joint's.
#[test]
fn articulated_inertia_of_a_box_with_a_free_cylinder() {
    let (box_mass, cylinder_mass) = (4.0, 1.5);
    let (box_inertia, cylinder_inertia) = ([0.5, 0.0, 0.0, 0.6, 0.0, 0.7], [0.03, 0.0, 0.0, 0.02, 0.0, 0.03]);
    let y = [0.0, 1.0, 0.0];
    let at_rest = ([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0], [0.0; 7]);
    let pair = |kind| {
        let cylinder = body(Some(0), cylinder_mass, [0.0; 3], cylinder_inertia, kind, [0.0; 3]);
        build([0.0; 3], vec![body(None, box_mass, [0.0; 3], box_inertia, JointType::Free, [0.0; 3]), cylinder])
    };
    let apparent_mass = |model: &Model<f64>, k: usize| {
        let mut tau = [0.0; 7];
        tau[k] = 1.0;
        1.0 / forward_dynamics(model, &at_rest.0, &at_rest.1, &tau).unwrap()[k]
    };

    let sliding = pair(JointType::Prismatic { axis: y });
    let both = box_mass + cylinder_mass;
    let turned: Vec<f64> = (0..3).map(|k| [0.5, 0.6, 0.7][k] + [0.03, 0.02, 0.03][k]).collect();
    let expected = [both, box_mass, both, turned[0], turned[1], turned[2]];
    let found: Vec<f64> = (0..6).map(|k| apparent_mass(&sliding, k)).collect();
    within("box with a sliding cylinder", common::distance(&found, &expected), FEW_ROUNDINGS);

    let spinning = pair(JointType::Revolute { axis: y });
    let expected = [both, both, both, turned[0], 0.6, turned[2]];
    let found: Vec<f64> = (0..6).map(|k| apparent_mass(&spinning, k)).collect();
    within("box with a spinning cylinder", common::distance(&found, &expected), FEW_ROUNDINGS);
}

#[test]
fn a_spinning_body_has_the_momentum_of_the_textbook() {
    let inertia = [0.3, 0.0, 0.0, 0.4, 0.0, 0.5];
    let com = [0.2, 0.0, 0.0];
    let model = build([0.0; 3], vec![body(None, 2.0, com, inertia, JointType::Revolute { axis: [0.0, 0.0, 1.0] }, [1.0, 2.0, 3.0])]);
    let q = std::f64::consts::FRAC_PI_2;
    let result = centroidal_momentum(&model, &[q], &[3.0]).unwrap();
    let found = [result.center.position.x, result.center.position.y, result.center.position.z];
    within("centre", common::distance(&found, &[1.0, 2.2, 3.0]), FEW_ROUNDINGS);
    // L = I ω, p = m ω × c
    within("momentum", common::distance(&result.momentum.to_array(), &[0.0, 0.0, 1.5, -1.2, 0.0, 0.0]), FEW_ROUNDINGS);
}
