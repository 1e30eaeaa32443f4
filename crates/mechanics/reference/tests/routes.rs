//! Independent methods for the same truth agree to 1e-100. So do the two sides of identities of mechanics.

use crate::support;

use featherbench_model::{Description, JointType, Model};
use featherbench_reference::{Error, Factors, Mp, Precision, Robot, lagrange, maximal};
use featherbench_robots::StateBatch;
use support::{CASES, Case, Draw, close, describe, distance};

/// How closely the methods must agree. At 448 bits they agree to about 1e-130 times the condition number of the problem.
const AGREED: f64 = 1e-100;

/// The chains of the accuracy table, short enough for every method.
const CHAINS: [(&str, Draw); 7] = [
    ("chain:n=10", Draw::Small),
    ("chain:n=10,layout=spatial", Draw::Wide),
    ("chain:n=8,layout=spatial,tip_scale=1e3", Draw::Wide),
    ("chain:n=8,layout=spatial,tip_scale=1e6", Draw::Wide),
    ("chain:n=8,tip_scale=1e6", Draw::Small),
    ("chain:n=8,tip_scale=1e-6", Draw::Small),
    ("chain:n=6,layout=spatial,base_offset=1e6", Draw::Wide),
];

fn exact(robot: &Robot, values: &[f64]) -> Vec<Mp> {
    robot.numbers("test", values).unwrap()
}

#[test]
fn constraints_and_the_lagrangian_agree_with_projection_on_the_chains() {
    for (family, draw) in CHAINS {
        let case = Case { name: "routes", family, draw };
        let robot = Robot::new(&case.describe(), Precision::STANDARD).unwrap();
        let state = case.state(3, 0);
        let [q, v, a, tau] = [&state.q, &state.v, &state.a, &state.tau].map(|values| exact(&robot, values));
        let motion = robot.at(&q, &v).unwrap();
        let projected = motion.forward_dynamics(&tau).unwrap();
        close(&format!("{family}: constraints"), &distance(&maximal::forward_dynamics(&motion, &tau).unwrap(), &projected), AGREED);
        let torque = motion.inverse_dynamics(&a).unwrap();
        close(&format!("{family}: Lagrange, ID"), &distance(&lagrange::inverse_dynamics(&robot, &q, &v, &a).unwrap(), &torque), AGREED);
        let (mass, other) = (motion.mass_matrix(), lagrange::mass_matrix(&robot, &q).unwrap());
        close(&format!("{family}: Lagrange, M"), &distance(other.entries(), mass.entries()), AGREED);
        close(
            &format!("{family}: Lagrange, FD"),
            &distance(&lagrange::forward_dynamics(&robot, &q, &v, &tau).unwrap(), &projected),
            AGREED,
        );
    }
}

/// Every kind of joint, in the middle of a tree and at its tips, with skew axes, products of inertia, armature, skew gravity.
fn every_joint() -> Vec<Description> {
    let kinds = ["revolute", "prismatic", "helical", "spherical", "planar", "universal", "translation", "cylindrical", "euler_zyx"];
    let mut robots: Vec<Description> = Vec::new();
    for kind in kinds {
        robots.extend(["fixed", "free"].map(|base| describe(&format!("joints:kind={kind},base={base},shape=single"))));
    }
    robots.push(describe("tree:n=9,joints=all,base=free,armature=true"));
    robots.push(describe("tree:n=4,joints=all,armature=true,seed=2"));
    for robot in &mut robots {
        robot.gravity = [1.25, -3.5, -8.0];
    }
    robots
}

#[test]
fn constraints_agree_with_projection_on_every_joint() {
    for description in every_joint() {
        let robot = Robot::new(&description, Precision::STANDARD).unwrap();
        let batch = StateBatch::agreement(&Model::build(&description).unwrap(), 4, 5);
        for k in 0..batch.count() {
            let motion = robot.moving(batch.q(k), batch.v(k)).unwrap();
            let tau = exact(&robot, batch.tau(k));
            let projected = motion.forward_dynamics(&tau).unwrap();
            let constrained = maximal::forward_dynamics(&motion, &tau).unwrap();
            close(&format!("{}, state {k}: constraints", description.name), &distance(&constrained, &projected), AGREED);
            close("ID after FD", &distance(&motion.inverse_dynamics(&projected).unwrap(), &tau), AGREED);
        }
    }
}

