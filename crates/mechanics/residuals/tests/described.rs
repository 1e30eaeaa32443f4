//! Residuals of a description: each law by its formula, the bits without one, dry friction at rest with drives, and what is not well-posed.

use crate::support::{apart, draw, robots, state};
use featherbench_dynamics::inverse_dynamics;
use featherbench_model::{DescribedResidual, Description, JointType, Model, ResidualLaw};
use featherbench_residuals::{Corrected, Described, DescribedError, Residual, ResidualError, Rigid, State};
use featherbench_robots::{Family, Random};
use nalgebra::{DMatrix, DVector};

fn named(name: &str, bodies: &[usize], law: ResidualLaw) -> DescribedResidual {
    DescribedResidual { name: name.into(), bodies: bodies.into(), law }
}

fn chain(residuals: Vec<DescribedResidual>) -> (Model<f64>, Description) {
    let robot = Family::parse("chain:n=3,layout=spatial").unwrap().generate().unwrap();
    let robot = Description { residuals, ..robot };
    (Model::build(&robot).unwrap(), robot)
}

/// The joints are named in another order than the dofs.
#[test]
fn laws_are_their_formulas() {
    let (model, robot) = chain(vec![
        named("viscous", &[2, 0], ResidualLaw::Viscous { coefficient: vec![0.7, 0.4] }),
        named("coulomb", &[1], ResidualLaw::Coulomb { force: vec![0.6], width: vec![0.2] }),
        named(
            "stribeck",
            &[2],
            ResidualLaw::Stribeck { coulomb: vec![1.0], stiction: vec![1.5], speed: vec![0.3], viscous: vec![0.1], width: vec![0.05] },
        ),
        named("spring", &[1, 0], ResidualLaw::Spring { stiffness: vec![4.0, 3.0], damping: vec![0.0, 0.2], rest: vec![0.25, -0.5] }),
        named(
            "belt",
            &[2, 1],
            ResidualLaw::Linear {
                position: vec![1.0, -2.0, -3.0, 4.0],
                velocity: vec![],
                acceleration: vec![0.1, 0.2, 0.3, 0.4],
                constant: vec![5.0, 6.0],
            },
        ),
        named("dry", &[0], ResidualLaw::Dry { force: vec![0.9] }),
    ]);
    let described = Described::of(&robot).unwrap();
    let mut random = Random::named(1, "laws");
    for _ in 0..10 {
        let [q, v, a] = state(&mut random, &model);
        let stribeck = (1.0 + 0.5 * (-(v[2] / 0.3) * (v[2] / 0.3)).exp()) * (v[2] / 0.05).tanh() + 0.1 * v[2];
        let due = [
            0.4 * v[0] + 3.0 * (q[0] + 0.5) + 0.2 * v[0] + 0.9 * v[0].signum(),
            0.6 * (v[1] / 0.2).tanh() + 4.0 * (q[1] - 0.25) - 3.0 * q[2] + 4.0 * q[1] + 0.3 * a[2] + 0.4 * a[1] + 6.0,
            0.7 * v[2] + stribeck + q[2] - 2.0 * q[1] + 0.1 * a[2] + 0.2 * a[1] + 5.0,
        ];
        let at = State::new(&q, &v, &a);
        let found = described.value(&at).unwrap();
        // Some ten roundings of terms below 20.
        assert!(found.iter().zip(due).all(|(found, due)| (found - due).abs() < 1e-14 * 20.0), "{found:?} {due:?}");
        let by_acceleration = described.by_acceleration(&at).unwrap();
        let entries = [((2, 2), 0.1), ((2, 1), 0.2), ((1, 2), 0.3), ((1, 1), 0.4), ((0, 0), 0.0), ((1, 0), 0.0)];
        assert!(entries.iter().all(|&(place, due)| by_acceleration[place] == due));
        let parts = described.each(&at).unwrap();
        let sum: Vec<f64> = (0..3).map(|dof| parts.iter().map(|(_, r)| r[dof][0]).sum()).collect();
        assert_eq!(parts.iter().map(|part| part.0).collect::<Vec<_>>(), ["viscous", "coulomb", "stribeck", "spring", "belt", "dry"]);
        assert!(apart(&sum, &found) < 1e-14);
        // Forward dynamics against a dense solution of (M + A) a = τ − h − r(a = 0).
        let tau = draw(&mut random, 3);
        let still = [0.0; 3];
        let mut rigid = Rigid::new(&model);
        let bias = inverse_dynamics(&model, &q, &v, &still).unwrap();
        let rest = described.value(&State::new(&q, &v, &still)).unwrap();
        let right = DVector::from_fn(3, |k, _| tau[k] - bias[k] - rest[k]);
        let dense = (featherbench_dynamics::mass_matrix(&model, &q).unwrap().to_dense() + by_acceleration).lu().solve(&right).unwrap();
        let found = described.forward(&mut rigid, &q, &v, &tau, &[]).unwrap();
        // κ(M) of a chain of three is some 10².
        assert!(apart(&found.a, dense.as_slice()) < 1e-12, "{:?} {dense}", found.a);
        let again = Corrected::new(rigid, Described::of(&robot).unwrap()).unwrap().forward(&q, &v, &tau).unwrap();
        assert!(apart(&again, &found.a) < 1e-12);
    }
}

