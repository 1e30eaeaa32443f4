//! The derivative of the variational midpoint rule: on every kind of joint, its transpose, and the symplectic form that it keeps.

use crate::common;
use crate::integrate::sensitivity::{Case, Driven, differences, dot};

use common::{ROBOTS, build, distance, largest, within};
use featherbench_dynamics::integrate::{
    Analytic, ByDuals, Dynamics, ImplicitMidpoint, IntegrationError, Integrator, Linearise, Passive, VariationalMidpoint, sensitivity,
};
use featherbench_dynamics::{mass_gradient, mass_matrix};
use featherbench_model::{JointKind, Model};
use featherbench_robots::{Random, StateBatch};
use featherbench_spatial::{DoubleDouble, Vec3};

/// Robots with every kind of joint, quaternions among them, motors, dampers, a wrench and a mass as parameter.
fn robots() -> impl Iterator<Item = Case> {
    ROBOTS.iter().map(|(name, recipe)| Case::new(name, build(recipe), 1))
}

#[test]
fn six_steps_on_every_kind_of_joint_are_those_of_differences() {
    for case in robots() {
        let t = &case.model.topology;
        let mut integrator = VariationalMidpoint::with_derivatives(t, case.inputs());
        let mut f = Analytic::new(&case.model, case.system.clone(), &case.parameters).unwrap();
        let direction = case.direction(3);
        let found = sensitivity(t, &mut integrator, &mut f, &case.rollout(), &direction).unwrap();
        let expected = differences(&case, &mut VariationalMidpoint::<DoubleDouble>::new(t), &direction);
        // M has eigenvalues from 10⁻² to 10: a thousand roundings per step, partly cancelling.
        let name = format!("{}: against differences", case.name);
        within(&name, distance(&found, &expected) / (1.0 + largest(&expected)), 2e-13);
    }
}

/// The derivative of one step as columns: by q, v and the inputs.
fn columns(integrator: &mut VariationalMidpoint<f64>, nv: usize, inputs: usize) -> Vec<Vec<f64>> {
    let column = |k: usize| {
        let mut direction = vec![0.0; 2 * nv + inputs];
        direction[k] = 1.0;
        let (state, du) = direction.split_at_mut(2 * nv);
        let (dq, dv) = state.split_at_mut(nv);
        integrator.push(dq, dv, du);
        direction.truncate(2 * nv);
        direction
    };
    (0..2 * nv + inputs).map(column).collect()
}

#[test]
fn pull_is_the_transpose_of_push_entry_by_entry() {
    for case in robots() {
        let (t, inputs) = (&case.model.topology, case.inputs());
        let nv = t.nv();
        let mut integrator = VariationalMidpoint::with_derivatives(t, inputs);
        let mut f = case.by_duals();
        f.set_controls(&case.controls[..case.system.motors.len()]).unwrap();
        let (mut q, mut v) = (case.q.clone(), case.v.clone());
        integrator.linearise(&mut f, 0.3, 0.02, &mut q, &mut v).unwrap();
        let (mut step_q, mut step_v) = (case.q.clone(), case.v.clone());
        VariationalMidpoint::new(t).step(&mut f, 0.3, 0.02, &mut step_q, &mut step_v).unwrap();
        assert_eq!((&q, &v), (&step_q, &step_v), "{}: the same step", case.name);

        let forward = columns(&mut integrator, nv, inputs);
        let size = largest(&forward.concat());
        for row in 0..2 * nv {
            let mut gradient = vec![0.0; 2 * nv + inputs];
            gradient[row] = 1.0;
            let (state, lu) = gradient.split_at_mut(2 * nv);
            let (lq, lv) = state.split_at_mut(nv);
            integrator.pull(lq, lv, lu);
            let expected: Vec<f64> = forward.iter().map(|column| column[row]).collect();
            // Two orders of the same products, of factors of up to a thousand.
            within(&format!("{}: row {row}", case.name), distance(&gradient, &expected) / size, 5e-14);
        }
    }
}

/// The symplectic form at momentum p: `δ₁q·δ₂p − δ₂q·δ₁p + p·[δ₁q, δ₂q]`, minus the exterior derivative of p·δq, and a bound of its
/// products. Directions are in the axes of the moving bodies. They do not commute there, hence the last term.
fn form(model: &Model<f64>, p: &[f64], x: &[f64], y: &[f64]) -> (f64, f64) {
    let nv = p.len();
    let mut sum = dot(&x[..nv], &y[nv..]) - dot(&y[..nv], &x[nv..]);
    for joint in model.topology.joints() {
        let three = |x: &[f64], k: usize| Vec3::new(x[joint.v + k], x[joint.v + k + 1], x[joint.v + k + 2]);
        match joint.kind {
            JointKind::Spherical => sum += three(p, 0).dot(three(x, 0).cross(three(y, 0))),
            // [linear; angular]
            JointKind::Free => {
                sum += three(p, 0).dot(three(x, 3).cross(three(y, 0)) - three(y, 3).cross(three(x, 0)));
                sum += three(p, 3).dot(three(x, 3).cross(three(y, 3)));
            }
            _ => {}
        }
    }
    (sum, nv as f64 * largest(x) * largest(y) * (1.0 + largest(p)))
}

