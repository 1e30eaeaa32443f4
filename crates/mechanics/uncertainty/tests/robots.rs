//! Robots: both routes against a robot that is built anew for each sample, and derivatives against duals of it.

use featherbench_dynamics::{forward_dynamics, inverse_dynamics};
use featherbench_model::{Acts, Description, Distribution, Model, Target, TargetField, Uncertain, UncertainVariable};
use featherbench_robots::{Family, StateBatch};
use featherbench_uncertainty::{Error, Points, Quantity, RobotResponse, Route, Sampling, Space, State, at, sample, spread};

fn robot(family: &str) -> Description {
    Family::parse(family).unwrap().generate().unwrap()
}

fn state(robot: &Description, quantity: Quantity) -> State {
    let model: Model<f64> = Model::build(robot).unwrap();
    let states = StateBatch::random(&model, 1, 5);
    let drive = if quantity == Quantity::Acceleration { states.tau(0) } else { states.a(0) };
    State { q: states.q(0).into(), v: states.v(0).into(), drive: drive.into() }
}

fn variable(name: &str, acts: Acts, distribution: Distribution, on: &[(usize, TargetField)]) -> UncertainVariable {
    let on = on.iter().map(|&(body, field)| Target { body, field }).collect();
    UncertainVariable { name: name.into(), distribution, acts, on }
}

/// A variable of every field; one of them acts on two bodies.
fn with_everything(family: &str) -> Description {
    let mut robot = robot(family);
    let near = Distribution::Uniform { low: 0.9, high: 1.1 };
    let last = robot.bodies.len() - 1;
    for (k, body) in robot.bodies.iter_mut().enumerate() {
        let nv = body.joint.kind.nv();
        if nv < 6 {
            body.joint.armature = vec![0.02 + 0.01 * k as f64; nv];
        }
        body.joint.damping = vec![0.3; nv];
        body.joint.friction = vec![0.1; nv];
    }
    let xx = robot.bodies[0].inertia[0];
    robot.uncertain.variables = vec![
        variable("mass", Acts::Factor, near, &[(0, TargetField::Mass), (1, TargetField::Mass)]),
        variable("density", Acts::Factor, Distribution::Gamma { mean: 1.0, deviation: 0.1 }, &[(2, TargetField::Density)]),
        variable("com", Acts::Value, Distribution::Normal { mean: 0.05, deviation: 0.02 }, &[(last, TargetField::Com(0))]),
        variable("mass of the last", Acts::Factor, near, &[(last, TargetField::Mass)]),
        variable("inertia", Acts::Value, Distribution::Uniform { low: 0.9 * xx, high: 1.1 * xx }, &[(0, TargetField::Inertia(0))]),
        variable("armature", Acts::Value, Distribution::Lognormal { mean: 0.05, deviation: 0.01 }, &[(1, TargetField::Armature(0))]),
        variable("damping", Acts::Factor, near, &[(1, TargetField::Damping(0))]),
        variable("friction", Acts::Value, Distribution::Uniform { low: 0.0, high: 0.4 }, &[(2, TargetField::Friction(0))]),
    ];
    // Fields that a body of this family has not are left out.
    let alone = |variable: &UncertainVariable| {
        let uncertain = Uncertain { variables: vec![variable.clone()], ..Uncertain::default() };
        Description { uncertain, ..robot.clone() }.validate().is_ok()
    };
    let kept: Vec<UncertainVariable> = robot.uncertain.variables.iter().filter(|variable| alone(variable)).cloned().collect();
    assert!(kept.len() >= 6, "{family}");
    robot.uncertain.variables = kept;
    robot
}

