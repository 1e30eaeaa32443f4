//! The packed kinematics, centre of mass, momentum, energy and Jacobian against the other text of each, on every kind of joint and tree.

use crate::common;
use crate::packed::robots;

use common::{ROBOTS, build, distance, dyadic_chain, largest, robot, within};
use featherbench_dynamics::{
    BodyMotion, CenterOfMass, DimensionError, Jacobian, Kinematics, Momentum, PackedCenterOfMass, PackedJacobian, PackedKinematics,
    PackedModel, PackedMomentum,
};
use featherbench_model::{JointType, Model};
use featherbench_robots::StateBatch;
use featherbench_spatial::{Force, Motion, Vec3};

/// The robots of the other packed kernels, and forests: trees with fixed and floating bases side by side in a register.
fn forests() -> Vec<(String, Model<f64>)> {
    let forest = |recipe: usize, roots: fn(usize, bool) -> bool| {
        let mut description = robot(&ROBOTS[recipe].1, 5);
        for (i, body) in description.bodies.iter_mut().enumerate() {
            if roots(i, body.joint.kind == JointType::Free) {
                body.parent = None;
            }
        }
        (format!("forest of {}", ROBOTS[recipe].0), Model::build(&description).expect("a forest is well formed"))
    };
    let mut models = robots();
    models.push(forest(8, |_, free| free));
    models.push(forest(8, |i, free| free || i % 4 == 1));
    models.push(forest(6, |i, _| i % 3 == 1));
    models.push(forest(1, |i, _| i % 2 == 0));
    models
}

/// The numbers of a body's placement, velocity and acceleration.
fn parts(motion: &BodyMotion<f64>) -> [Vec<f64>; 4] {
    let BodyMotion { placement, velocity, acceleration } = motion;
    let rotation = placement.rotation.to_array().to_vec();
    [rotation, placement.translation.to_array().to_vec(), velocity.to_array().to_vec(), acceleration.to_array().to_vec()]
}

#[test]
fn motions_are_those_of_the_other_text() {
    for (name, model) in forests() {
        let packed = PackedModel::new(&model);
        let (mut kinematics, mut other) = (PackedKinematics::new(&packed), Kinematics::new(&model.topology));
        let states = StateBatch::random(&model, 4, 5);
        for k in 0..states.count() {
            kinematics.run(&packed, states.q(k), states.v(k), states.a(k)).unwrap();
            other.run(&model, states.q(k), states.v(k), states.a(k)).unwrap();
            assert_eq!(kinematics.iter().count(), model.topology.bodies());
            let all: Vec<_> = other.iter().map(|motion| parts(&motion)).collect();
            for (body, motion) in kinematics.iter().enumerate() {
                for (part, found) in parts(&motion).iter().enumerate() {
                    // the largest number of the part on any body
                    let scale = all.iter().map(|parts| largest(&parts[part])).fold(1.0, common::larger);
                    within(&format!("{name}: body {body}, part {part}"), distance(found, &all[body][part]) / scale, 1e-14);
                }
            }
        }
    }
}

#[test]
fn runs_that_compute_less_agree_with_the_whole_one() {
    for (name, model) in forests() {
        let packed = PackedModel::new(&model);
        let (mut whole, mut part) = (PackedKinematics::new(&packed), PackedKinematics::new(&packed));
        let states = StateBatch::random(&model, 1, 5);
        whole.run(&packed, states.q(0), states.v(0), states.a(0)).unwrap();
        part.place(&packed, states.q(0)).unwrap();
        for body in 0..model.topology.bodies() {
            assert_eq!((part.placement(body), part.velocity(body), part.body(body)), (whole.placement(body), None, None), "{name}");
        }
        part.set_moving(&packed, states.q(0), states.v(0)).unwrap();
        for body in 0..model.topology.bodies() {
            let of = |kinematics: &PackedKinematics| (kinematics.placement(body), kinematics.velocity(body));
            assert_eq!((of(&part), part.body(body)), (of(&whole), None), "{name}");
            assert!(part.velocity(body).is_some());
        }
        assert_eq!(part.iter().count(), 0, "accelerations were not computed");
        let bodies = model.topology.bodies();
        assert_eq!((whole.body(bodies), whole.placement(bodies), whole.velocity(bodies)), (None, None, None));
    }
}

#[test]
fn sums_over_bodies_are_those_of_the_other_text() {
    for (name, model) in forests() {
        let packed = PackedModel::new(&model);
        let mut center = PackedCenterOfMass::new(&packed);
        let mut momentum = PackedMomentum::new(&packed);
        let states = StateBatch::random(&model, 4, 5);
        for k in 0..states.count() {
            let (q, v) = (states.q(k), states.v(k));
            let (found, expected) = (center.run(&packed, q).unwrap(), CenterOfMass::new(&model.topology).run(&model, q).unwrap());
            within(&format!("{name}: mass"), (found.mass - expected.mass).abs() / expected.mass, 1e-15);
            let reach = 1.0 + largest(&expected.position.to_array());
            within(&format!("{name}: c"), distance(&found.position.to_array(), &expected.position.to_array()) / reach, 1e-14);

            let (found, expected) = (momentum.run(&packed, q, v).unwrap(), Momentum::new(&model.topology).run(&model, q, v).unwrap());
            within(&format!("{name}: c"), distance(&found.center.position.to_array(), &expected.center.position.to_array()) / reach, 1e-14);
            let (found, expected) = (found.momentum.to_array(), expected.momentum.to_array());
            within(&format!("{name}: momentum"), distance(&found, &expected) / largest(&expected), 1e-14);
        }
    }
}

