//! The quantities against other formulations of them.

use crate::common::{every_joint, largest, random_v};
use featherbench_rbd::dynamics;
use featherbench_rbd::spatial::{Force, Motion, Vec3};
use featherbench_rbd::{Frame, Robot};

/// The errors of a few hundred operations on numbers of size ten, where matrices have condition numbers of a few thousand.
const SOLVED: f64 = 1e-9;
/// The same without a solution of equations.
const FORMED: f64 = 1e-11;
/// Of central differences with steps of 1e-5.
const DIFFERENCE: f64 = 1e-6;
const STEP: f64 = 1e-5;

fn near(x: &[f64], y: &[f64], tolerance: f64) {
    assert_eq!(x.len(), y.len());
    for (k, (x, y)) in x.iter().zip(y).enumerate() {
        assert!((x - y).abs() <= tolerance * (1.0 + y.abs()), "number {k}: {x} and {y}");
    }
}

/// The usual kernels and the link-by-link ones share no text.
#[test]
fn quantities_are_those_of_the_plain_kernels() {
    let robot = every_joint(true);
    let (model, mut workspace) = (robot.model(), robot.workspace());
    for seed in 0..4 {
        let q = robot.random(seed);
        let [v, a, tau] = [1, 2, 3].map(|stream| random_v(&robot, seed, stream));
        near(&robot.inverse_dynamics(&q, &v, &a).unwrap(), &dynamics::inverse_dynamics(model, &q, &v, &a).unwrap(), FORMED);
        near(&robot.bias_force(&q, &v).unwrap(), &dynamics::bias_force(model, &q, &v).unwrap(), FORMED);
        near(robot.mass_matrix(&q).unwrap().values(), dynamics::mass_matrix(model, &q).unwrap().values(), FORMED);
        let fall = robot.forward_dynamics(&q, &v, &tau).unwrap();
        near(&robot.inverse_dynamics(&q, &v, &fall).unwrap(), &tau, SOLVED);
        let h = robot.bias_force(&q, &v).unwrap();
        let forces: Vec<f64> = tau.iter().zip(&h).map(|(tau, h)| tau - h).collect();
        near(&robot.solve(&q, &forces).unwrap(), &fall, SOLVED);
        near(&workspace.factors(&q).unwrap().dense_inverse(), &robot.forward_dynamics_derivatives(&q, &v, &tau).unwrap().tau, SOLVED);
    }
}

/// The power of a wrench on the last body: τ changes by −Jᵀf.
#[test]
fn wrenches_act_by_the_transposed_jacobian() {
    let robot = every_joint(true);
    let (q, v, a) = (robot.random(1), random_v(&robot, 1, 1), random_v(&robot, 1, 2));
    let last = robot.bodies().len() - 1;
    let name = robot.bodies()[last].to_owned();
    let mut wrenches = vec![Force::zero(); last + 1];
    wrenches[last] = Force::new(Vec3::new(1.0, -2.0, 3.0), Vec3::new(4.0, 5.0, -6.0));
    let (free, mut tau) = (robot.inverse_dynamics(&q, &v, &a).unwrap(), vec![0.0; robot.nv()]);
    robot.workspace().inverse_dynamics(&q, &v, &a, Some(&wrenches), &mut tau).unwrap();
    let turn = robot.placement(&q, &name).unwrap().rotation;
    let world = Force::new(turn * wrenches[last].ang, turn * wrenches[last].lin);
    let expected: Vec<f64> = robot.jacobian(&q, &name).unwrap().iter().zip(&free).map(|(column, tau)| tau - column.dot(world)).collect();
    near(&tau, &expected, FORMED);
}

