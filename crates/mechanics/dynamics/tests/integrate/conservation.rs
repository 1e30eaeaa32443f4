//! What integrators conserve: energy, momentum, and the way back.

use crate::common;

use common::{ROBOTS, build, distance, generated, larger, largest, within};
use featherbench_dynamics::integrate::{
    Acceleration, Analytic, DormandPrince, Dynamics, ImplicitMidpoint, Instant, Integrator, Passive, RungeKutta4, SymplecticEuler, System,
};
use featherbench_dynamics::{Error, centroidal_momentum, energy};
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model, difference};
use featherbench_robots::StateBatch;
use featherbench_spatial::{Angle, Force, Vec3};

fn total_energy(model: &Model<f64>, q: &[f64], v: &[f64]) -> f64 {
    let energies = energy(model, q, v).unwrap();
    energies.kinetic + energies.potential
}

/// Linear and angular momentum about the world's origin, in world axes.
fn momentum(model: &Model<f64>, q: &[f64], v: &[f64]) -> [f64; 6] {
    let found = centroidal_momentum(model, q, v).unwrap();
    let spin = found.momentum.ang + found.center.position.cross(found.momentum.lin);
    let ([a, b, c], [d, e, f]) = (spin.to_array(), found.momentum.lin.to_array());
    [a, b, c, d, e, f]
}

/// A floating robot without gravity keeps its momentum: each integrator errs at its order.
#[test]
fn momentum_of_a_floating_robot_errs_at_the_order() {
    let mut model = generated("quadruped");
    model.gravity = Vec3::zero();
    let states = StateBatch::random(&model, 1, 8);
    let t = &model.topology;
    fn error<I: Integrator<f64>>(integrator: &mut I, model: &Model<f64>, states: &StateBatch, steps: usize) -> f64 {
        let mut f = Dynamics::new(model, Passive, &[]).unwrap();
        let (mut q, mut v) = (states.q(0).to_vec(), states.v(0).to_vec());
        for _ in 0..steps {
            integrator.step(&mut f, 0.0, 0.5 / steps as f64, &mut q, &mut v).unwrap();
        }
        distance(&momentum(model, &q, &v), &momentum(model, states.q(0), states.v(0)))
    }
    macro_rules! check {
        ($($method:ident, $steps:expr);+) => {$(
            let errors = [1, 2, 4].map(|k| error(&mut $method::new(t), &model, &states, $steps * k));
            let slope = (errors[0] / errors[2]).log2() / 2.0;
            let order = f64::from(<$method<f64> as Integrator<f64>>::ORDER);
            // At least the order; a method may do better.
            within(&format!("{}: momentum errs by {errors:?}", stringify!($method)), if slope > order { 0.0 } else { order - slope }, 0.2);
        )+};
    }
    check!(SymplecticEuler, 64; ImplicitMidpoint, 32; RungeKutta4, 16; DormandPrince, 8);
}

/// A body with three different moments of inertia, held at its centre.
fn free_body() -> Model<f64> {
    let inertia = [0.5, 0.0, 0.0, 0.9, 0.0, 1.2];
    let joint = JointDescription { kind: JointType::Spherical, ..JointDescription::default() };
    let body = BodyDescription { name: "body".into(), parent: None, mass: 1.0, com: [0.0; 3], inertia, joint };
    Model::build(&Description { gravity: [0.0; 3], bodies: vec![body], ..Description::default() }).unwrap()
}

/// Of a free body the midpoint rule conserves energy and the square of the angular momentum, to rounding over ten thousand steps.
#[test]
fn midpoint_conserves_what_is_quadratic_in_the_velocity() {
    let model = free_body();
    let mut f = Dynamics::new(&model, Passive, &[]).unwrap();
    let mut integrator = ImplicitMidpoint::new(&model.topology);
    let (mut q, mut v) = ([0.0, 0.0, 0.0, 1.0], [0.3, 2.0, 0.1]);
    let invariants = |v: &[f64]| {
        let l = [0.5 * v[0], 0.9 * v[1], 1.2 * v[2]];
        [0.5 * (l[0] * v[0] + l[1] * v[1] + l[2] * v[2]), l[0] * l[0] + l[1] * l[1] + l[2] * l[2]]
    };
    let before = invariants(&v);
    for step in 0..10_000 {
        integrator.step(&mut f, 0.05 * f64::from(step), 0.05, &mut q, &mut v).unwrap();
    }
    // 10⁴ steps, each with some roundings of 2e-16 that add like a random walk: 100 · 4 · 2e-16.
    within("energy and squared momentum", distance(&invariants(&v), &before), 1e-13);
    within("length of the quaternion", (q.iter().map(|x| x * x).sum::<f64>() - 1.0).abs(), 4.0 * f64::EPSILON);
}

