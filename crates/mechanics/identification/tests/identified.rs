//! The whole way: from a log to a description.

use featherbench_identification::{
    Arm, Base, FlagKind, Gravity, IdentificationError, Information, LinearModel, MARGIN, Method, PseudoInertia, Request, Samples, Search,
    Semidefinite, Stacking, Terms, changes, described, excite, identify,
};
use featherbench_robots::Random;
use featherbench_spatial::larger;
use nalgebra::{DMatrix, DVector};

const FRICTION: Terms = Terms { viscous: true, coulomb: true, armature: false, offset: false };

/// An arm whose third link carries a load that its description does not have, with friction and noise.
fn loaded() -> (LinearModel, Vec<f64>, Samples) {
    let robot = Arm::general(4, 4).describe(Gravity::Parallel, 1);
    let linear = LinearModel::new(&robot, FRICTION).unwrap();
    let mut true_robot = robot.clone();
    let last = linear.nominal()[30..40].to_vec();
    let load = PseudoInertia::of(&last.try_into().unwrap())
        + PseudoInertia::point(0.8, [0.05, 0.1, 0.2])
        + PseudoInertia::point(0.8, [-0.05, 0.0, 0.1]);
    (true_robot.bodies[3].mass, true_robot.bodies[3].com, true_robot.bodies[3].inertia) = load.central();
    for body in &mut true_robot.bodies {
        (body.joint.damping, body.joint.friction) = (vec![0.6], vec![0.9]);
    }
    let truth = LinearModel::new(&true_robot, FRICTION).unwrap().nominal();
    let base = Base::of_robot(&linear, 1).unwrap();
    let search = Search { draws: 3, changes: 6, frequency: 0.2, ..Search::default() };
    let mut samples = excite(&linear, &base, &search).unwrap().trajectory.samples(&linear, &truth, 240, 1.0).unwrap();
    let mut random = Random::named(1, "noise");
    samples.tau.iter_mut().for_each(|tau| *tau += random.uniform(-0.3, 0.3));
    (linear, truth, samples)
}

fn request(method: Method) -> Request<'static> {
    Request { method, held_out: 0.25, solver: None }
}

#[test]
fn held_out_torques_are_predicted_and_the_description_is_written() {
    let (linear, truth, samples) = loaded();
    for method in [Method::Ordinary, Method::Weighted, Method::Total, Method::LogCholesky] {
        let found = identify(&linear, &samples, &request(method)).unwrap();
        let (count, before, after) = found.held_out.as_ref().unwrap();
        assert_eq!((found.fitted, *count), (180, 60));
        println!("{}: held out {:.4} before, {:.4} after", method.name(), before.total, after.total);
        // The noise is 0.17 N·m of some 20.
        assert!(after.total < 0.05 && before.total > 3.0 * after.total, "{} {}", before.total, after.total);
        assert_eq!(found.rank_of_robot, found.estimate.base.rank());
        assert_eq!(found.beta.len(), found.estimate.beta.len());
        if method == Method::LogCholesky {
            assert!(found.bodies.iter().all(|body| body.smallest > 0.0));
            let robot = described(&linear, &found.theta).unwrap();
            let back = LinearModel::new(&robot, FRICTION).unwrap().nominal();
            let worst = back.iter().zip(&found.theta).fold(0.0, |most: f64, (a, b)| larger(most, (a - b).abs()));
            assert!(worst < 1e-12, "{worst:e}");
            let changed = changes(linear.description(), &robot);
            assert!(changed.iter().any(|change| change.of == "joint_2" && change.field == "damping" && (change.after - 0.6).abs() < 0.3));
            assert!(changes(&robot, &robot).is_empty());
        }
    }
    let due = linear.nominal();
    assert_ne!(due, truth);
}

#[test]
fn a_joint_that_stands_still_is_flagged() {
    let (linear, truth, mut samples) = loaded();
    for k in 0..samples.count() {
        (samples.q[4 * k + 3], samples.v[4 * k + 3], samples.a[4 * k + 3]) = (0.4, 0.0, 0.0);
    }
    samples.tau = linear.torques(&samples, &truth).unwrap();
    let found = identify(&linear, &samples, &request(Method::Ordinary)).unwrap();
    let flag = found.flags.iter().find(|flag| flag.kind == FlagKind::Excitation).unwrap();
    assert!(found.estimate.base.rank() < found.rank_of_robot);
    assert!(flag.about.contains("fv4") && flag.about.contains("fc4"), "{flag}");
    // What is told is told exactly.
    assert!(found.fit.total < 1e-11);
}