/// J v is the velocity of a frame, and the rate of its origin; velocities and accelerations are rates.
#[test]
fn frames_move_as_their_jacobians_say() {
    let robot = every_joint(true);
    let (q, v, a) = (robot.random(2), random_v(&robot, 2, 1), random_v(&robot, 2, 2));
    let mut workspace = robot.workspace();
    let ahead = |h: f64| {
        let step: Vec<f64> = v.iter().map(|v| h * v).collect();
        let faster: Vec<f64> = v.iter().zip(&a).map(|(v, a)| v + h * a).collect();
        (robot.integrate(&q, &step).unwrap(), faster)
    };
    let still = vec![0.0; robot.nv()];
    let mut of = |frame: &Frame| {
        let motion = workspace.kinematics(&q, &v, &a).unwrap().motion(frame).unwrap();
        let columns = workspace.jacobian(&q, frame).unwrap().to_vec();
        let product = columns.iter().zip(&v).fold(Motion::zero(), |sum, (column, &v)| sum + *column * v);
        near(&product.to_array(), &motion.velocity.to_array(), FORMED);
        let mut at = |h: f64| {
            let (q, v) = ahead(h);
            workspace.kinematics(&q, &v, &still).unwrap().motion(frame).unwrap()
        };
        let (after, before) = (at(STEP), at(-STEP));
        let rate = |x: [f64; 3], y: [f64; 3]| [0, 1, 2].map(|i| (x[i] - y[i]) / (2.0 * STEP));
        let (p, r) = (after.placement.translation, before.placement.translation);
        near(&rate(p.to_array(), r.to_array()), &motion.velocity.lin.to_array(), DIFFERENCE);
        near(&rate(after.velocity.ang.to_array(), before.velocity.ang.to_array()), &motion.acceleration.ang.to_array(), DIFFERENCE);
        near(&rate(after.velocity.lin.to_array(), before.velocity.lin.to_array()), &motion.acceleration.lin.to_array(), DIFFERENCE);
    };
    let names: Vec<String> = robot.frames().into_iter().map(str::to_owned).collect();
    assert!(names.len() == 12 && names.iter().any(|name| name == "tool"));
    for name in &names {
        of(&robot.frame(name).unwrap());
    }
    let post = robot.frame("post").unwrap();
    assert_eq!(largest(&workspace.jacobian(&q, &post).unwrap().iter().flat_map(|column| column.to_array()).collect::<Vec<_>>()), 0.0);
}

#[test]
fn derivatives_are_the_limits_of_differences() {
    let robot = every_joint(true);
    let (q, v) = (robot.random(3), random_v(&robot, 3, 1));
    let (a, tau, n) = (random_v(&robot, 3, 2), random_v(&robot, 3, 3), robot.nv());
    let id = robot.inverse_dynamics_derivatives(&q, &v, &a).unwrap();
    let fd = robot.forward_dynamics_derivatives(&q, &v, &tau).unwrap();
    let unit = |j: usize, h: f64| (0..n).map(|k| if k == j { h } else { 0.0 }).collect::<Vec<_>>();
    for j in 0..n {
        let moved = |h: f64| robot.integrate(&q, &unit(j, h)).unwrap();
        let central = |f: &dyn Fn(f64) -> Vec<f64>| -> Vec<f64> {
            f(STEP).iter().zip(f(-STEP)).map(|(ahead, behind)| (ahead - behind) / (2.0 * STEP)).collect()
        };
        let by_q = central(&|h| robot.inverse_dynamics(&moved(h), &v, &a).unwrap());
        near(&(0..n).map(|i| id.q.get(i, j)).collect::<Vec<_>>(), &by_q, DIFFERENCE);
        let by_q = central(&|h| robot.forward_dynamics(&moved(h), &v, &tau).unwrap());
        // Accelerations of light tips reach hundreds, and their third derivatives more: relative to the largest of the column.
        let size = 1.0 + largest(&by_q);
        near(&(0..n).map(|i| fd.q[i * n + j] / size).collect::<Vec<_>>(), &by_q.iter().map(|x| x / size).collect::<Vec<_>>(), DIFFERENCE);
    }
}

/// A batch has the results of single states.
#[test]
fn batches_have_the_results_of_states() {
    let robot = Robot::generated("humanoid").unwrap();
    let (count, nq, nv) = (13, robot.nq(), robot.nv());
    let q = robot.random_batch(count, 5);
    let v: Vec<f64> = (0..count as u64).flat_map(|state| random_v(&robot, 5, state)).collect();
    let mut tau = vec![0.0; count * nv];
    robot.batch().on_all_cores().inverse_dynamics(&q, &v, &v, None, &mut tau).unwrap();
    for k in 0..count {
        let (q, v) = (&q[k * nq..(k + 1) * nq], &v[k * nv..(k + 1) * nv]);
        near(&robot.inverse_dynamics(q, v, v).unwrap(), &tau[k * nv..(k + 1) * nv], FORMED);
    }
}

#[test]
fn configurations_respect_limits_and_steps() {
    let robot = Robot::generated("humanoid").unwrap();
    for seed in 0..20 {
        let q = robot.random(seed);
        for joint in robot.joints() {
            assert!(joint.limits.iter().zip(&q[joint.q.clone()]).all(|(limits, q)| limits.0 <= *q && *q <= limits.1), "{}", joint.name);
        }
        let (v, zero) = (random_v(&robot, seed, 1), vec![0.0; robot.nv()]);
        near(&robot.difference(&q, &robot.integrate(&q, &v).unwrap()).unwrap(), &v, FORMED);
        near(&robot.difference(&q, &q).unwrap(), &zero, FORMED);
    }
}
