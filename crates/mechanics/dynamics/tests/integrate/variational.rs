//! The variational midpoint rule: momentum, symplecticity, order, the way back.

use crate::common;

use common::{ROBOTS, build, distance, larger, largest, lifted, within};
use featherbench_dynamics::integrate::{
    DormandPrince, Dynamics, Instant, IntegrationError, Integrator, Motors, Passive, System, VariationalMidpoint,
};
use featherbench_dynamics::{Error, centroidal_momentum, energy, mass_matrix};
use featherbench_model::{Model, difference, integrate};
use featherbench_robots::{Family, StateBatch};
use featherbench_spatial::{Angle, DoubleDouble, Force, Lift, Real, Vec3};

fn generated(name: &str) -> Model<f64> {
    Model::build(&Family::parse(name).unwrap().generate().unwrap()).unwrap()
}

/// Springs, dampers, and wrenches that change with time.
#[derive(Clone, Copy)]
struct Shaken;

impl System for Shaken {
    fn has_wrenches(&self) -> bool {
        true
    }

    fn forces<T: Angle>(&self, at: &Instant<'_, T>, tau: &mut [T], wrenches: &mut [Force<T>]) {
        for (tau, v) in tau.iter_mut().zip(at.v) {
            *tau -= T::from_f64(0.2) * *v;
        }
        let (sin, cos) = (at.time * T::from_f64(3.0)).sin_cos();
        for wrench in wrenches {
            *wrench = Force::new(Vec3::new(sin, cos, T::zero()) * T::from_f64(0.3), Vec3::new(cos, T::zero(), sin));
        }
    }
}

fn after<T: Angle>(model: &Model<f64>, q: &[T], v: &[T], h: f64, steps: usize) -> (Vec<T>, Vec<T>)
where
    f64: Lift<T>,
{
    let mut f = Dynamics::new(model, Shaken, &[]).unwrap();
    let mut integrator = VariationalMidpoint::new(&model.topology);
    let (mut q, mut v, h) = (q.to_vec(), v.to_vec(), T::from_f64(h));
    for step in 0..steps {
        integrator.step(&mut f, h * T::from_f64(step as f64), h, &mut q, &mut v).unwrap();
    }
    (q, v)
}

/// On every kind of joint, with forces and wrenches: the motion is that of the other integrators, and errors fall like h².
#[test]
fn the_error_falls_with_the_square() {
    const TIME: f64 = 0.03125;
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let t = &model.topology;
        let states = StateBatch::random(&model, 1, 3);
        let (mut q, mut v) = (states.q(0).to_vec(), states.v(0).to_vec());
        let mut f = Dynamics::new(&model, Shaken, &[]).unwrap();
        let mut exact = DormandPrince::new(t);
        for step in 0..64 {
            let h = TIME / 64.0;
            exact.step(&mut f, h * f64::from(step), h, &mut q, &mut v).unwrap();
        }
        let errors = [32, 64].map(|steps| {
            let (found_q, found_v) = after(&model, states.q(0), states.v(0), TIME / steps as f64, steps);
            larger(largest(&difference(t, &q, &found_q).unwrap()), distance(&found_v, &v))
        });
        within(&format!("{name}: order 2 by {errors:?}"), ((errors[0] / errors[1]).log2() - 2.0).abs(), 0.1);
    }
}

#[test]
fn momentum_is_conserved_to_rounding() {
    let mut model = generated("quadruped");
    model.gravity = Vec3::zero();
    let states = StateBatch::random(&model, 1, 8);
    let n = model.topology.nv();
    // The legs' motors push against each other: that is no force from outside.
    let mut f = Dynamics::new(&model, Motors { dofs: (6..n).collect() }, &[]).unwrap();
    f.set_controls(&states.tau(0)[6..]).unwrap();
    let mut integrator = VariationalMidpoint::new(&model.topology);
    let (mut q, mut v) = (states.q(0).to_vec(), states.v(0).to_vec());
    let momentum = |q: &[f64], v: &[f64]| {
        let found = centroidal_momentum(&model, q, v).unwrap();
        let spin = found.momentum.ang + found.center.position.cross(found.momentum.lin);
        spin.to_array().into_iter().chain(found.momentum.lin.to_array()).collect::<Vec<_>>()
    };
    let before = momentum(&q, &v);
    // The test would be empty if there were none.
    assert!(largest(&before) > 1.0, "{before:?}");
    for step in 0..200 {
        integrator.step(&mut f, 2e-3 * f64::from(step), 2e-3, &mut q, &mut v).unwrap();
    }
    // 200 steps, each with a rounding of M v and one of the solution: some 1e-15 of momenta of ten.
    within("momentum", distance(&momentum(&q, &v), &before), 5e-13);
}

