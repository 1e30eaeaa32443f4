//! Learned models reproduce what they learned from, and motions that they have not seen.

use crate::support::{MOTION, hamiltonian, net, samples, truth, unseen};
use featherbench_learning::{BlackBox, Degrees, Dynamics, Learned, Motion, PortHamiltonian, ResidualError, Sample, Truth, held_out};
use featherbench_residuals::{Corrected, Residual, Rigid, State};

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most: f64, (a, b)| if (a - b).abs() <= most { most } else { (a - b).abs() })
}

/// Motions stay within their amplitude, and their velocities are derivatives of their configurations.
#[test]
fn motions_are_motions() {
    let fine = Motion { trajectories: 1, samples: 20_000, ..MOTION }.samples(&truth(), 1, "fine").unwrap();
    assert!(fine.iter().all(|sample| sample.q.iter().all(|q| q.abs() <= 0.8 + 1e-12)));
    let h = std::f64::consts::TAU / 0.8 / 20_000.0;
    for number in [1, 777, 15_000] {
        for joint in 0..2 {
            let central = |of: fn(&Sample) -> &Vec<f64>| (of(&fine[number + 1])[joint] - of(&fine[number - 1])[joint]) / (2.0 * h);
            // h² (ωK)³/6 of the amplitude.
            assert!((central(|s| &s.q) - fine[number].v[joint]).abs() < 1e-5);
            assert!((central(|s| &s.v) - fine[number].a[joint]).abs() < 1e-5);
        }
    }
    // Noise has the size that was asked for, and other names other motions.
    let (clean, noisy) = (samples(0.0), samples(0.1));
    let rms = |of: &dyn Fn(usize) -> f64| ((0..clean.len()).map(|k| of(k).powi(2)).sum::<f64>() / clean.len() as f64).sqrt();
    let share = rms(&|k| noisy[k].tau[0] - clean[k].tau[0]) / rms(&|k| clean[k].tau[0]);
    assert!((share - 0.1).abs() < 0.01, "{share}: the deviation of 180 draws is some 4 %");
    assert!(apart(&unseen()[3].q, &clean[3].q) > 1e-2);
}

/// Each model predicts torques of unseen motions. Degrees and sizes set what can be expected.
#[test]
fn unseen_torques_are_predicted() {
    let unseen = unseen();
    let hamiltonian = hamiltonian();
    assert!(held_out(&hamiltonian, &unseen).unwrap() < 1e-3, "{}", held_out(&hamiltonian, &unseen).unwrap());
    assert!(hamiltonian.smallest_mass(&unseen) > 0.0);
    let (net, fit) = net();
    println!("{fit:?} {}", held_out(&net, &unseen).unwrap());
    assert!(fit.left < 1e-2, "{fit:?}");
    assert!(held_out(&net, &unseen).unwrap() < 3e-2, "{}", held_out(&net, &unseen).unwrap());
    let black = BlackBox::fit(&samples(0.0), 3, 1e-10).unwrap();
    println!("{} {}", held_out(&hamiltonian, &unseen).unwrap(), held_out(&black, &unseen).unwrap());
    assert!(held_out(&black, &unseen).unwrap() > 10.0 * held_out(&hamiltonian, &unseen).unwrap(), "structure is worth something");
}

/// Forward undoes inverse dynamics, by the model's form. The black box's directions are two fits, and do not.
#[test]
fn structured_models_are_consistent() {
    let unseen = unseen();
    let (net, _) = net();
    let models: [&dyn Dynamics; 2] = [&net, &hamiltonian()];
    for model in models {
        for Sample { q, v, a, .. } in unseen.iter().step_by(9) {
            let again = model.forward(q, v, &model.inverse(q, v, a).unwrap()).unwrap();
            assert!(apart(&again, a) < 1e-10 * 20.0, "{model:?}: accelerations reach 20, and M's condition some 100");
        }
    }
    let black = BlackBox::fit(&samples(0.0), 3, 1e-10).unwrap();
    let Sample { q, v, a, .. } = &unseen[7];
    assert!(apart(&black.forward(q, v, &black.inverse(q, v, a).unwrap()).unwrap(), a) > 1e-6);
}

/// Viscous friction of the truth is found as D, and D is passive whatever the data say.
#[test]
fn damping_is_found_and_passive() {
    let mut damped = samples(0.0);
    damped.iter_mut().for_each(|sample| {
        sample.tau[0] += 0.3 * sample.v[0];
        sample.tau[1] += 0.1 * sample.v[1];
    });
    let degrees = Degrees { total: 6, damping: true };
    let found = PortHamiltonian::fit(&damped, degrees, 1e-12).unwrap();
    // What polynomials of degree 6 leave.
    assert!(apart(found.damping().as_slice(), &[0.3, 0.0, 0.0, 0.1]) < 1e-3, "{}", found.damping());
    damped.iter_mut().for_each(|sample| sample.tau[1] -= 0.5 * sample.v[1]);
    let driven = PortHamiltonian::fit(&damped, degrees, 1e-12).unwrap();
    let symmetric = (driven.damping() + driven.damping().transpose()) * 0.5;
    assert!(symmetric.symmetric_eigenvalues().min() > -1e-14, "{}", driven.damping());
}

/// A learned model as a residual of another one: inverse dynamics are then the learned model's, and so are forward dynamics.
#[test]
fn a_learned_residual_corrects_the_nominal_model() {
    let light = featherbench_learning::Arm { masses: vec![2.0, 0.8], lengths: vec![1.0, 0.5], gravity: 9.81 };
    let nominal = featherbench_model::Model::build(&light.describe()).unwrap();
    let residual = Learned::new(nominal.clone(), hamiltonian()).unwrap();
    let mut corrected = Corrected::new(Rigid::new(&nominal), residual).unwrap();
    for Sample { q, v, a, tau } in unseen().iter().step_by(11) {
        let found = corrected.inverse(q, v, a).unwrap();
        assert!(apart(&found, &hamiltonian().inverse(q, v, a).unwrap()) < 1e-12);
        assert!(apart(&corrected.forward(q, v, &found).unwrap(), a) < 1e-9, "the acceleration has rounding errors of both models");
        assert!(apart(&found, tau) < 0.05, "torques reach 30 N·m");
        // ∂r/∂a is the difference of the mass matrices.
        let due = truth().inverse(q, v, a).unwrap()[0] - featherbench_dynamics::inverse_dynamics(&nominal, q, v, a).unwrap()[0];
        assert!((corrected.residual().value(&State::new(q, v, a)).unwrap()[0] - due).abs() < 0.05);
    }
}

/// The truth itself cannot have a free joint.
#[test]
fn quaternions_are_refused() {
    let robot = featherbench_robots::Family::parse("quadruped").unwrap().generate().unwrap();
    assert!(matches!(Truth::new(featherbench_model::Model::build(&robot).unwrap()), Err(ResidualError::NotAVectorSpace { .. })));
}
