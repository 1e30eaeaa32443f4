//! Bad input is an error that names the argument, never a number that is not finite.

use crate::common::every_joint;
use featherbench_rbd::spatial::{Force, Vec3};
use featherbench_rbd::{Error, Robot};

#[test]
fn wrong_lengths_name_the_argument() {
    let robot = every_joint(true);
    let (q, v) = (robot.neutral(), vec![0.0; robot.nv()]);
    let text = |result: Result<Vec<f64>, Error>| result.unwrap_err().to_string();
    let (nq, nv) = (robot.nq(), robot.nv());
    assert_eq!(text(robot.inverse_dynamics(&q[1..], &v, &v)), format!("q has {} numbers; this robot takes {nq}", nq - 1));
    assert_eq!(text(robot.inverse_dynamics(&q, &v[1..], &v)), format!("v has {} numbers; this robot takes {nv}", nv - 1));
    assert_eq!(text(robot.forward_dynamics(&q, &v, &q)), format!("tau has {nq} numbers; this robot takes {nv}"));
    assert!(matches!(robot.mass_matrix(&[]), Err(Error::Length { argument: "q", found: 0, .. })));
    assert!(matches!(robot.workspace().inverse_dynamics(&q, &v, &v, None, &mut []), Err(Error::Length { argument: "tau", .. })));
    assert!(matches!(robot.solve(&q, &[1.0]), Err(Error::Length { argument: "b", .. })));
    let one = [Force::zero()];
    assert!(matches!(
        robot.workspace().forward_dynamics(&q, &v, &v, Some(&one), &mut v.clone()),
        Err(Error::Length { argument: "wrenches", .. })
    ));
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let robot = every_joint(true);
    let (q, v) = (robot.neutral(), vec![0.0; robot.nv()]);
    let mut cases = 0;
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for at in [0, 3, robot.nv() - 1] {
            let mut wrong = v.clone();
            wrong[at] = bad;
            let found = [
                robot.inverse_dynamics(&q, &wrong, &v).map(drop),
                robot.inverse_dynamics(&q, &v, &wrong).map(drop),
                robot.forward_dynamics(&q, &v, &wrong).map(drop),
                robot.bias_force(&q, &wrong).map(drop),
                robot.solve(&q, &wrong).map(drop),
                robot.integrate(&q, &wrong).map(drop),
                robot.inverse_dynamics_derivatives(&q, &wrong, &v).map(drop),
                robot.forward_dynamics_derivatives(&q, &wrong, &v).map(drop),
                robot.workspace().kinematics(&q, &v, &wrong).map(drop),
            ];
            for result in found {
                assert!(matches!(result, Err(Error::NotFinite { index, .. }) if index == at), "{result:?}");
                cases += 1;
            }
        }
        let mut wrong = q.clone();
        wrong[1] = bad;
        let found = [
            robot.mass_matrix(&wrong).map(drop),
            robot.placement(&wrong, "tool").map(drop),
            robot.jacobian(&wrong, "tool").map(drop),
            robot.difference(&q, &wrong).map(drop),
            robot.to_drake(&wrong).map(drop),
        ];
        for result in found {
            assert!(matches!(result, Err(Error::NotFinite { index: 1, .. })), "{result:?}");
            cases += 1;
        }
        let mut wrenches = vec![Force::zero(); robot.bodies().len()];
        wrenches[2].lin = Vec3::new(0.0, bad, 0.0);
        let result = robot.workspace().inverse_dynamics(&q, &v, &v, Some(&wrenches), &mut v.clone());
        assert!(matches!(result, Err(Error::NotFinite { argument: "wrenches", index: 16, .. })), "{result:?}");
    }
    assert_eq!(cases, 3 * (3 * 9 + 5));
}

#[test]
fn a_quaternion_of_zeros_is_no_rotation() {
    let robot = every_joint(true);
    let v = vec![0.0; robot.nv()];
    // Zero, and lengths whose squares are not numbers of full precision.
    for length in [0.0, 1e-170, 1e-155, 1e200] {
        let mut q = robot.neutral();
        q[6] = length;
        let found = robot.inverse_dynamics(&q, &v, &v);
        assert!(matches!(&found, Err(Error::NotARotation { index: 3, joint, .. }) if joint == "joint 0"), "{length}: {found:?}");
        assert!(robot.mass_matrix(&q).is_err() && robot.integrate(&q, &v).is_err() && robot.to_mujoco(&q).is_err());
    }
    // Any other length stands for the same rotation.
    let mut q = robot.random(1);
    let tau = robot.inverse_dynamics(&q, &v, &v).unwrap();
    q[3..7].iter_mut().for_each(|x| *x *= 1e3);
    let scaled = robot.inverse_dynamics(&q, &v, &v).unwrap();
    assert!(tau.iter().zip(&scaled).all(|(x, y)| (x - y).abs() < 1e-12 * (1.0 + x.abs())));
}

#[test]
fn results_that_are_too_large_are_errors() {
    let robot = every_joint(true);
    let (q, v) = (robot.random(1), vec![1e200; robot.nv()]);
    assert!(matches!(robot.inverse_dynamics(&q, &v, &v), Err(Error::ResultNotFinite { result: "tau", .. })));
    assert!(matches!(robot.forward_dynamics(&q, &v, &v), Err(Error::ResultNotFinite { result: "a", .. })));
}

#[test]
fn names_that_are_not_there_are_told_with_those_that_are() {
    let robot = every_joint(true);
    let text = robot.joint("elbow").unwrap_err().to_string();
    assert!(text.starts_with("there is no joint 'elbow'; the robot has 'joint 0', 'joint 1'"), "{text}");
    let text = robot.frame("hand").unwrap_err().to_string();
    assert!(text.starts_with("there is no body or frame 'hand'") && text.ends_with("'tool', 'post'"), "{text}");
    let many = Robot::generated("chain:n=50").unwrap().joint("elbow").unwrap_err().to_string();
    assert!(many.ends_with("and 30 more"), "{many}");
    let mut placed = robot.workspace();
    let tool = robot.frame("tool").unwrap();
    assert!(matches!(placed.placements(&robot.neutral()).unwrap().motion(&tool), Err(Error::NotMoved)));
    // A frame of a body that this robot does not have.
    let small = Robot::generated("chain:n=2").unwrap();
    assert!(matches!(small.workspace().jacobian(&[0.0; 2], &tool), Err(Error::ForeignFrame { .. })));
}

#[test]
fn a_dof_without_inertia_is_named() {
    let mut description = Robot::generated("chain:n=3").unwrap().description().clone();
    let last = &mut description.bodies[2];
    (last.mass, last.inertia) = (0.0, [0.0; 6]);
    let robot = Robot::from_description(&description).unwrap();
    assert!(!robot.notes().is_empty(), "a massless body is told");
    let (q, zero) = (robot.neutral(), [0.0; 3]);
    assert!(robot.inverse_dynamics(&q, &zero, &zero).is_ok());
    for result in [robot.forward_dynamics(&q, &zero, &zero).map(drop), robot.solve(&q, &zero).map(drop)] {
        assert!(matches!(result, Err(Error::NotPositiveDefinite(_))), "{result:?}");
    }
}