/// The derivative S of (q, p) → (q', p') keeps the symplectic form: Sᵀ J S = J. By differences with 32 digits.
#[test]
fn a_step_is_a_symplectic_map() {
    let model = generated("chain:n=2,layout=planar");
    let t = &model.topology;
    type Wide = DoubleDouble;
    let wide: Model<Wide> = model.lift();
    let matrix = |q: &[Wide]| mass_matrix(&wide, q).unwrap();
    let map = |q: &[Wide], p: &[Wide]| -> Vec<Wide> {
        let mut v = p.to_vec();
        matrix(q).into_ltdl().unwrap().solve(&mut v).unwrap();
        let mut f = Dynamics::<_, Wide>::new(&model, Passive, &[]).unwrap();
        let mut q = q.to_vec();
        VariationalMidpoint::new(t).step(&mut f, Wide::zero(), Wide::from_f64(0.05), &mut q, &mut v).unwrap();
        let mut p = v.clone();
        matrix(&q).mul(&v, &mut p).unwrap();
        q.into_iter().chain(p).collect()
    };
    let (q, p): (Vec<Wide>, Vec<Wide>) = (lifted(&[0.4, -0.7]), lifted(&[0.3, 0.2]));
    const BY: f64 = 1e-9;
    let columns: Vec<Vec<f64>> = (0..4)
        .map(|k| {
            let moved = |by: f64| {
                let (mut q, mut p) = (q.clone(), p.clone());
                if k < 2 {
                    q[k] += Wide::from_f64(by)
                } else {
                    p[k - 2] += Wide::from_f64(by)
                }
                map(&q, &p)
            };
            moved(BY).iter().zip(&moved(-BY)).map(|(a, b)| (*a - *b).to_f64() / (2.0 * BY)).collect()
        })
        .collect();
    for i in 0..4 {
        for j in 0..4 {
            let form = (0..2).map(|k| columns[i][k] * columns[j][k + 2] - columns[i][k + 2] * columns[j][k]).sum::<f64>();
            let expected = if j == i + 2 {
                1.0
            } else if i == j + 2 {
                -1.0
            } else {
                0.0
            };
            // The differences err by the square of their step, 1e-18, times third derivatives of up to a hundred; sums in f64 by 1e-15.
            within(&format!("Sᵀ J S at {i}, {j}"), (form - expected).abs(), 1e-14);
        }
    }
}

#[test]
fn energy_does_not_drift_and_steps_go_back() {
    let model = generated("chain:n=2,layout=planar");
    let mut f = Dynamics::new(&model, Passive, &[]).unwrap();
    let mut integrator = VariationalMidpoint::new(&model.topology);
    // A swing about hanging down, which is q = (π/2, 0).
    let start = ([1.9, -0.2], [0.3, 0.2]);
    let (mut q, mut v) = start;
    let total = |q: &[f64], v: &[f64]| {
        let energies = energy(&model, q, v).unwrap();
        energies.kinetic + energies.potential
    };
    let (before, mut errors) = (total(&q, &v), [0.0; 2]);
    for step in 0..20_000 {
        integrator.step(&mut f, 0.0, 0.005, &mut q, &mut v).unwrap();
        let part = &mut errors[usize::from(step >= 10_000)];
        *part = larger(*part, (total(&q, &v) - before).abs());
    }
    // Some twenty swings in each half show the whole range of a regular motion.
    within(&format!("energy errs by {errors:?}"), (errors[1] - errors[0]).abs() / errors[0], 0.02);
    assert!(errors[0] > 1e-8, "an error that swings, not rounding: {errors:?}");

    let (mut q, mut v) = start;
    (0..100).for_each(|_| integrator.step(&mut f, 0.0, 0.005, &mut q, &mut v).unwrap());
    (0..100).for_each(|_| integrator.step(&mut f, 0.0, -0.005, &mut q, &mut v).unwrap());
    within("there and back", larger(distance(&q, &start.0), distance(&v, &start.1)), 1e-13);
}

#[test]
fn doubles_lose_only_roundings() {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, 1, 3);
        let (q, v): (Vec<DoubleDouble>, Vec<DoubleDouble>) = (lifted(states.q(0)), lifted(states.v(0)));
        let truth = after(&model, &q, &v, 2e-3, 4);
        let found = after(&model, states.q(0), states.v(0), 2e-3, 4);
        let way = difference(&model.topology, &truth.0, &lifted::<DoubleDouble>(&found.0)).unwrap();
        let gap = way.iter().map(|x| x.to_f64()).chain(found.1.iter().zip(&truth.1).map(|(x, y)| x - y.to_f64()));
        // v' = M⁻¹ p: M has eigenvalues from 10⁻² to 10, so a thousand roundings.
        within(&format!("{name}: rounding"), largest(&gap.collect::<Vec<_>>()), 2e-13);
    }
}

#[test]
fn what_does_not_work_is_an_error() {
    let model = generated("chain:n=2,layout=planar");
    let t = &model.topology;
    let mut f = Dynamics::new(&model, Passive, &[]).unwrap();
    let mut integrator = VariationalMidpoint::new(t);
    let (mut q, mut v) = ([0.4, -0.7], [0.3, 0.2]);
    assert!(integrator.step(&mut f, 0.0, 0.01, &mut q[1..], &mut v).is_err());
    assert!(integrator.step(&mut f, 0.0, 0.01, &mut q, &mut v[1..]).is_err());
    let before = (q, v);
    let error = integrator.step(&mut f, 3.0, 50.0, &mut q, &mut v).unwrap_err();
    assert!(matches!(error, IntegrationError::NotConverged { .. } | IntegrationError::NotFinite { .. }), "{error}");
    assert_eq!((q, v), before);
    integrator.step(&mut f, 0.0, 0.01, &mut q, &mut v).unwrap();
    assert!((2..30).contains(&integrator.iterations()), "{}", integrator.iterations());
    let mut bare = |_: f64, _: &[f64], _: &[f64], a: &mut [f64]| -> Result<(), Error> {
        a.fill(0.0);
        Ok(())
    };
    assert_eq!(integrator.step(&mut bare, 0.0, 0.01, &mut q, &mut v), Err(IntegrationError::NoEnergies));
    let moved = integrate(t, &before.0, &[0.01 * 0.3, 0.01 * 0.2]).unwrap();
    within("it moves as the velocity says", distance(&q, &moved), 2e-3);
}
