//! Exciting trajectories: within limits, with a condition that the search makes smaller, the same in every run.

use featherbench_identification::{Arm, Base, Excitation, Gravity, IdentificationError, LinearModel, Search, Terms, excite};
use featherbench_robots::Family;
use featherbench_spatial::larger;

fn search(draws: usize, changes: usize) -> Search {
    Search { draws, changes, frequency: 0.2, harmonics: 4, ..Search::default() }
}

fn found(linear: &LinearModel, search: &Search) -> Excitation {
    let base = Base::of_robot(linear, 1).unwrap();
    excite(linear, &base, search).unwrap()
}

#[test]
fn limits_are_kept_between_the_points_of_the_search() {
    let mut robot = Arm::puma560().describe(Gravity::Parallel, 1);
    robot.bodies[1].joint.effort = vec![60.0];
    let linear = LinearModel::new(&robot, Terms::ALL).unwrap();
    let excitation = found(&linear, &search(4, 4));
    let samples = excitation.trajectory.samples(&linear, &linear.nominal(), 3000, 1.0).unwrap();
    let (mut fastest, mut strongest): (f64, f64) = (0.0, 0.0);
    for (at, &tau) in samples.tau.iter().enumerate() {
        let dof = &linear.dofs()[at % 6];
        assert!(tau.abs() <= dof.effort, "{}: {tau} N·m", dof.name);
        assert!(samples.q[at].abs() <= 2.5 && samples.v[at].abs() <= 4.0, "{}", dof.name);
        fastest = larger(fastest, samples.v[at].abs());
        if at % 6 == 1 {
            strongest = larger(strongest, tau.abs());
        }
    }
    // The limits are used, not only kept.
    assert!(fastest > 0.5 && strongest > 20.0, "{fastest} {strongest}");
    // v and a are the derivatives of q: central differences of step h err by h²/6 of the third derivative.
    let (h, t) = (1e-4, 0.37);
    let ((before, v0, _), (_, v, a), (after, v1, _)) =
        (excitation.trajectory.at(t - h), excitation.trajectory.at(t), excitation.trajectory.at(t + h));
    for dof in 0..6 {
        assert!(((after[dof] - before[dof]) / (2.0 * h) - v[dof]).abs() < 1e-5);
        assert!(((v1[dof] - v0[dof]) / (2.0 * h) - a[dof]).abs() < 1e-5);
    }
}

#[test]
fn the_search_lowers_the_condition_and_repeats() {
    let linear = LinearModel::new(&Family::parse("chain:n=3").unwrap().generate().unwrap(), Terms::NONE).unwrap();
    let best = found(&linear, &search(10, 40));
    println!("{} of {} first, {} scaled, {} tried", best.condition, best.first, best.scaled, best.tried);
    assert!(best.condition < 0.7 * best.first);
    assert!(best.tried >= 40);
    assert_eq!(best, found(&linear, &search(10, 40)));
    let base = Base::of_robot(&linear, 1).unwrap();
    let other = excite(&linear, &base, &Search { seed: 2, ..search(10, 40) }).unwrap();
    assert_ne!(best.trajectory, other.trajectory);
}

#[test]
fn what_cannot_be_excited_is_refused_by_name() {
    let floating = LinearModel::new(&Family::parse("quadruped").unwrap().generate().unwrap(), Terms::NONE).unwrap();
    let base = Base::of_robot(&floating, 1).unwrap();
    let refused = excite(&floating, &base, &search(1, 0)).unwrap_err();
    assert!(matches!(&refused, IdentificationError::NotExcitable { kind: "free", .. }), "{refused}");

    // Gravity alone is more than the motor of the second joint has.
    let mut robot = Arm::puma560().describe(Gravity::Parallel, 1);
    robot.bodies[1].joint.effort = vec![0.01];
    let linear = LinearModel::new(&robot, Terms::NONE).unwrap();
    let base = Base::of_robot(&linear, 1).unwrap();
    let refused = excite(&linear, &base, &search(2, 0)).unwrap_err();
    assert_eq!(refused, IdentificationError::NoTrajectory { tries: 2, joint: "joint_2".into() });
    let refused = excite(&linear, &base, &Search { frequency: f64::NAN, ..search(2, 0) }).unwrap_err();
    assert!(matches!(refused, IdentificationError::Setting { setting: "frequency", .. }));
}
