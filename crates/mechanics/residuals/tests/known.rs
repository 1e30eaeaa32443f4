//! Each kind against its formula, its limits and a second route.

use crate::support::{apart, arm, cart, lesson, robots, state};
use featherbench_dynamics::{inverse_dynamics, mass_matrix};
use featherbench_model::{Model, integrate, neutral};
use featherbench_residuals::{Corrected, Payload, Residual, Rigid, SmoothCoulomb, SpringDamper, State, Stribeck, Viscous};
use featherbench_robots::Random;
use featherbench_spatial::larger;

fn of_speed(residual: &dyn Residual, v: f64) -> f64 {
    residual.value(&State::new(&[0.0], &[v], &[0.0])).unwrap()[0]
}

fn stribeck() -> Stribeck {
    Stribeck { coulomb: vec![2.0], stiction: vec![3.0], speed: vec![0.1], viscous: vec![0.5], width: vec![1e-3] }.checked().unwrap()
}

/// Friction opposes the motion, is odd, and has the values that its curve is named after.
#[test]
fn friction_has_its_curve() {
    let coulomb = SmoothCoulomb::new(vec![2.0], vec![1e-2]).unwrap();
    let viscous = Viscous::new(vec![0.5]).unwrap();
    let all: [&dyn Residual; 3] = [&coulomb, &viscous, &stribeck()];
    for friction in all {
        for v in [1e-4, 3e-3, 0.05, 0.7, 20.0] {
            assert!(v * of_speed(friction, v) > 0.0);
            assert_eq!(of_speed(friction, v), -of_speed(friction, -v));
        }
        assert_eq!(of_speed(friction, 0.0), 0.0);
    }
    assert_eq!(of_speed(&coulomb, 0.2), 2.0, "20 widths from rest it is F to the last bit");
    assert_eq!(of_speed(&viscous, 4.0), 2.0);
    // Far above its speed Stribeck's friction is F + B v; a few widths from rest it is nearly S.
    assert_eq!(of_speed(&stribeck(), 2.0), 2.0 + 0.5 * 2.0);
    assert!((of_speed(&stribeck(), 0.01) - (2.0 + (-0.01_f64).exp() + 0.005)).abs() < 1e-7, "tanh(10) is 4e-9 below one");
    // It falls where it sets off: that is Stribeck's effect, the cause of stick-slip.
    assert!(of_speed(&stribeck(), 0.05) > of_speed(&stribeck(), 0.2));
}

/// Smooth Coulomb friction creeps where the dry one sticks: at rest forces τ < F, v = w artanh(τ / F).
#[test]
fn smooth_friction_creeps() {
    let model = cart(2.0);
    let mut corrected = Corrected::new(Rigid::new(&model), SmoothCoulomb::new(vec![3.0], vec![1e-3]).unwrap()).unwrap();
    let creep = 1e-3 * (2.0_f64 / 3.0).atanh();
    // F / (m w) = 1500 per unit of speed: the rounding of v counts so much.
    assert!(corrected.forward(&[0.0], &[creep], &[2.0]).unwrap()[0].abs() < 1e-13);
}