#[test]
fn the_jacobian_is_that_of_the_other_text() {
    for (name, model) in forests() {
        let packed = PackedModel::new(&model);
        let (mut jacobian, mut other) = (PackedJacobian::new(&packed), Jacobian::new(&model.topology));
        let states = StateBatch::random(&model, 2, 5);
        for k in 0..states.count() {
            for body in 0..model.topology.bodies() {
                let found = jacobian.run(&packed, states.q(k), body).unwrap();
                let columns = other.run(&model, states.q(k), body).unwrap();
                let mut scale = 1.0;
                for column in columns {
                    scale = common::larger(scale, largest(&column.to_array()));
                }
                for (dof, (found, expected)) in found.iter().zip(columns).enumerate() {
                    let error = distance(&found.to_array(), &expected.to_array()) / scale;
                    within(&format!("{name}: body {body}, dof {dof}"), error, 1e-14);
                    assert!(*expected != Motion::zero() || *found == Motion::zero(), "{name}: off the path");
                }
            }
            assert_eq!(jacobian.columns().len(), model.topology.nv());
        }
    }
}

#[test]
fn a_robot_far_away_loses_no_digits_of_its_shape() {
    let far = Vec3::new(1048576.0, -524288.0, 262144.0);
    // a fixed base, and a floating one, which the state moves away
    for (name, mut model, floating) in
        [("fixed", dyadic_chain(&[[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]], 20), false), ("floating", build(&ROBOTS[7].1), true)]
    {
        // numbers of the near robot with few bits, so that moving it away rounds none of them
        model.placements[0].translation = Vec3::zero();
        if floating {
            model.placements[0].rotation = featherbench_spatial::Mat3::identity();
        }
        let mut states = StateBatch::random(&model, 2, 2);
        if floating {
            for k in 0..states.count() {
                states.q[k * model.topology.nq()..][..3].copy_from_slice(&[0.5, -0.25, 1.0]);
            }
        }
        let near = of_all(&model, &states);
        if floating {
            for k in 0..states.count() {
                let q = &mut states.q[k * model.topology.nq()..][..3];
                for (q, far) in q.iter_mut().zip(far.to_array()) {
                    *q += far;
                }
            }
        } else {
            model.placements[0].translation = far;
        }
        for (near, moved) in near.iter().zip(of_all(&model, &states)) {
            assert_eq!(near.exact, moved.exact, "{name}: no position of the world appears");
            for (near, moved) in near.positions.iter().zip(&moved.positions) {
                within(&format!("{name}: positions"), distance(&(*moved - far).to_array(), &near.to_array()), 2.0_f64.powi(-33));
            }
        }
    }
}

/// What a translation of the world must leave as it is, and what it moves.
struct Answers {
    exact: Vec<f64>,
    positions: Vec<Vec3<f64>>,
}

fn of_all(model: &Model<f64>, states: &StateBatch) -> Vec<Answers> {
    let packed = PackedModel::new(model);
    let last = model.topology.bodies() - 1;
    let of = |k: usize| {
        let (q, v, a) = (states.q(k), states.v(k), states.a(k));
        let mut kinematics = PackedKinematics::new(&packed);
        kinematics.run(&packed, q, v, a).unwrap();
        let momentum = PackedMomentum::new(&packed).run(&packed, q, v).unwrap();
        let mut exact = momentum.momentum.to_array().to_vec();
        exact.extend(PackedJacobian::new(&packed).run(&packed, q, last).unwrap().iter().flat_map(|column| column.to_array()));
        let mut positions = vec![momentum.center.position, PackedCenterOfMass::new(&packed).run(&packed, q).unwrap().position];
        for motion in kinematics.iter() {
            let [rotation, _, velocity, acceleration] = parts(&motion);
            exact.extend([rotation, velocity, acceleration].concat());
            positions.push(motion.placement.translation);
        }
        Answers { exact, positions }
    };
    (0..states.count()).map(of).collect()
}