/// Residuals of no force, and no residuals, leave each bit, −0 too.
#[test]
fn zero_residuals_change_no_bit() {
    let zeros = |robot: &Description| {
        let last = robot.bodies.len() - 1;
        let n = robot.bodies[last].joint.kind.nv();
        let zero = vec![0.0; n];
        let unit = vec![1.0; n];
        let payload = ResidualLaw::Payload { mass: 0.0, com: [1.0, 0.0, 0.0], inertia: [0.0; 6] };
        vec![
            named("v", &[last], ResidualLaw::Viscous { coefficient: zero.clone() }),
            named("c", &[last], ResidualLaw::Coulomb { force: zero.clone(), width: unit }),
            named("d", &[last], ResidualLaw::Dry { force: zero.clone() }),
            named("p", &[last], payload),
            named("l", &[last], ResidualLaw::Linear { position: vec![], velocity: vec![], acceleration: vec![], constant: zero }),
        ]
    };
    for robot in robots() {
        let model = Model::build(&robot).unwrap();
        for residuals in [Vec::new(), zeros(&robot)] {
            let described = Described::of(&Description { residuals, ..robot.clone() }).unwrap();
            let mut random = Random::named(2, "zero");
            for _ in 0..5 {
                let [q, v, mut a] = state(&mut random, &model);
                a[0] = -0.0;
                let tau = inverse_dynamics(&model, &q, &v, &a).unwrap();
                let mut rigid = Rigid::new(&model);
                let found = described.inverse(&mut rigid, &State::new(&q, &v, &a)).unwrap();
                assert!(found.iter().zip(&tau).all(|(found, due)| found.iter().all(|x| x.to_bits() == due.to_bits())));
                let accelerations = featherbench_dynamics::forward_dynamics(&model, &q, &v, &tau).unwrap();
                let found = described.forward(&mut rigid, &q, &v, &tau, &[]).unwrap();
                assert!(found.a.iter().zip(&accelerations).all(|(a, b)| a.to_bits() == b.to_bits()));
            }
        }
    }
}

/// A payload on a flange that is fixed and turned makes the robot whose flange has that mass.
#[test]
fn a_payload_on_a_flange_is_a_heavier_flange() {
    let (_, mut robot) = chain(Vec::new());
    let mut flange = robot.bodies[2].clone();
    (flange.name, flange.parent, flange.joint.kind) = ("flange".into(), Some(2), JointType::Fixed);
    (flange.mass, flange.com, flange.inertia) = (0.0, [0.0; 3], [0.0; 6]);
    flange.joint.placement.rotation = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    flange.joint.placement.translation = [0.3, 0.1, -0.2];
    robot.bodies.push(flange);
    let mut loaded = robot.clone();
    let (mass, com, inertia) = (0.5, [0.05, -0.02, 0.1], [0.002, 1e-4, -2e-4, 0.003, 3e-4, 0.004]);
    (loaded.bodies[3].mass, loaded.bodies[3].com, loaded.bodies[3].inertia) = (mass, com, inertia);
    let [loaded, model]: [Model<f64>; 2] = [&loaded, &robot].map(|robot| Model::build(robot).unwrap());
    robot.residuals = vec![named("tool", &[3], ResidualLaw::Payload { mass, com, inertia })];
    let described = Described::of(&robot).unwrap();
    let mut random = Random::named(3, "flange");
    for _ in 0..10 {
        let [q, v, a] = state(&mut random, &model);
        let due = inverse_dynamics(&loaded, &q, &v, &a).unwrap();
        let found = described.inverse(&mut Rigid::new(&model), &State::new(&q, &v, &a)).unwrap();
        // Two sums of the same inertias.
        assert!(apart(&found.iter().map(|bounds| bounds[0]).collect::<Vec<f64>>(), &due) < 1e-13);
    }
}