/// A step back undoes a step, with any forces that depend on the state.
#[test]
fn midpoint_is_its_own_inverse() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, 1, 5);
        let mut f = Dynamics::new(&model, Passive, &[]).unwrap();
        let mut integrator = ImplicitMidpoint::new(&model.topology);
        let (mut q, mut v) = (states.q(0).to_vec(), states.v(0).to_vec());
        let h = 2e-3;
        (0..10).for_each(|_| integrator.step(&mut f, 0.0, h, &mut q, &mut v).unwrap());
        let moved = distance(&v, states.v(0));
        assert!(moved > 1e-3, "{name}: it moves");
        (0..10).for_each(|_| integrator.step(&mut f, 0.0, -h, &mut q, &mut v).unwrap());
        let way = difference(&model.topology, states.q(0), &q).unwrap();
        // Twenty steps, each with some roundings of velocities of one.
        within(&format!("{name}: there and back"), larger(largest(&way), distance(&v, states.v(0))), 2e-14);
    }
}

/// Over a hundred swings the energy of a pendulum stays near its value with the symmetric and the symplectic method. That of Runge–Kutta
/// drifts steadily.
#[test]
fn energy_of_a_pendulum_does_not_drift() {
    let joint = JointDescription { kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] }, ..JointDescription::default() };
    let bob = BodyDescription { name: "bob".into(), parent: None, mass: 1.0, com: [0.0, 0.0, -1.0], inertia: [0.0; 6], joint };
    let model: Model<f64> = Model::build(&Description { gravity: [0.0, 0.0, -1.0], bodies: vec![bob], ..Description::default() }).unwrap();
    /// The largest error of the energy in the first and in the last tenth of the time.
    fn largest_errors<I: Integrator<f64>>(mut integrator: I, model: &Model<f64>, h: f64) -> [f64; 2] {
        let steps = (700.0 / h) as usize;
        let mut f = Dynamics::new(model, Passive, &[]).unwrap();
        let (mut q, mut v) = ([1.5], [0.0]);
        let start = total_energy(model, &q, &v);
        let mut errors = [0.0; 2];
        for step in 0..steps {
            integrator.step(&mut f, 0.0, h, &mut q, &mut v).unwrap();
            let error = (total_energy(model, &q, &v) - start).abs();
            errors[0] = if step < steps / 10 { larger(errors[0], error) } else { errors[0] };
            errors[1] = if step >= steps - steps / 10 { larger(errors[1], error) } else { errors[1] };
        }
        errors
    }
    let t = &model.topology;
    for (name, [first, last]) in [
        ("symplectic Euler", largest_errors(SymplecticEuler::new(t), &model, 0.05)),
        ("midpoint", largest_errors(ImplicitMidpoint::new(t), &model, 0.05)),
    ] {
        // The error swings with an amplitude of the order. Ten swings of 140 steps each come that near to its largest value.
        within(&format!("{name}: error {first:.2e}, later {last:.2e}"), (last - first).abs() / first, 0.01);
    }
    let [first, last] = largest_errors(RungeKutta4::new(t), &model, 0.2);
    within("a steady drift is ten times as large at the end as after a tenth", (last / first - 10.0).abs(), 0.2);
}

/// The midpoint rule says when it does not converge, and leaves the state as it was.
#[test]
fn errors_leave_the_state() {
    use featherbench_dynamics::integrate::IntegrationError;
    let model = free_body();
    let mut stiff = |_: f64, _: &[f64], v: &[f64], a: &mut [f64]| -> Result<(), Error> {
        a.iter_mut().zip(v).for_each(|(a, v)| *a = -1e4 * v);
        Ok(())
    };
    let (mut q, mut v) = ([0.0, 0.0, 0.0, 1.0], [1.0, 2.0, 3.0]);
    let mut integrator = ImplicitMidpoint::new(&model.topology);
    let error = integrator.step(&mut stiff, 0.5, 1e-2, &mut q, &mut v).unwrap_err();
    assert!(matches!(error, IntegrationError::NotFinite { time } | IntegrationError::NotConverged { time, .. } if time == 0.5), "{error}");
    let nearly = integrator.step(&mut stiff, 0.5, 1.999e-4, &mut q, &mut v).unwrap_err();
    assert!(matches!(nearly, IntegrationError::NotConverged { iterations: 100, .. }), "{nearly}");
    assert!(nearly.to_string().contains("shorter step"));
    integrator.step(&mut stiff, 0.5, 1e-5, &mut q, &mut v).unwrap();
    assert!(integrator.iterations() < 30, "{}", integrator.iterations());
    // (1 − hλ/2)/(1 + hλ/2) with hλ = 0.1
    within("stable damping", (v[1] - 2.0 * 0.95 / 1.05).abs(), 4.0 * f64::EPSILON);

    let mut lost = |_: f64, _: &[f64], _: &[f64], a: &mut [f64]| -> Result<(), Error> {
        a.fill(f64::NAN);
        Ok(())
    };
    let (q0, v0) = (q, v);
    macro_rules! check {
        ($($method:ident),+) => {$(
            let error = $method::new(&model.topology).step(&mut lost, 2.0, 0.1, &mut q, &mut v).unwrap_err();
            assert_eq!(error, IntegrationError::NotFinite { time: 2.0 });
            assert_eq!((q, v), (q0, v0));
            let error = $method::new(&model.topology).step(&mut lost, 2.0, 0.1, &mut q[1..], &mut v).unwrap_err();
            assert!(matches!(error, IntegrationError::Dynamics(_)), "{error}");
            let error = $method::new(&model.topology).step(&mut lost, 2.0, 0.1, &mut q, &mut v[1..]).unwrap_err();
            assert!(matches!(error, IntegrationError::Dynamics(_)), "{error}");
        )+};
    }
    check!(SymplecticEuler, ImplicitMidpoint, RungeKutta4, DormandPrince);
    let mut dynamics = Dynamics::<_, f64>::new(&model, Passive, &[]).unwrap();
    assert!(dynamics.acceleration(0.0, &q[1..], &v, &mut [0.0; 3]).is_err() && dynamics.set_controls(&[1.0]).is_err());
}