#[test]
fn a_workspace_keeps_nothing_of_the_state_before() {
    for recipe in [6, 7] {
        let model = build(&ROBOTS[recipe].1);
        let packed = PackedModel::new(&model);
        let states = StateBatch::random(&model, 2, 9);
        let nan = vec![f64::NAN; model.topology.nq()];
        let mut kinematics = PackedKinematics::new(&packed);
        let mut center = PackedCenterOfMass::new(&packed);
        let mut momentum = PackedMomentum::new(&packed);
        let mut jacobian = PackedJacobian::new(&packed);
        let last = model.topology.bodies() - 1;
        for k in [0, 1, 0] {
            // what a run without numbers leaves behind
            let v = &nan[..model.topology.nv()];
            kinematics.run(&packed, &nan, v, v).unwrap();
            assert!(kinematics.iter().all(|motion| parts(&motion)[1..].iter().flatten().any(|x| x.is_nan())));
            assert!(center.run(&packed, &nan).unwrap().position.x.is_nan());
            assert!(momentum.run(&packed, &nan, v).unwrap().momentum.ang.x.is_nan());
            for body in 0..=last {
                assert!(jacobian.run(&packed, &nan, body).unwrap().iter().any(|column| column.ang.x.is_nan()));
            }

            let (q, v, a) = (states.q(k), states.v(k), states.a(k));
            kinematics.run(&packed, q, v, a).unwrap();
            let mut fresh = PackedKinematics::new(&packed);
            fresh.run(&packed, q, v, a).unwrap();
            assert!(kinematics.iter().eq(fresh.iter()));
            assert_eq!(center.run(&packed, q), PackedCenterOfMass::new(&packed).run(&packed, q));
            assert_eq!(momentum.run(&packed, q, v), PackedMomentum::new(&packed).run(&packed, q, v));
            for body in (0..=last).rev() {
                assert_eq!(jacobian.run(&packed, q, body), PackedJacobian::new(&packed).run(&packed, q, body), "body {body}");
            }
        }
    }
}

#[test]
fn a_robot_without_mass_has_no_center() {
    let mut model = dyadic_chain(&[[0.0, 1.0, 0.0]], 2);
    for inertia in &mut model.inertias {
        inertia.mass = 0.0;
        inertia.first_moment = Vec3::zero();
    }
    let packed = PackedModel::new(&model);
    let center = PackedCenterOfMass::new(&packed).run(&packed, &[0.1, 0.2]).unwrap();
    assert!(center.mass == 0.0 && center.position.x.is_nan());
    let momentum = PackedMomentum::new(&packed).run(&packed, &[0.1, 0.2], &[0.0, 0.0]).unwrap();
    assert_eq!(momentum.momentum.lin, Force::<f64>::zero().lin);
}

#[test]
fn each_wrong_length_is_named() {
    let model = PackedModel::new(&build(&ROBOTS[7].1));
    let (nq, nv, bodies) = (model.topology().nq(), model.topology().nv(), model.topology().bodies());
    let (q, x, short) = (vec![0.5; nq], vec![0.5; nv], vec![0.5; nv - 1]);
    fn named<T>(result: Result<T, DimensionError>) -> &'static str {
        result.map(|_| ()).unwrap_err().what
    }
    let mut kinematics = PackedKinematics::new(&model);
    assert_eq!(named(kinematics.run(&model, &x, &x, &x)), "configuration q");
    assert_eq!(named(kinematics.run(&model, &q, &short, &x)), "velocity v");
    assert_eq!(named(kinematics.run(&model, &q, &x, &short)), "acceleration a");
    assert_eq!(named(kinematics.set_moving(&model, &q, &short)), "velocity v");
    assert_eq!(named(kinematics.place(&model, &x)), "configuration q");
    assert_eq!(named(PackedCenterOfMass::new(&model).run(&model, &x)), "configuration q");
    assert_eq!(named(PackedMomentum::new(&model).run(&model, &q, &short)), "velocity v");
    assert_eq!(named(PackedMomentum::new(&model).run(&model, &x, &x)), "configuration q");
    assert_eq!(named(PackedJacobian::new(&model).run(&model, &x, 0)), "configuration q");
    assert_eq!(named(PackedJacobian::new(&model).run(&model, &q, bodies)), "bodies, for the one that was named");

    let other = PackedModel::new(&dyadic_chain(&[[0.0, 1.0, 0.0]], 40));
    assert_eq!(named(PackedKinematics::new(&other).run(&model, &q, &x, &x)), "blocks of the workspace");
    assert_eq!(named(PackedCenterOfMass::new(&other).run(&model, &q)), "blocks of the workspace");
    assert_eq!(named(PackedMomentum::new(&other).run(&model, &q, &x)), "blocks of the workspace");
    assert_eq!(named(PackedJacobian::new(&other).run(&model, &q, 0)), "blocks of the workspace");
    // one body less in the same number of blocks; one tree where there are two
    let [two, three] = [2, 3].map(|bodies| PackedModel::new(&dyadic_chain(&[[0.0, 1.0, 0.0]], bodies)));
    assert_eq!(named(PackedMomentum::new(&three).run(&two, &[0.0; 2], &[0.0; 2])), "bodies of the workspace");
    let mut pair = robot(&ROBOTS[0].1, 5);
    pair.bodies[4].parent = None;
    let [pair, one] = [pair, robot(&ROBOTS[0].1, 5)].map(|description| PackedModel::new(&Model::build(&description).unwrap()));
    assert_eq!(named(PackedMomentum::new(&one).run(&pair, &[0.0; 8], &[0.0; 8])), "trees of the workspace");
}