#[test]
fn the_lagrangian_agrees_with_projection_on_every_joint_that_it_knows() {
    let mut compared = 0;
    for mut description in every_joint() {
        for body in &mut description.bodies {
            body.joint.armature = vec![0.125; body.joint.kind.nv()];
            if body.joint.kind == JointType::Free {
                body.joint.armature.clear();
            }
        }
        let robot = Robot::new(&description, Precision::STANDARD).unwrap();
        let batch = StateBatch::agreement(&Model::build(&description).unwrap(), 1, 6);
        let [q, v, a] = [batch.q(0), batch.v(0), batch.a(0)].map(|values| exact(&robot, values));
        let motion = robot.at(&q, &v).unwrap();
        match lagrange::inverse_dynamics(&robot, &q, &v, &a) {
            Err(Error::Unsupported { kind, .. }) => assert!(["free", "spherical"].contains(&kind), "{kind}"),
            torque => {
                close(&description.name, &distance(&torque.unwrap(), &motion.inverse_dynamics(&a).unwrap()), AGREED);
                compared += 1;
            }
        }
    }
    assert!(compared >= 5, "{compared}");
}

/// M is symmetric and positive definite, ½ vᵀMv the kinetic energy, ID = M a + h, and the power of τ is the change of energy.
#[test]
fn identities_of_mechanics_hold() {
    for description in every_joint() {
        let robot = Robot::new(&description, Precision::STANDARD).unwrap();
        let batch = StateBatch::agreement(&Model::build(&description).unwrap(), 1, 7);
        let [v, a] = [batch.v(0), batch.a(0)].map(|values| exact(&robot, values));
        let motion = robot.moving(batch.q(0), batch.v(0)).unwrap();
        let mass = motion.mass_matrix();
        assert!(Factors::new(&mass).unwrap().pivots().iter().all(|pivot| pivot.to_f64() > 0.0));
        let twice: Mp = v.iter().zip(mass.apply(&v)).map(|(v, momentum)| v * momentum).sum();
        close("kinetic energy", &distance(&[motion.kinetic_energy().twice()], &[twice]), AGREED);
        let sum: Vec<Mp> = mass.apply(&a).iter().zip(motion.bias()).map(|(inertial, h)| inertial + h).collect();
        close("ID = M a + h", &distance(&sum, &motion.inverse_dynamics(&a).unwrap()), AGREED);
        for i in 0..robot.nv() {
            (0..i).for_each(|j| assert_eq!(mass.get(i, j), mass.get(j, i)));
        }
        // d/dt (T + V) = τ·v, by a central difference with an error below 1e-55.
        let q = exact(&robot, batch.q(0));
        let step = Precision::STANDARD.parse("1e-30").unwrap();
        let energy = |h: &Mp| {
            let faster: Vec<Mp> = v.iter().zip(&a).map(|(v, a)| v + h * a).collect();
            let there = robot.at(&advance(&description, &q, &v, &a, h), &faster).unwrap();
            there.kinetic_energy() + there.potential_energy()
        };
        let change = (energy(&step) - energy(&-&step)) / step.twice();
        let power: Mp = motion.inverse_dynamics(&a).unwrap().iter().zip(&v).map(|(tau, v)| tau * v).sum();
        close(&format!("{}: power", description.name), &distance(&[change], &[power]), 1e-52);
    }
}

/// The configuration after a time h at velocity v and acceleration a, to second order in h.
fn advance(description: &Description, q: &[Mp], v: &[Mp], a: &[Mp], h: &Mp) -> Vec<Mp> {
    let (mut at_q, mut at_v, mut end) = (0, 0, Vec::new());
    for kind in description.bodies.iter().map(|body| body.joint.kind) {
        let (q, range) = (&q[at_q..at_q + kind.nq()], at_v..at_v + kind.nv());
        (at_q, at_v) = (at_q + kind.nq(), at_v + kind.nv());
        let steps: Vec<Mp> = v[range.clone()].iter().zip(&a[range.clone()]).map(|(v, a)| h * v + (h * h * a).half()).collect();
        if kind.nq() == kind.nv() {
            end.extend(q.iter().zip(&steps).map(|(q, step)| q + step));
            continue;
        }
        let [x, y, z, w] = std::array::from_fn(|i| q[q.len() - 4 + i].clone());
        if kind == JointType::Free {
            // p + R (h u + ½h² (u̇ + ω × u)), R by the quaternion's products.
            let [u, omega] = [&v[range.start..range.start + 3], &v[range.start + 3..range.end]];
            let bend = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| (h * h * (&omega[i] * &u[j] - &omega[j] * &u[i])).half());
            let local: [Mp; 3] = std::array::from_fn(|i| &steps[i] + &bend[i]);
            let cross = |l: &[Mp; 3]| [&y * &l[2] - &z * &l[1], &z * &l[0] - &x * &l[2], &x * &l[1] - &y * &l[0]];
            let (once, square) = (cross(&local), &x * &x + &y * &y + &z * &z + &w * &w);
            let twice = cross(&once);
            end.extend((0..3).map(|i| &q[i] + &local[i] + (&w * &once[i] + &twice[i]).twice() / &square));
        }
        // q times (half the step, 1): the rotation by the step, to third order.
        let half: Vec<Mp> = steps[steps.len() - 3..].iter().map(Mp::half).collect();
        end.push(&x + &w * &half[0] + &y * &half[2] - &z * &half[1]);
        end.push(&y + &w * &half[1] + &z * &half[0] - &x * &half[2]);
        end.push(&z + &w * &half[2] + &x * &half[1] - &y * &half[0]);
        end.push(&w - &x * &half[0] - &y * &half[1] - &z * &half[2]);
    }
    end
}

