//! Measures where what they divide by is zero, or rounding: balanced bodies, wheels on their axes, no gravity, no motion, masses over decades.
//!
//! Answers that differ from the truth by rounding count as rounding there: our kernels', and those of an algorithm that takes moments about
//! another point. An error of a real size does not.

use crate::share::one_of;
use featherbench_bench::measure::{ForwardScale, scaled_error, worst};
use featherbench_bench::truth::TruthModel;
use featherbench_bench::{Quantity, Robot};
use featherbench_dynamics::{bias_force, forward_dynamics, forward_kinematics, inverse_dynamics, mass_matrix};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Placement};
use featherbench_results::ModelOrigin;
use featherbench_robots::{Random, StateBatch};
use featherbench_spatial::Vec3;

/// The gate of an answer on robots up to a depth of twenty (`ci/gates.toml`).
const GATE: f64 = 1e-14;
/// The bound of a comparison, where engines take moments about other points (`import::bound`).
const COMPARED: f64 = 1e-12;
/// How long a body's sides and its distance from its parent are at most, m.
const SIDE: f64 = 0.3;

fn vector(random: &mut Random, size: f64) -> [f64; 3] {
    std::array::from_fn(|_| random.uniform(-size, size))
}

/// A body of pairs of masses, each pair balanced about the joint: its centre of mass is what rounding left of their sum. Or a wheel, whose
/// centre of mass is exactly on the axis.
fn body(i: usize, random: &mut Random, moment: f64) -> BodyDescription {
    let total = 10.0_f64.powf(random.uniform(-3.0, 3.0));
    let (mut first, mut inertia) = ([0.0; 3], [0.0; 6]);
    let wheel = random.below(3) == 0;
    for _ in 0..3 {
        let r = vector(random, SIDE);
        for (sign, share) in [(1.0, 0.11), (-1.0, 0.055), (-1.0, 0.055)] {
            let m = total * share;
            for (first, r) in first.iter_mut().zip(r) {
                *first += if wheel { 0.0 } else { sign * m * r };
            }
            let [x, y, z] = r;
            for (sum, term) in inertia.iter_mut().zip([y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y]) {
                *sum += m * term;
            }
        }
    }
    let axis = Vec3::from_array(vector(random, 1.0));
    let axis = (axis * axis.norm().recip()).to_array();
    let kind = match random.below(4) {
        0 => JointType::Spherical,
        _ => JointType::Revolute { axis },
    };
    let mut com = first.map(|x| x / total);
    com[0] += moment;
    let placement = Placement { translation: vector(random, SIDE), ..Placement::default() };
    let joint = JointDescription { name: format!("joint {i}"), kind, placement, ..JointDescription::default() };
    BodyDescription { name: format!("body {i}"), parent: i.checked_sub(1 + random.below(2)), mass: total, com, inertia, joint }
}

/// A robot of balanced bodies, each off balance by `moment` m, at the state of rest and at random ones.
fn robot(seed: u64, moment: f64) -> Robot {
    let mut random = Random::named(seed, "degenerate");
    let mut bodies: Vec<BodyDescription> = Vec::new();
    for i in 0..1 + random.below(4) {
        let mut body = body(i, &mut random, moment);
        // Depth-first: the parent is on the path of the body before.
        body.parent = i.checked_sub(1);
        bodies.push(body);
    }
    let gravity = if random.below(4) == 0 { [0.0; 3] } else { [1.0, -2.0, -9.5] };
    let description = Description { name: format!("degenerate {seed}"), gravity, bodies, ..Description::default() };
    let mut robot = Robot::new(&description, "test", ModelOrigin::Generated, StateBatch::HEAD, seed).unwrap();
    // The last state: any pose at rest.
    let nv = robot.states.nv;
    for numbers in [&mut robot.states.v, &mut robot.states.a, &mut robot.states.tau] {
        numbers[5 * nv..6 * nv].fill(0.0);
    }
    robot
}

fn close(robot: &Robot, quantity: Quantity, k: usize, truth: &[f64], value: &[f64]) -> f64 {
    scaled_error(robot, quantity, &robot.magnitudes()[k], truth, value)
}

/// Our answers in f64, with their quantities.
fn ours(robot: &Robot, k: usize) -> Vec<(Quantity, Vec<f64>)> {
    let (model, states) = (&robot.model, &robot.states);
    let (q, v, a) = (states.q(k), states.v(k), states.a(k));
    let motion = forward_kinematics(model, q, v, a).unwrap();
    let bodies = |f: &dyn Fn(featherbench_dynamics::BodyMotion<f64>) -> Vec<f64>| -> Vec<f64> { motion.iter().flat_map(f).collect() };
    let matrix = mass_matrix(model, q).unwrap();
    let nv = states.nv;
    vec![
        (Quantity::InverseDynamics, inverse_dynamics(model, q, v, a).unwrap()),
        (Quantity::Bias, bias_force(model, q, v).unwrap()),
        (Quantity::MassMatrix, (0..nv * nv).map(|entry| matrix.get(entry / nv, entry % nv)).collect()),
        (Quantity::BodyVelocity, bodies(&|m| m.velocity.to_array().to_vec())),
        (Quantity::BodyAcceleration, bodies(&|m| m.acceleration.to_array().to_vec())),
    ]
}

