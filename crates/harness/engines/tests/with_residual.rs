//! Engines with a residual: the bits without one, the answers with one, and a residual in Python.

use featherbench_bench::measure::{ForwardScale, scaled_error};
use featherbench_bench::{Engine, NoAnswer, Quantity, Robot, WithResidual};
use featherbench_dynamics::{forward_dynamics, inverse_dynamics};
use featherbench_engines::{Featherbench, Limits, Oracle};
use featherbench_model::Model;
use featherbench_residuals::{Lag, Payload, Residual, State, Viscous, Zero};
use featherbench_results::ModelOrigin;
use featherbench_robots::Family;
use featherbench_spatial::larger;
use std::path::{Path, PathBuf};

fn robot(spec: &str) -> Robot {
    Robot::new(&Family::parse(spec).unwrap().generate().unwrap(), "test", ModelOrigin::Generated, 6, 1).unwrap()
}

fn ask(engine: &dyn Engine, robot: &Robot, quantity: Quantity) -> Result<Vec<f64>, NoAnswer> {
    let method = engine.methods(quantity).into_iter().next().unwrap_or_default();
    let mut prepared = engine.prepare(robot, quantity, &method, &robot.states)?;
    prepared.run(0..robot.states.count())?;
    Ok(prepared.read().to_vec())
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = b.iter().fold(1.0, |most: f64, x| larger(most, x.abs()));
    a.iter().zip(b).fold(0.0, |most, (a, b)| larger(most, (a - b).abs() / size))
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

/// Of two recursions over a chain of this many bodies, each to this many halves of an ulp of its terms, the difference in ulps.
///
/// A term of a joint force meets 24 roundings per body. The rotation of its joint has 5 from q, outward and inward. Two products with it
/// have 3 each. A cross product with a sum has 3 on each way. The velocity product of the acceleration has 2. Another 13 come once: the
/// inertia's products, v × I v, their sum and the projection.
fn roundings(depth: usize) -> f64 {
    24.0 * depth as f64 + 13.0
}

const ASKED: [Quantity; 2] = [Quantity::InverseDynamics, Quantity::ForwardDynamics];

#[test]
fn no_residual_changes_no_bit() {
    let own = Featherbench::new();
    let robot = robot("quadruped");
    let zero = Zero::new(robot.states.nv);
    for quantity in ASKED {
        assert_eq!(bits(&ask(&WithResidual::new(&own, &zero), &robot, quantity).unwrap()), bits(&ask(&own, &robot, quantity).unwrap()));
    }
}

/// Friction moves the joint forces; a payload makes the loaded robot.
#[test]
fn residuals_correct_an_engine() {
    let own = Featherbench::new();
    let robot = robot("chain:n=5");
    let (states, nv) = (&robot.states, robot.states.nv);
    let friction = Viscous::new(vec![0.3; nv]).unwrap();
    let with = WithResidual::new(&own, &friction);
    let [tau, a] = ASKED.map(|quantity| ask(&with, &robot, quantity).unwrap());
    let mut loaded = robot.description.clone();
    loaded.bodies[nv - 1].mass += 0.5;
    let loaded: Model<f64> = Model::build(&loaded).unwrap();
    let com = robot.description.bodies[nv - 1].com;
    let payload = Payload::new(&robot.description, nv - 1, 0.5, com, [0.0; 6]).unwrap();
    let carrying = WithResidual::new(&own, &payload);
    let [tau_loaded, a_loaded] = ASKED.map(|quantity| ask(&carrying, &robot, quantity).unwrap());
    for k in 0..states.count() {
        let (q, v, row) = (states.q(k), states.v(k), k * nv..(k + 1) * nv);
        let rubbed = |x: &[f64], sign: f64| x.iter().zip(v).map(|(x, v)| x + sign * 0.3 * v).collect::<Vec<f64>>();
        assert!(apart(&tau[row.clone()], &rubbed(&inverse_dynamics(&robot.model, q, v, states.a(k)).unwrap(), 1.0)) < 1e-14);
        assert!(apart(&a[row.clone()], &forward_dynamics(&robot.model, q, v, &rubbed(states.tau(k), -1.0)).unwrap()) < 1e-14);
        assert!(apart(&tau_loaded[row.clone()], &inverse_dynamics(&loaded, q, v, states.a(k)).unwrap()) < 1e-13);
        // κ(M) of a chain of five is some 10³.
        assert!(apart(&a_loaded[row], &forward_dynamics(&loaded, q, v, states.tau(k)).unwrap()) < 1e-11);
    }
}

/// What a residual does not correct is refused: other quantities, inner states, another robot.
#[test]
fn what_it_cannot_is_refused() {
    let own = Featherbench::new();
    let robot = robot("chain:n=5");
    let (zero, small, lag) = (Zero::new(5), Zero::new(4), Lag::new(vec![0.1; 5]).unwrap());
    let refusal =
        |residual: &dyn Residual, quantity| WithResidual::new(&own, residual).prepare(&robot, quantity, "", &robot.states).err().unwrap();
    assert!(WithResidual::new(&own, &zero).methods(Quantity::MassMatrix).is_empty());
    assert!(matches!(refusal(&zero, Quantity::MassMatrix), NoAnswer::NotOffered(_)));
    assert!(matches!(refusal(&lag, Quantity::InverseDynamics), NoAnswer::NotOffered(_)));
    assert!(matches!(refusal(&small, Quantity::InverseDynamics), NoAnswer::Failed(_)));
}

/// The interpreter of the oracles, if it is installed.
fn python() -> Option<PathBuf> {
    let python = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../target/oracles/venv/bin/python");
    python.is_file().then_some(python)
}

/// A program that serves a function of Python as a residual.
fn oracle(python: &Path, function: &str) -> Oracle {
    let oracles = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../oracles");
    let program = format!(
        "import sys; sys.path.insert(0, {oracles:?}); from featherbench_oracles.abilities.residual import serve_residual; {function}"
    );
    Oracle::start(vec![python.into(), "-P".into(), "-c".into(), program.into()], Limits::default()).unwrap()
}

/// A residual in Python corrects our kernels: friction as `Viscous`, a part of the acceleration as armature.
#[test]
fn python_corrects_an_engine() {
    let Some(python) = python() else { return println!("skipped: the oracles are not installed") };
    let own = Featherbench::new();
    let robot = robot("joints:kind=spherical,base=free");
    let nv = robot.states.nv;
    let friction = oracle(&python, "serve_residual('friction', lambda q, v, a: 0.3 * v)");
    let (far, near) = (friction.residual(&robot).unwrap(), Viscous::new(vec![0.3; nv]).unwrap());
    for quantity in ASKED {
        let [found, due] =
            [&far as &dyn Residual, &near].map(|residual| ask(&WithResidual::new(&own, residual), &robot, quantity).unwrap());
        // The same products and sums, in Python and here.
        assert_eq!(bits(&found), bits(&due));
    }
    let armature = oracle(&python, "serve_residual('armature', lambda q, v, a: 0.2 * a, acceleration=True)");
    let far = armature.residual(&robot).unwrap();
    let (states, still) = (&robot.states, vec![0.0; nv]);
    let matrix = far.by_acceleration(&State::new(states.q(0), states.v(0), &still)).unwrap();
    assert!((matrix - nalgebra::DMatrix::identity(nv, nv) * 0.2).amax() < 1e-16);
    let with = WithResidual::new(&own, &far);
    let (tau, a) = (ask(&with, &robot, ASKED[0]).unwrap(), ask(&with, &robot, ASKED[1]).unwrap());
    // By the same method: one product and one sum more, so the same bits.
    let plus = |tau: &[f64], a: &[f64]| tau.iter().zip(a).map(|(tau, a)| tau + 0.2 * a).collect::<Vec<f64>>();
    assert_eq!(bits(&tau), bits(&plus(&ask(&own, &robot, ASKED[0]).unwrap(), &states.a)));
    let mut at = robot.magnitudes();
    let mut under = states.clone();
    for (k, at) in at.iter_mut().enumerate() {
        let row = k * nv..(k + 1) * nv;
        // By the library's recursion, which is another method: the engine answers many states at once, with other products. The difference is
        // measured in the terms of each joint force.
        let due = plus(&inverse_dynamics(&robot.model, states.q(k), states.v(k), states.a(k)).unwrap(), states.a(k));
        at.joint_force.iter_mut().zip(states.a(k)).for_each(|(sum, a)| *sum += 0.2 * a.abs());
        let error = scaled_error(&robot, ASKED[0], at, &due, &tau[row.clone()]);
        assert!(error <= roundings(robot.depth) * f64::EPSILON, "state {k}: {error:e}");
        under.tau[row.clone()].iter_mut().zip(&a[row]).for_each(|(tau, a)| *tau -= 0.2 * a);
    }
    // The accelerations solve M a + h = τ − 0.2 a, in the terms of these equations: one dense solution with M to some roundings.
    let fallen = robot.clone().at(under);
    for (k, scale) in ForwardScale::all(&fallen, &at).iter().enumerate() {
        let error = scale.backward_error(&a[k * nv..(k + 1) * nv]);
        assert!(error <= 10.0 * roundings(robot.depth) * f64::EPSILON, "state {k}: {error:e}");
    }
    // A function of the wrong shape, and NaN, are errors that say so.
    for wrong in ["lambda q, v, a: v[:1]", "lambda q, v, a: v * float('nan')"] {
        let wrong = oracle(&python, &format!("serve_residual('wrong', {wrong})"));
        let error = ask(&WithResidual::new(&own, &wrong.residual(&robot).unwrap()), &robot, ASKED[0]).unwrap_err();
        assert!(error.to_string().contains("finite numbers"), "{error}");
    }
}
