//! Derivatives along the motion, by dual numbers: each is an identity of mechanics. Every kernel on duals is compared with differences.

use crate::common;

use common::{ROBOTS, build, distance, flow, gap, largest, rate, with_rate, within, wrenches};
use featherbench_dynamics::{
    Rnea, bias_force, center_of_mass, centroidal_momentum, energy, forward_dynamics, forward_kinematics, inverse_dynamics, jacobian,
    mass_matrix,
};
use featherbench_model::Model;
use featherbench_robots::StateBatch;
use featherbench_spatial::{Dual, Force, Lift, Motion, Real, Vec3};

fn each_state(mut check: impl FnMut(&str, &Model<f64>, &[f64], &[f64], &[f64], &[f64])) {
    for (name, recipe) in &ROBOTS {
        let model = build(recipe);
        let states = StateBatch::random(&model, 5, 21);
        for k in 0..states.count() {
            check(&format!("{name}, state {k}"), &model, states.q(k), states.v(k), states.a(k), states.tau(k));
        }
    }
}

#[test]
fn power_is_the_rate_of_energy() {
    // dE/dt = τ·v
    each_state(|name, model, q, v, a, _| {
        let tau = inverse_dynamics(model, q, v, a).unwrap();
        let power: f64 = tau.iter().zip(v).map(|(tau, v)| tau * v).sum();
        let energies = energy(model, &flow(model, q, v), &with_rate(v, a)).unwrap();
        let rate = energies.kinetic.derivative + energies.potential.derivative;
        // Sums of about a hundred terms of the size of the forces, errors partly cancelling.
        within(&format!("{name}: power"), (rate - power).abs() / (1.0 + largest(&tau)), 1e-14);
    });
}

#[test]
fn acceleration_is_the_rate_of_velocity() {
    // and velocity the rate of placement, and J̇ v + J a the acceleration
    each_state(|name, model, q, v, a, _| {
        let expected = forward_kinematics(model, q, v, a).unwrap();
        let moving = forward_kinematics(model, &flow(model, q, v), &with_rate(v, a), &vec![Dual::constant(0.0); a.len()]).unwrap();
        for (body, (expected, moving)) in expected.iter().zip(moving.iter()).enumerate() {
            let velocity = rate(moving.placement.translation);
            within(&format!("{name}: ṗ of {body}"), distance(&velocity.to_array(), &expected.velocity.lin.to_array()), 2e-14);
            // Ṙ = ω × R
            let rotation_rate = rate(moving.placement.rotation.transpose().x);
            let turned = expected.velocity.ang.cross(expected.placement.rotation.transpose().x);
            within(&format!("{name}: Ṙ of {body}"), distance(&rotation_rate.to_array(), &turned.to_array()), 2e-14);
            let acceleration = Motion::new(rate(moving.velocity.ang), rate(moving.velocity.lin));
            // Squares of velocities of up to ten.
            within(&format!("{name}: v̇ of {body}"), gap(acceleration, expected.acceleration), 5e-14);

            let columns = jacobian(model, &flow(model, q, v), body).unwrap();
            let product = columns.iter().zip(with_rate(v, a)).fold(Motion::zero(), |sum, (column, v)| column.scale_add(v, sum));
            let product = Motion::new(rate(product.ang), rate(product.lin));
            within(&format!("{name}: J̇ v + J a of {body}"), gap(product, expected.acceleration), 5e-14);
        }
    });
}

#[test]
fn external_force_is_the_rate_of_momentum() {
    let (_, recipe) = ROBOTS[7];
    let model = build(&recipe);
    let states = StateBatch::random(&model, 5, 2);
    for k in 0..states.count() {
        let (q, v, a) = (states.q(k), states.v(k), states.a(k));
        let f = wrenches(&model, 4);
        let mut tau = vec![0.0; a.len()];
        Rnea::new(&model.topology).run(&model, q, v, a, Some(&f), &mut tau).unwrap();
        let moving = centroidal_momentum(&model, &flow(&model, q, v), &with_rate(v, a)).unwrap();
        let found = Force::new(rate(moving.momentum.ang), rate(moving.momentum.lin));

        // Weight, the external wrenches and the force of the base joint, about the centre of mass
        let center = center_of_mass(&model, q).unwrap();
        let mut sum = Force::new(Vec3::zero(), model.gravity * center.mass);
        let base = Force::new(Vec3::new(tau[3], tau[4], tau[5]), Vec3::new(tau[0], tau[1], tau[2]));
        let kinematics = forward_kinematics(&model, q, v, a).unwrap();
        let first = kinematics.iter().next().unwrap();
        for (body, f) in kinematics.iter().zip(f).chain([(first, base)]) {
            let (ang, lin) = (body.placement.rotation * f.ang, body.placement.rotation * f.lin);
            sum += Force::new(ang + (body.placement.translation - center.position).cross(lin), lin);
        }
        // Forces of a few hundred newtons.
        within("ḣ", distance(&found.to_array(), &sum.to_array()) / (100.0 + largest(&tau)), 1e-14);

        // Nothing from outside: momentum is conserved whatever the joints do.
        let mut free = model.clone();
        free.gravity = Vec3::zero();
        let mut tau = states.tau(k).to_vec();
        tau[..6].fill(0.0);
        let a = forward_dynamics(&free, q, v, &tau).unwrap();
        let moving = centroidal_momentum(&free, &flow(&model, q, v), &with_rate(v, &a)).unwrap();
        let drift = Force::new(rate(moving.momentum.ang), rate(moving.momentum.lin));
        within("momentum is conserved", largest(&drift.to_array()) / (1.0 + largest(&a)), 2e-14);
    }
}