#[test]
fn impossible_parameters_are_not_written() {
    let (linear, _, _) = loaded();
    let mut theta = linear.nominal();
    theta[20] = -1.0;
    let refused = described(&linear, &theta).unwrap_err();
    assert!(matches!(&refused, IdentificationError::Unphysical { body, .. } if body == "link_3"), "{refused}");
    let mut theta = linear.nominal();
    theta[41] = -0.1;
    let refused = described(&linear, &theta).unwrap_err();
    assert!(refused.to_string().contains("damping of joint 'joint_2'"), "{refused}");
    assert!(matches!(described(&linear, &theta[1..]), Err(IdentificationError::Length { .. })));
}

/// The programme says what the estimator says: its matrix and maps, evaluated at the description, are residual and pseudo-inertia.
#[test]
fn the_semidefinite_programme_is_the_same_problem() {
    let (linear, truth, samples) = loaded();
    let information = Information::of(&linear, &samples, &Stacking::plain(&linear)).unwrap();
    let problem = Semidefinite::of(&linear, &information, 1e-6).unwrap();
    let count = problem.unknowns();
    // The sizes of the unknowns, from what θ makes of ones.
    let sizes = problem.theta(&linear, &vec![1.0; count]).unwrap();
    let x: Vec<f64> = truth.iter().zip(&sizes).map(|(theta, size)| theta / size).collect();
    let matrix = DMatrix::from_row_slice(problem.target.len(), count, &problem.matrix);
    let rest = matrix * DVector::from_column_slice(&x) - DVector::from_column_slice(&problem.target);
    let due = (information.factor() * DVector::from_column_slice(&truth) - information.right()).norm();
    let longest = due / rest.rows(0, information.factor().nrows()).norm();
    let scaled = information.factor() * DMatrix::from_diagonal(&DVector::from_column_slice(&sizes));
    let expected = scaled.column_iter().map(|column| column.norm()).fold(0.0, larger);
    assert!((longest / expected - 1.0).abs() < 1e-9, "{longest} {expected}");

    let maps = DMatrix::from_row_slice(problem.maps.len() / (count + 1), count + 1, &problem.maps);
    assert_eq!(maps.nrows(), 16 * (4 + 2));
    let with_one: Vec<f64> = x.iter().copied().chain([1.0]).collect();
    let entries = maps * DVector::from_vec(with_one);
    for body in 0..4 {
        let p = PseudoInertia::of(&std::array::from_fn(|k| truth[10 * body + k])).0;
        let (mass, reach) = (sizes[0], (sizes[4] / sizes[0]).sqrt());
        for (i, j) in (0..16).map(|entry| (entry / 4, entry % 4)) {
            let length = |axis| if axis < 3 { reach } else { 1.0 };
            let due = p[(i, j)] / (mass * length(i) * length(j)) - if i == j { MARGIN } else { 0.0 };
            assert!((entries[16 * body + 4 * i + j] - due).abs() < 1e-12);
        }
    }
    // Four viscous and four Coulomb frictions.
    assert!((entries[64] - 0.6).abs() < 1e-12 && (entries[80] - 0.9).abs() < 1e-12);

    // Without a solver it says so; a solver's answer is taken as it comes.
    let refused = identify(&linear, &samples, &request(Method::Semidefinite)).unwrap_err();
    assert!(matches!(refused, IdentificationError::NoSolver { .. }), "{refused}");
    let solve = |_: &Semidefinite| Ok(x.clone());
    let found = identify(&linear, &samples, &Request { solver: Some(&solve), ..request(Method::Semidefinite) }).unwrap();
    let worst = found.theta.iter().zip(&truth).fold(0.0, |most: f64, (a, b)| larger(most, (a - b).abs()));
    assert!(worst < 1e-12);
}
