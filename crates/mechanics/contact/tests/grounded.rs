//! A robot on the ground: its problem obeys the balance of momentum, and its steps the laws.

use featherbench_contact::{BlockGaussSeidel, Grounded, GroundedError, Newton, Solver, Touch};
use featherbench_dynamics::{bias_force, mass_matrix};
use featherbench_model::{Model, neutral};
use featherbench_robots::{Family, StateBatch};

fn model(spec: &str) -> Model<f64> {
    Model::build(&Family::parse(spec).unwrap().generate().unwrap()).unwrap()
}

/// Points below the trunk and on two shanks, so that some are closed and some are not.
fn touches(model: &Model<f64>) -> Vec<Touch> {
    let of = |body: usize, point: [f64; 3]| Touch {
        name: format!("{body}"),
        body: model.described[body],
        point,
        friction: 0.4,
        restitution: 0.0,
    };
    vec![of(0, [0.1, 0.0, -0.8]), of(0, [-0.2, 0.1, -0.8]), of(3, [0.0, 0.0, -0.9]), of(6, [0.0, 0.0, -0.9]), of(6, [0.0, 0.0, 2.0])]
}

/// The generalized momentum that a step adds is that of gravity, joint forces and impulses: M (v⁺ − v) = h (τ − C) + Jᵀ λ. Its row of the
/// base's fall, in level axes, has the sum of normal impulses.
#[test]
fn a_step_balances_momentum() {
    let model = model("quadruped");
    let robot = Grounded::new(&model, touches(&model));
    let states = StateBatch::random(&model, 12, 5);
    let (mut q, step) = (neutral::<f64>(&model.topology), 1e-2);
    q[2] = 0.7;
    // Four of the five points are closed.
    let problem = robot.problem("stance", &q, states.v(0), states.tau(0), step).unwrap().unwrap();
    assert_eq!(problem.contacts().len(), 4);
    for k in 0..states.count() {
        let (v, tau) = (states.v(k), states.tau(k));
        for solver in [&BlockGaussSeidel::default() as &dyn Solver, &Newton::default()] {
            let stepped = robot.step(&q, v, tau, step, solver).unwrap();
            let answer = stepped.solution.unwrap();
            let point = answer.point().unwrap();
            // Both end at 1e-10 of the natural map; the other residuals are up to a hundred times that.
            assert!(point.residuals.largest() <= 1e-8, "{} {:?}", solver.name(), point.residuals);
            let change: Vec<f64> = stepped.v.iter().zip(v).map(|(next, v)| next - v).collect();
            let momentum = mass_matrix(&model, &q).unwrap().product(&change).unwrap();
            let bias = bias_force(&model, &q, v).unwrap();
            let pushed: f64 = point.impulses.iter().step_by(3).sum();
            let due = step * (tau[2] - bias[2]) + pushed;
            // Some hundred roundings of momenta up to 1e3 N·s.
            assert!((momentum[2] - due).abs() <= 1e-10, "{} state {k}: {} and {due}", solver.name(), momentum[2]);
        }
    }
}

/// In the air nothing touches, and a step is free flight.
#[test]
fn in_the_air_it_falls() {
    let model = model("quadruped");
    let robot = Grounded::new(&model, touches(&model));
    let (mut q, still) = (neutral::<f64>(&model.topology), vec![0.0; model.topology.nv()]);
    q[2] = 3.0;
    assert_eq!(robot.problem("air", &q, &still, &still, 0.01).unwrap(), None);
    let stepped = robot.step(&q, &still, &still, 0.01, &Newton::default()).unwrap();
    assert!(stepped.solution.is_none());
    // Legs straight down fall with the trunk: roundings of M⁻¹.
    assert!((stepped.v[2] - 0.01 * model.gravity.z).abs() < 1e-12, "{:?} {:?}", stepped.v, model.gravity);
    assert!((stepped.q[2] - (3.0 + 1e-4 * model.gravity.z)).abs() < 1e-12);
}

#[test]
fn bad_arguments_are_named() {
    let model = model("quadruped");
    let robot = Grounded::new(&model, touches(&model));
    let (q, still) = (neutral::<f64>(&model.topology), vec![0.0; model.topology.nv()]);
    let mut bad = still.clone();
    bad[4] = f64::NAN;
    let error = robot.step(&q, &bad, &still, 0.01, &Newton::default()).unwrap_err();
    assert_eq!(error, GroundedError::NotFinite { what: "velocity v", index: 4 });
    let mut bad = q.clone();
    bad[0] = f64::INFINITY;
    assert!(matches!(robot.problem("bad", &bad, &still, &still, 0.01), Err(GroundedError::NotFinite { index: 0, .. })));
    assert!(matches!(robot.step(&q, &still, &still, f64::NAN, &Newton::default()), Err(GroundedError::NotFinite { .. })));
    assert!(matches!(robot.step(&q, &still, &still[1..], 0.01, &Newton::default()), Err(GroundedError::Dimension(_))));
    let nowhere = Touch { body: 99, ..touches(&model)[0].clone() };
    assert!(matches!(Grounded::new(&model, vec![nowhere]).problem("nowhere", &q, &still, &still, 0.01), Err(GroundedError::Dimension(_))));
}