/// A payload is the difference of the inverse dynamics of two models, and its mass matrix that of the matrices.
#[test]
fn payload_is_a_difference_of_models() {
    for light in robots() {
        let carrier = light.bodies.len() - 1;
        let (mass, com, inertia) = (0.7, [0.02, -0.03, 0.05], [3e-3, 1e-4, -2e-4, 4e-3, 3e-4, 5e-3]);
        let payload = Payload::new(&light, carrier, mass, com, inertia).unwrap();
        // The loaded body: masses add, centres weigh, inertias move to the common centre by Huygens and Steiner.
        let mut heavy = light.clone();
        let body = &mut heavy.bodies[carrier];
        let total = body.mass + mass;
        let between: Vec<f64> = body.com.iter().zip(com).map(|(a, b)| a - b).collect();
        let reduced = body.mass * mass / total;
        let square: f64 = between.iter().map(|x| x * x).sum();
        for (k, (i, j)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].into_iter().enumerate() {
            body.inertia[k] += inertia[k] + reduced * (if i == j { square } else { 0.0 } - between[i] * between[j]);
        }
        body.com = std::array::from_fn(|k| (body.mass * body.com[k] + mass * com[k]) / total);
        body.mass = total;
        let [light, heavy] = [light, heavy].map(|description| Model::<f64>::build(&description).unwrap());
        let mut random = Random::named(4, "payload");
        for _ in 0..4 {
            let [q, v, a] = state(&mut random, &light);
            let r = payload.value(&State::new(&q, &v, &a)).unwrap();
            let [without, with] = [&light, &heavy].map(|model| inverse_dynamics(model, &q, &v, &a).unwrap());
            let due: Vec<f64> = with.iter().zip(&without).map(|(with, without)| with - without).collect();
            let most = 1e-14 * with.iter().fold(1.0, |most: f64, x| larger(most, x.abs()));
            assert!(r.iter().zip(&due).all(|(r, due)| (r - due).abs() < most), "{r:?} {due:?}");
            let matrix = payload.by_acceleration(&State::new(&q, &v, &a)).unwrap();
            let due = mass_matrix(&heavy, &q).unwrap().to_dense() - mass_matrix(&light, &q).unwrap().to_dense();
            assert!((&matrix - &due).amax() < 1e-14 * mass_matrix(&heavy, &q).unwrap().to_dense().amax());
            // Forward dynamics with the payload is that of the loaded model.
            let mut corrected = Corrected::new(Rigid::new(&light), payload.clone()).unwrap();
            let (found, due) = (corrected.forward(&q, &v, &with).unwrap(), a);
            assert!(apart(&found, &due) < 1e-11, "{}", apart(&found, &due));
        }
    }
}

/// The lesson's arm with 1.2 instead of 1 kg in its second rod, as a payload.
#[test]
fn a_heavier_rod_is_a_payload() {
    let payload = Payload::new(&lesson(), 1, 0.2, [0.0, 0.0, 0.25], [0.0, 0.0, 0.0, 0.2 * 0.25 / 12.0, 0.0, 0.0]).unwrap();
    let nominal = Model::build(&lesson()).unwrap();
    let truth = Model::build(&arm([2.0, 1.2], [1.0, 0.5])).unwrap();
    let (q, v, tau) = ([0.3, -0.5], [0.7, 0.4], [1.0, -0.5]);
    let a = Corrected::new(Rigid::new(&nominal), payload).unwrap().forward(&q, &v, &tau).unwrap();
    let due = Corrected::new(Rigid::new(&truth), featherbench_residuals::Zero::new(2)).unwrap().forward(&q, &v, &tau).unwrap();
    assert!(apart(&a, &due) < 1e-14);
}

/// A spring's force is the gradient of ½ K |q ⊖ q₀|², also on a ball joint with equal stiffnesses.
#[test]
fn springs_are_gradients() {
    for description in robots() {
        let model: Model<f64> = Model::build(&description).unwrap();
        let tree = &model.topology;
        let nv = tree.nv();
        let mut random = Random::named(5, "springs");
        let rest = neutral(tree);
        let spring = SpringDamper::new(tree, vec![2.0; nv], vec![0.0; nv], rest.clone()).unwrap();
        let [q, v, a] = state(&mut random, &model);
        let r = spring.value(&State::new(&q, &v, &a)).unwrap();
        let energy = |q: &[f64]| {
            let mut bent = vec![0.0; nv];
            tree.difference(&rest, q, &mut bent).unwrap();
            bent.iter().map(|x| x * x).sum::<f64>()
        };
        for joint in tree.joints() {
            for k in joint.v..joint.v + joint.kind.nv() {
                if matches!(joint.kind, featherbench_model::JointKind::Free) {
                    continue; // the logarithm of a pose mixes metres and radians: no metric makes its square's gradient simple
                }
                let moved = |h: f64| {
                    let mut way = vec![0.0; nv];
                    way[k] = h;
                    energy(&integrate(tree, &q, &way).unwrap())
                };
                let h = 1e-5;
                let slope = (moved(h) - moved(-h)) / (2.0 * h);
                assert!((slope - r[k]).abs() < 1e-8, "{} dof {k}: {slope} {}", description.name, r[k]); // h² of the central difference
            }
        }
    }
}