/// `Ṁ − 2C` is skew for the C of the passivity argument: v·(Ṁ v) = 2 v·(h − g) along the motion.
#[test]
fn rate_of_the_mass_matrix_is_twice_the_coriolis_power() {
    each_state(|name, model, q, v, _, _| {
        let n = v.len();
        let matrix = mass_matrix(model, &flow(model, q, v)).unwrap();
        let constant: Vec<_> = v.iter().map(|&v| Dual::constant(v)).collect();
        let mut product = vec![Dual::constant(0.0); n];
        matrix.mul(&constant, &mut product).unwrap();
        let rate: f64 = product.iter().zip(v).map(|(p, v)| p.derivative * v).sum();
        let (bias, gravity) = (bias_force(model, q, v).unwrap(), bias_force(model, q, &vec![0.0; n]).unwrap());
        let power: f64 = (0..n).map(|k| v[k] * (bias[k] - gravity[k])).sum();
        // For quaternion joints v is no rate of coordinates, and the identity still holds: M depends on the shape only.
        within(&format!("{name}: vᵀṀv = 2 vᵀCv"), (rate - 2.0 * power).abs() / (1.0 + largest(&bias)), 2e-14);
    });
}

/// What every kernel gives, in the order of the labels below.
fn everything<T: Real>(model: &Model<f64>, q: &[T], v: &[T], a: &[T], tau: &[T]) -> [Vec<T>; 8]
where
    f64: Lift<T>,
{
    let mut solved = tau.to_vec();
    let matrix = mass_matrix(model, q).unwrap();
    let entries = matrix.values().to_vec();
    matrix.into_ltdl().unwrap().solve(&mut solved).unwrap();
    [
        inverse_dynamics(model, q, v, a).unwrap(),
        bias_force(model, q, v).unwrap(),
        forward_dynamics(model, q, v, tau).unwrap(),
        entries,
        solved,
        center_of_mass(model, q).unwrap().position.to_array().to_vec(),
        centroidal_momentum(model, q, v).unwrap().momentum.to_array().to_vec(),
        vec![energy(model, q, v).unwrap().kinetic],
    ]
}

/// Directional derivatives of every kernel in all inputs at once, against central differences along the flow.
#[test]
fn duals_agree_with_central_differences() {
    const STEP: f64 = 1e-6;
    each_state(|name, model, q, v, a, tau| {
        let dq: Vec<f64> = flow(model, q, v).iter().map(|x| x.derivative).collect();
        let moved = |t: f64| {
            let along = |x: &[f64], dx: &[f64]| x.iter().zip(dx).map(|(x, dx)| x + t * dx).collect::<Vec<_>>();
            everything(model, &along(q, &dq), &along(v, a), &along(a, tau), &along(tau, a))
        };
        let duals = everything(model, &with_rate(q, &dq), &with_rate(v, a), &with_rate(a, tau), &with_rate(tau, a));
        let (forward, backward) = (moved(STEP), moved(-STEP));
        let labels = ["ID", "bias", "ABA", "M", "M⁻¹τ", "centre of mass", "momentum", "energy"];
        for (k, label) in labels.into_iter().enumerate() {
            let found: Vec<f64> = duals[k].iter().map(|x| x.derivative).collect();
            let differences: Vec<f64> = forward[k].iter().zip(&backward[k]).map(|(f, b)| (f - b) / (2.0 * STEP)).collect();
            let value = largest(&forward[k]);
            // Rounding ε |f| / h is 2e-10 of the scale; truncation h² f‴/6 less, third derivatives being below a thousand times the function.
            let scale = 1.0 + value + largest(&found);
            within(&format!("{name}: derivative of {label}"), distance(&found, &differences) / scale, 1e-8);
        }
    });
}

/// Duals of parameters. τ is linear in the inertial parameters. So if all of them scale, the derivative of inverse dynamics is inverse
/// dynamics.
#[test]
fn parameters_may_be_duals() {
    fn grow(x: Dual<f64>) -> Dual<f64> {
        Dual::new(x.value, x.value)
    }
    each_state(|name, model, q, v, a, _| {
        let mut scaled = model.lift::<Dual<f64>>();
        for inertia in &mut scaled.inertias {
            inertia.mass = grow(inertia.mass);
            inertia.first_moment = Vec3::from_array(inertia.first_moment.to_array().map(grow));
            inertia.rotational = featherbench_spatial::Sym3::from_array(inertia.rotational.to_array().map(grow));
        }
        scaled.armature.iter_mut().for_each(|x| *x = grow(*x));
        let constant = |x: &[f64]| x.iter().map(|&x| Dual::constant(x)).collect::<Vec<_>>();
        let tau = inverse_dynamics(&scaled, &constant(q), &constant(v), &constant(a)).unwrap();
        let (values, rates): (Vec<f64>, Vec<f64>) = tau.iter().map(|x| (x.value, x.derivative)).unzip();
        within(&format!("{name}: τ is linear in the inertias"), distance(&values, &rates) / (1.0 + largest(&values)), 1e-14);
    });
}