/// More bits do not change the digits that fewer bits gave.
#[test]
fn precision_is_what_it_says() {
    let case = &CASES[3];
    let (description, state) = (case.describe(), case.state(4, 0));
    let at = |bits| Robot::new(&description, Precision::bits(bits)).unwrap().forward_dynamics(&state.q, &state.v, &state.tau).unwrap();
    let best = at(900);
    for (bits, tolerance) in [(128, 1e-30), (256, 1e-68), (448, 1e-126), (700, 1e-202)] {
        let coarse: Vec<Mp> = at(bits).iter().map(|x| x.at(Precision::bits(900))).collect();
        close(&format!("{bits} bits"), &distance(&coarse, &best), tolerance);
    }
}

#[test]
fn what_is_no_question_is_refused() {
    let robot = Robot::new(&describe("joints:kind=spherical,base=free,shape=single"), Precision::STANDARD).unwrap();
    let (q, v) = (vec![0.5; robot.nq()], vec![0.0; robot.nv()]);
    assert_eq!(robot.moving(&q[1..], &v).err(), Some(Error::Length { array: "q", found: q.len() - 1, expected: q.len() }));
    assert_eq!(robot.moving(&q, &v[1..]).err(), Some(Error::Length { array: "v", found: v.len() - 1, expected: v.len() }));
    assert_eq!(robot.inverse_dynamics(&q, &v, &[]).err(), Some(Error::Length { array: "a", found: 0, expected: v.len() }));
    assert_eq!(robot.forward_dynamics(&q, &v, &[0.0]).err(), Some(Error::Length { array: "tau", found: 1, expected: v.len() }));
    assert_eq!(robot.bias(&[f64::NAN], &v).err(), Some(Error::NotFinite { array: "q", index: 0 }));
    assert!(matches!(robot.bias(&vec![0.0; q.len()], &v).err(), Some(Error::NoDirection { what: "the quaternion", .. })));
    let mut massless = describe("chain:n=2");
    massless.bodies[1].mass = 0.0;
    massless.bodies[1].inertia = [0.0; 6];
    let robot = Robot::new(&massless, Precision::STANDARD).unwrap();
    assert_eq!(robot.forward_dynamics(&[0.0; 2], &[0.0; 2], &[0.0; 2]), Err(Error::NotPositiveDefinite { dof: 1 }));
    let motion = robot.moving(&[0.0; 2], &[0.0; 2]).unwrap();
    assert!(matches!(maximal::forward_dynamics(&motion, &exact(&robot, &[0.0; 2])), Err(Error::Singular { .. })));
    massless.bodies[0].mass = f64::NAN;
    assert!(matches!(Robot::new(&massless, Precision::STANDARD), Err(Error::Malformed(_))));
}

/// Doubles only approximate directions and rotations. The nearest exact ones are meant, whatever the given length is.
#[test]
fn what_stands_for_a_rotation_is_made_one() {
    let description = describe("joints:kind=common,base=free,shape=single");
    let robot = Robot::new(&description, Precision::STANDARD).unwrap();
    let batch = StateBatch::random(&Model::build(&description).unwrap(), 1, 8);
    let mut scaled = batch.q(0).to_vec();
    scaled[3..7].iter_mut().for_each(|x| *x *= 4.0);
    let (one, other) =
        (robot.inverse_dynamics(batch.q(0), batch.v(0), batch.a(0)), robot.inverse_dynamics(&scaled, batch.v(0), batch.a(0)));
    close("a quaternion four times as long", &distance(&other.unwrap(), &one.unwrap()), 1e-125);
}