/// A drive and dry friction: M a + h + F Sgn(v) = z, whatever is commanded. Joint forces less friction are not the command.
#[test]
fn drives_and_dry_friction_go_together() {
    let (model, robot) = chain(vec![
        named("lag", &[1], ResidualLaw::Lag { time: vec![0.1] }),
        named("bus", &[2, 0], ResidualLaw::Delay { periods: 2 }),
        named("dry", &[0, 1, 2], ResidualLaw::Dry { force: vec![3.0, 2.0, 1.0] }),
    ]);
    let described = Described::of(&robot).unwrap();
    assert_eq!(described.inner(), 1 + 2 * 2);
    let mut random = Random::named(4, "drives");
    for rest in [false, true] {
        let [q, drawn, _] = state(&mut random, &model);
        let v: Vec<f64> = if rest { vec![0.0, 0.0, drawn[2]] } else { drawn };
        let command = draw(&mut random, 3);
        let inner = draw(&mut random, 5);
        // The oldest command of the bus is first: dof 2, then dof 0.
        let z = [inner[2], inner[0], inner[1]];
        let found = described.forward(&mut Rigid::new(&model), &q, &v, &command, &inner).unwrap();
        let known = inverse_dynamics(&model, &q, &v, &found.a).unwrap();
        for (k, limit) in [3.0, 2.0, 1.0].into_iter().enumerate() {
            let r = z[k] - known[k];
            let due = match (v[k], found.a[k]) {
                (0.0, 0.0) => r.clamp(-limit, limit),
                (0.0, a) => limit * a.signum(),
                (v, _) => limit * v.signum(),
            };
            // Some ten roundings of joint forces below 50.
            assert!((r - due).abs() < 1e-13 * 50.0, "{k}: {r} {due}");
        }
        let mut inner = inner;
        described.advance(&mut inner, &command).unwrap();
        assert_eq!(inner[3..], [command[2], command[0]]);
    }
    // Drives that have settled change nothing.
    let springs = ResidualLaw::SeriesElastic { stiffness: vec![50.0, 80.0], damping: vec![0.5, 0.2], motor: vec![0.1, 0.2] };
    let (_, elastic) = chain(vec![named("springs", &[2, 0], springs), named("lag", &[1], ResidualLaw::Lag { time: vec![0.1] })]);
    for robot in [
        Described::of(&elastic).unwrap(),
        Described::of(&Description { residuals: robot.residuals[..2].to_vec(), ..robot.clone() }).unwrap(),
    ] {
        let [q, v, a] = state(&mut random, &model);
        let command = draw(&mut random, 3);
        let inner = robot.settled(&q, &v, &command).unwrap();
        let r = robot.value(&State::new(&q, &v, &a).with_command(&command).with_inner(&inner)).unwrap();
        // K (u/K + q − q) rounds at the size of K q.
        assert!(r.iter().all(|r| r.abs() < 1e-13), "{r:?}");
    }
    let error = described.forward(&mut Rigid::new(&model), &[0.0; 3], &[0.0; 3], &[0.0; 3], &[]).unwrap_err();
    assert!(error.to_string().contains("inner state"), "{error}");
}

/// A residual that takes all inertia away is refused when it is read; one that does so at some configuration, there.
#[test]
fn what_is_not_determined_is_refused() {
    let cancel = |inertia: f64| {
        let linear = ResidualLaw::Linear { position: vec![], velocity: vec![], acceleration: vec![-inertia], constant: vec![] };
        chain(vec![named("anti-inertia", &[2], linear)])
    };
    let (model, robot) = cancel(0.0);
    let q = featherbench_model::neutral(&model.topology);
    // The articulated inertia of the last dof: Schur's complement in M. A diagonal entry that is less by it makes M singular.
    let last = |q: &[f64]| -> f64 {
        let inverse: DMatrix<f64> = featherbench_dynamics::mass_matrix(&model, q).unwrap().to_dense().try_inverse().unwrap();
        1.0 / inverse[(2, 2)]
    };
    let articulated = last(&q);
    assert!(Described::of(&robot).is_ok());
    assert!(Described::of(&cancel(0.5 * articulated).1).is_ok());
    let error = Described::of(&cancel(articulated * (1.0 - 1e-14)).1).unwrap_err();
    assert!(matches!(error, DescribedError::Together(ResidualError::IllPosed { .. })), "{error}");
    assert!(error.to_string().contains("neutral configuration"), "{error}");
    // Elsewhere the arm has another inertia.
    let mut elsewhere = q.clone();
    (elsewhere[1], elsewhere[2]) = (0.8, 1.3);
    let there = last(&elsewhere);
    assert!((there / articulated - 1.0).abs() > 0.01, "{there} {articulated}");
    let described = Described::of(&cancel(there).1).unwrap();
    let error = described.forward(&mut Rigid::new(&model), &elsewhere, &[0.0; 3], &[1.0; 3], &[]).unwrap_err();
    assert!(matches!(error, ResidualError::IllPosed { .. }), "{error}");
}