/// The answer of a robot whose description has the numbers of a sample: no text of the crate but the description's own.
fn rebuilt(robot: &Description, state: &State, quantity: Quantity, x: &[f64]) -> Vec<f64> {
    let mut changed = robot.clone();
    for (variable, x) in robot.uncertain.variables.iter().zip(x) {
        for target in &variable.on {
            let nominal = robot.nominal(*target).unwrap();
            let value = if variable.acts == Acts::Factor { nominal * x } else { *x };
            let body = &mut changed.bodies[target.body];
            match target.field {
                TargetField::Mass => body.mass = value,
                TargetField::Density => {
                    body.mass *= x;
                    body.inertia = body.inertia.map(|entry| entry * x);
                }
                TargetField::Com(k) => body.com[k] = value,
                TargetField::Inertia(k) => body.inertia[k] = value,
                TargetField::Armature(k) => body.joint.armature[k] = value,
                TargetField::Damping(k) => body.joint.damping[k] = value,
                TargetField::Friction(k) => body.joint.friction[k] = value,
            }
        }
    }
    let model: Model<f64> = Model::build(&changed).unwrap();
    let loss = |dof: usize| model.damping[dof] * state.v[dof] + model.friction[dof] * state.v[dof].signum();
    let losses: Vec<f64> = (0..state.v.len()).map(loss).collect();
    match quantity {
        Quantity::Acceleration => {
            let tau: Vec<f64> = state.drive.iter().zip(&losses).map(|(tau, loss)| tau - loss).collect();
            forward_dynamics(&model, &state.q, &state.v, &tau).unwrap()
        }
        Quantity::Torque => {
            let tau = inverse_dynamics(&model, &state.q, &state.v, &state.drive).unwrap();
            tau.iter().zip(&losses).map(|(tau, loss)| tau + loss).collect()
        }
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let norm = |list: &mut dyn Iterator<Item = f64>| list.map(|x| x * x).sum::<f64>().sqrt();
    norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / norm(&mut b.iter().copied())
}

const FAMILIES: [&str; 3] = ["chain:n=6,layout=spatial", "humanoid", "tree:n=9,seed=3,joints=all,base=free"];

/// Columns, recursion and a rebuilt robot agree to rounding: some 1e-16 of the largest term times the condition of M, 1e4 here.
#[test]
fn routes_agree_with_a_rebuilt_robot() {
    for family in FAMILIES {
        let robot = with_everything(family);
        let x: Vec<f64> =
            Space::of(&robot.uncertain).unwrap().variables().iter().enumerate().map(|(k, v)| v.quantile(0.1 + 0.1 * k as f64)).collect();
        for quantity in [Quantity::Acceleration, Quantity::Torque] {
            let state = state(&robot, quantity);
            let due = rebuilt(&robot, &state, quantity, &x);
            for route in [Route::Affine, Route::Recursive] {
                let response = RobotResponse::new(&robot, &state, quantity, Some(route)).unwrap();
                let found = at(&response, &x);
                assert!(distance(&found, &due) < 1e-11, "{family} {quantity:?} {route:?} {:e}", distance(&found, &due));
            }
        }
    }
}

/// J against central differences of the rebuilt robot, whose error is h² and ε/h: 1e-9 of the answer for h = 1e-5.
#[test]
fn derivatives_are_those_of_a_rebuilt_robot() {
    for family in FAMILIES {
        let robot = with_everything(family);
        for quantity in [Quantity::Acceleration, Quantity::Torque] {
            let state = state(&robot, quantity);
            let linear = RobotResponse::new(&robot, &state, quantity, None).unwrap().linear().unwrap();
            let due = rebuilt(&robot, &state, quantity, &linear.at);
            assert!(distance(linear.value.as_slice(), &due) < 1e-11);
            let scale = due.iter().fold(0.0_f64, |most, y| if y.abs() > most { y.abs() } else { most });
            for k in 0..linear.at.len() {
                let step = 1e-5 * linear.at[k].abs();
                let moved = |sign: f64| {
                    let mut x = linear.at.clone();
                    x[k] += sign * step;
                    rebuilt(&robot, &state, quantity, &x)
                };
                for (i, (up, down)) in moved(1.0).into_iter().zip(moved(-1.0)).enumerate() {
                    let difference = (up - down) / (2.0 * step);
                    let error = (difference - linear.jacobian[(i, k)]).abs() * linear.at[k].abs();
                    assert!(error < 1e-7 * scale, "{family} {quantity:?} row {i} variable {k}: {error:e} of {scale}");
                }
            }
        }
    }
}

/// A long chain is computed by recursion, an arm by its columns.
#[test]
fn the_cheaper_route_is_taken() {
    let of = |family: &str| {
        let mut robot = robot(family);
        robot.uncertain = spread(&robot, 0.2).unwrap();
        RobotResponse::new(&robot, &state(&robot, Quantity::Acceleration), Quantity::Acceleration, None).unwrap()
    };
    assert_eq!(of("chain:n=7,layout=spatial").route(), Route::Affine);
    assert_eq!(of("chain:n=80,layout=spatial").route(), Route::Recursive);
    // Link i moves i dofs: (i + 1)(i + 2)/2 numbers of M and i + 1 of h, less what is zero.
    assert!(of("chain:n=7,layout=spatial").terms() <= 84 + 28);
}

/// A cart of 1 kg ± 20 % at 5 m/s²: its force is in [4, 6] N, exactly.
#[test]
fn bounds_of_torques_are_exact() {
    let mut robot = robot("chain:n=3,layout=spatial");
    robot.uncertain = spread(&robot, 0.2).unwrap();
    let quantity = Quantity::Torque;
    let response = RobotResponse::new(&robot, &state(&robot, quantity), quantity, None).unwrap();
    let space = Space::of(&robot.uncertain).unwrap();
    let bounds = response.torque_bounds(&space).unwrap();
    let mut reached = vec![[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for corner in 0..8 {
        let x: Vec<f64> = (0..3).map(|k| if corner >> k & 1 == 1 { 1.2 } else { 0.8 }).collect();
        for (reached, y) in reached.iter_mut().zip(at(&response, &x)) {
            *reached = [reached[0].min(y), reached[1].max(y)];
        }
    }
    for (bound, corner) in bounds.iter().zip(reached) {
        assert!((bound[0] - corner[0]).abs() < 1e-14 * corner[0].abs() && (bound[1] - corner[1]).abs() < 1e-14 * corner[1].abs());
    }
    let forward = RobotResponse::new(&robot, &state(&robot, Quantity::Acceleration), Quantity::Acceleration, None).unwrap();
    assert!(matches!(forward.torque_bounds(&space), Err(Error::Unbounded(_))));
}

/// The routes give the same moments, and each the same bits for any number of threads.
#[test]
fn samples_of_a_robot_do_not_depend_on_threads() {
    let mut robot = robot("chain:n=7,layout=spatial");
    robot.uncertain = spread(&robot, 0.2).unwrap();
    let state = state(&robot, Quantity::Acceleration);
    let space = Space::of(&robot.uncertain).unwrap();
    let run = |route, threads| {
        let response = RobotResponse::new(&robot, &state, Quantity::Acceleration, Some(route)).unwrap();
        let linear = response.linear().unwrap();
        let settings = Sampling { points: Points::Sobol, samples: 20_000, threads: Some(threads), ..Sampling::default() };
        sample(&space, &response, Some(&linear), &settings, &|_| ()).unwrap()
    };
    let (columns, recursion) = (run(Route::Affine, 1), run(Route::Recursive, 1));
    assert_eq!(columns, run(Route::Affine, 2));
    assert_eq!(recursion, run(Route::Recursive, 2));
    for (a, b) in columns.outputs.iter().zip(&recursion.outputs) {
        assert!((a.mean.value - b.mean.value).abs() < 1e-10 * (1.0 + b.mean.value.abs()));
    }
}

#[test]
fn bad_robots_are_refused() {
    let arm = robot("chain:n=3,layout=spatial");
    let good = state(&arm, Quantity::Acceleration);
    let new = |robot: &Description, state: &State| RobotResponse::new(robot, state, Quantity::Acceleration, None).unwrap_err().to_string();
    assert!(new(&arm, &good).contains("no uncertain parameters"));
    let mut spreaded = arm.clone();
    spreaded.uncertain = spread(&arm, 0.2).unwrap();
    assert!(new(&spreaded, &State { q: vec![0.0; 2], ..good }).contains("configuration q: expected 3, found 2"));
    assert!(spread(&arm, 1.5).unwrap_err().to_string().contains("raise its lower bound"));
    assert!(spread(&arm, f64::NAN).is_err());
}