/// The torques of gravity by moments about the common centre of mass: those of all bodies beyond a joint, less what moves them to it.
fn torques_of_gravity(robot: &Robot, k: usize) -> Vec<f64> {
    let (model, zero) = (&robot.model, vec![0.0; robot.states.nv]);
    let motion: Vec<_> = forward_kinematics(model, robot.states.q(k), &zero, &zero).unwrap().iter().collect();
    let at = |i: usize| motion[i].placement.translation + motion[i].placement.rotation * model.inertias[i].com();
    let total: f64 = model.inertias.iter().map(|inertia| inertia.mass).sum();
    let center = (0..motion.len()).fold(Vec3::zero(), |sum, i| sum + at(i) * (model.inertias[i].mass / total));
    let mut tau = vec![0.0; robot.states.nv];
    for (i, joint) in model.topology.joints().iter().enumerate() {
        let (mut moment, mut force) = (Vec3::zero(), Vec3::zero());
        for j in i..motion.len() {
            let weight = model.gravity * -model.inertias[j].mass;
            moment += (at(j) - center).cross(weight);
            force += weight;
        }
        let about = moment - (motion[i].placement.translation - center).cross(force);
        let local = motion[i].placement.rotation.transpose_mul(about);
        match joint.kind {
            featherbench_model::JointKind::Spherical => tau[joint.v..joint.v + 3].copy_from_slice(&local.to_array()),
            _ => tau[joint.v] = local.dot(model.subspaces[i].ang),
        }
    }
    tau
}

#[test]
fn rounding_is_rounding_where_nothing_is_left_to_divide_by() {
    let (mut asked, mut balanced) = (0, 0);
    for seed in 0..400 / one_of(8) as u64 {
        let robot = robot(seed, 0.0);
        let truth = TruthModel::new(&robot).unwrap();
        let at = robot.magnitudes();
        let forward = ForwardScale::all(&robot, &at);
        for (k, scale) in forward.iter().enumerate() {
            for (quantity, value) in ours(&robot, k) {
                let due = truth.answer(&robot, quantity, k).unwrap();
                let error = close(&robot, quantity, k, &due, &value);
                assert!(error <= GATE, "seed {seed}: {} at state {k} is off by {error:e}", quantity.name());
                asked += 1;
            }
            let states = &robot.states;
            let a = forward_dynamics(&robot.model, states.q(k), states.v(k), states.tau(k)).unwrap();
            let due = truth.answer(&robot, Quantity::ForwardDynamics, k).unwrap();
            let (backward, error) = (scale.backward_error(&a), scale.forward_error(&due, &a));
            let allowed = GATE * robot.depth as f64;
            assert!(backward <= allowed, "seed {seed}: fd at state {k} has the backward error {backward:e}");
            assert!(error <= allowed * scale.amplification, "seed {seed}: fd at state {k} is off by {error:e}");
            // At rest the bias is that of gravity.
            if states.v(k).iter().all(|x| *x == 0.0) {
                let due = truth.answer(&robot, Quantity::Bias, k).unwrap();
                let error = close(&robot, Quantity::Bias, k, &due, &torques_of_gravity(&robot, k));
                assert!(error <= COMPARED, "seed {seed}: moments about another point at state {k} are off by {error:e}");
                balanced += 1;
            }
        }
    }
    assert!(asked > 1000 && balanced > 90, "{asked}, {balanced}");
}

/// A centre of mass that is 1e-9 m off is told: a millionth of a thousandth of a body's size.
#[test]
fn an_error_of_a_real_size_is_no_rounding() {
    let mut told = 0;
    for seed in 0..200 / one_of(8) as u64 {
        let (robot, off) = (robot(seed, 0.0), robot(seed, 1e-9));
        if robot.model.gravity.norm() == 0.0 {
            continue;
        }
        let moved = robot.magnitudes().iter().enumerate().fold(0.0, |most, (k, at)| {
            let [due, value] = [&robot, &off].map(|robot| bias_force(&robot.model, robot.states.q(k), robot.states.v(k)).unwrap());
            worst(most, scaled_error(&robot, Quantity::Bias, at, &due, &value))
        });
        assert!(moved.is_finite() && moved > 10.0 * COMPARED, "seed {seed}: {moved:e}");
        told += 1;
    }
    assert!(told > 10, "{told}");
}