/// Springs between a joint and its zero, so stiff that a step is many of their periods.
#[derive(Clone, Copy)]
struct Stiff;

impl System for Stiff {
    fn forces<T: Angle>(&self, at: &Instant<'_, T>, tau: &mut [T], _: &mut [Force<T>]) {
        for (tau, q) in tau.iter_mut().zip(at.q) {
            *tau -= T::from_f64(1e6) * *q;
        }
    }
}

/// Newton's method solves the step of a stiff system, which the fixed-point iteration cannot; elsewhere both find the same step.
#[test]
fn newton_solves_what_is_stiff() {
    let model = generated("chain:n=4,layout=spatial");
    let states = StateBatch::random(&model, 1, 8);
    let start: Vec<f64> = states.q(0).iter().map(|q| 0.1 * q).collect();
    let mut integrator = ImplicitMidpoint::with_derivatives(&model.topology, 0);
    let mut stiff = Analytic::new(&model, Stiff, &[]).unwrap();
    let (h, mut q, mut v) = (0.01, start.clone(), states.v(0).to_vec());
    assert!(integrator.step(&mut stiff, 0.0, h, &mut q, &mut v).is_err(), "the spring is stiff");
    assert_eq!((&q[..], &v[..]), (&start[..], states.v(0)), "after an error the state is as before");
    integrator.step_by_newton(&mut stiff, 0.0, h, &mut q, &mut v).unwrap();
    assert!(integrator.iterations() < 30, "{}", integrator.iterations());
    // v' = v + h a(middle), by a text of its own: the middle is half-way in q, and the mean in v.
    let middle: Vec<f64> = (0..4).map(|k| (start[k] + q[k]) / 2.0).collect();
    let mean: Vec<f64> = (0..4).map(|k| (states.v(0)[k] + v[k]) / 2.0).collect();
    let mut a = vec![0.0; 4];
    stiff.acceleration(h / 2.0, &middle, &mean, &mut a).unwrap();
    let found: Vec<f64> = (0..4).map(|k| (v[k] - states.v(0)[k]) / h).collect();
    // a is 1e6/M times the rounding of the middle configuration, and 1/h times that of the velocities.
    within("the midpoint equation", distance(&found, &a) / largest(&a), 1e-10);
    // The linearised step falls back on it.
    let (mut again_q, mut again_v) = (start.clone(), states.v(0).to_vec());
    integrator.linearise(&mut stiff, 0.0, h, &mut again_q, &mut again_v).unwrap();
    assert_eq!((again_q, again_v), (q, v));

    let mut passive = Analytic::new(&model, Passive, &[]).unwrap();
    let step = |newton: bool, integrator: &mut ImplicitMidpoint<f64>, f: &mut Analytic<Passive, f64>| {
        let (mut q, mut v) = (states.q(0).to_vec(), states.v(0).to_vec());
        let done = if newton { integrator.step_by_newton(f, 0.0, h, &mut q, &mut v) } else { integrator.step(f, 0.0, h, &mut q, &mut v) };
        done.unwrap();
        [q, v].concat()
    };
    let (by_newton, by_iteration) = (step(true, &mut integrator, &mut passive), step(false, &mut integrator, &mut passive));
    // Both end at the rounding of the accelerations, times h.
    within("Newton against fixed point", distance(&by_newton, &by_iteration), 1e-12);
}