/// The largest difference of SᵀJS from J, S the derivative of (q, p) → (q', p') that follows from that of (q, v) → (q', v').
fn gap<F: Linearise<f64>, I: Integrator<f64>>(model: &Model<f64>, f: &mut F, integrator: &mut I, inputs: usize) -> f64 {
    let nv = model.topology.nv();
    let states = StateBatch::random(model, 1, 6);
    let (mut q, mut v) = (states.q(0).to_vec(), states.v(0).to_vec());
    let at = |q: &[f64], v: &[f64]| {
        let (matrix, by_q) = (mass_matrix(model, q).unwrap(), mass_gradient(model, q, v).unwrap());
        let p = matrix.product(v).unwrap();
        (matrix, by_q, p)
    };
    let (before, by_q, p) = at(&q, &v);
    let factors = before.into_ltdl().unwrap();
    integrator.linearise(f, 0.0, 0.02, &mut q, &mut v).unwrap();
    let (after, next_by_q, next_p) = at(&q, &v);

    let mut random = Random::new(2, nv as u64);
    let mut worst: f64 = 0.0;
    for _ in 0..40 {
        let pair: [_; 2] = std::array::from_fn(|_| {
            let start: Vec<f64> = (0..2 * nv).map(|_| random.uniform(-1.0, 1.0)).collect();
            let (mut dq, mut dv, mut x) = (start[..nv].to_vec(), start[nv..].to_vec(), vec![0.0; nv]);
            // δv = M⁻¹ (δp − ∂p/∂q δq)
            by_q.mul(&dq, &mut x).unwrap();
            dv.iter_mut().zip(&x).for_each(|(dv, x)| *dv -= x);
            factors.solve(&mut dv).unwrap();
            integrator.push(&mut dq, &mut dv, &vec![0.0; inputs]);
            let mut end = dq.clone();
            next_by_q.mul(&dq, &mut x).unwrap();
            end.extend(after.product(&dv).unwrap().iter().zip(&x).map(|(a, b)| a + b));
            (start, end)
        });
        let (expected, start_size) = form(model, &p, &pair[0].0, &pair[1].0);
        let (found, end_size) = form(model, &next_p, &pair[0].1, &pair[1].1);
        worst = common::larger(worst, (found - expected).abs() / (start_size + end_size));
    }
    worst
}

/// Without dissipation the derivative is a symplectic matrix, on every kind of joint; with it, or by the other midpoint rule, it is not.
#[test]
fn the_derivative_keeps_the_symplectic_form() {
    for (name, recipe) in &ROBOTS {
        let mut model = build(recipe);
        // Unequal armatures of a spherical joint have no Lagrangian.
        for joint in model.topology.joints().iter().filter(|joint| joint.kind == JointKind::Spherical) {
            let first = model.armature[joint.v];
            model.armature[joint.v..joint.v + 3].fill(first);
        }
        let t = &model.topology;
        let mut free = Analytic::new(&model, Passive, &[]).unwrap();
        let found = gap(&model, &mut free, &mut VariationalMidpoint::with_derivatives(t, 0), 0);
        // Relative to a bound of all products in the form, which is hundreds of times their size: some roundings of the bound.
        within(&format!("{name}: SᵀJS − J"), found, 2e-15);

        let last = model.inertias[model.inertias.len() - 1].mass;
        let mut damped = ByDuals::new(&model, Driven { motors: Vec::new() }, &[0.5, last]).unwrap();
        let damped = gap(&model, &mut damped, &mut VariationalMidpoint::with_derivatives(t, 2), 2);
        let other = gap(&model, &mut free, &mut ImplicitMidpoint::with_derivatives(t, 0), 0);
        // The test would be empty if it did not tell them apart.
        assert!(damped > 1e-6 && other > 1e-9, "{name}: {damped:e} with dampers, {other:e} by the implicit rule");
    }
}

/// An acceleration with derivatives of its own, but no energies.
struct Still;

impl featherbench_dynamics::integrate::Acceleration<f64> for Still {
    fn acceleration(&mut self, _: f64, _: &[f64], _: &[f64], a: &mut [f64]) -> Result<(), featherbench_dynamics::Error> {
        a.fill(0.0);
        Ok(())
    }
}

#[test]
fn without_energies_or_room_there_is_no_derivative() {
    let model = build(&ROBOTS[0].1);
    let t = &model.topology;
    let states = StateBatch::random(&model, 1, 1);
    let start = (states.q(0).to_vec(), states.v(0).to_vec());
    let (mut q, mut v) = start.clone();
    let found = VariationalMidpoint::new(t).step(&mut Still, 0.0, 0.01, &mut q, &mut v);
    assert_eq!(found, Err(IntegrationError::NoEnergies));
    let mut f = Analytic::new(&model, Passive, &[]).unwrap();
    let mut lost = vec![f64::NAN; t.nv()];
    let found = VariationalMidpoint::with_derivatives(t, 0).linearise(&mut f, 2.0, 0.01, &mut q, &mut lost);
    assert_eq!(found, Err(IntegrationError::NotFinite { time: 2.0 }));
    for mut integrator in [VariationalMidpoint::new(t), VariationalMidpoint::with_derivatives(t, 1)] {
        let found = integrator.linearise(&mut f, 0.0, 0.01, &mut q, &mut v);
        assert!(matches!(found, Err(IntegrationError::Dynamics(_))), "{found:?}");
    }
    assert_eq!((q, v), start);
    let (mut q, mut v) = start;
    let mut plain = Dynamics::new(&model, Passive, &[]).unwrap();
    VariationalMidpoint::with_derivatives(t, 1).step(&mut plain, 0.0, 0.01, &mut q, &mut v).unwrap();
}
