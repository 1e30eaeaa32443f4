//! The nearest passive residual: it is nearest, its certificate holds, and its energy obeys the law.

use crate::support::{draw, lesson};
use featherbench_dynamics::{Energy, integrate::Integrator, integrate::RungeKutta4};
use featherbench_model::Model;
use featherbench_residuals::{Corrected, Linear, Passive, Projection, Residual, Rigid, State};
use featherbench_robots::Random;
use nalgebra::DMatrix;

fn projection() -> Projection {
    Projection { mass_below: DMatrix::zeros(2, 2), margin: 1e-3 }
}

/// A known projection: K = [[1, 2], [0, 1]] has the symmetric part [[1, 1], [1, 1]]; D = [[0, 3], [1, 0]] has the eigenvalues ±2 in its
/// symmetric part, of which 2 stays: [[1, 1], [1, 1]], plus the skew part [[0, 1], [−1, 0]].
#[test]
fn a_small_case_by_hand() {
    let theta = vec![1.0, 2.0, 0.0, 3.0, 0.5, 0.0, 7.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.5, -7.0];
    let (passive, distance) = Passive::nearest(&Linear::new(2, 2, theta).unwrap(), &projection()).unwrap();
    let found = passive.to_linear().unwrap();
    let due = [1.0, 1.0, 1.0, 2.0, 0.5, 0.0, 7.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.5, -7.0];
    assert!(found.theta().iter().zip(due).all(|(a, b)| (a - b).abs() < 1e-14), "{:?}", found.theta());
    // K moved by √2 (two entries by 1), D by 2 (its eigenvalue −2).
    assert!((distance - 6.0_f64.sqrt()).abs() < 1e-14, "{distance}");
}

/// Nearest: for the projection P of X and any feasible Y, ⟨X − P, Y − P⟩ ≤ 0. A projection that is projected stays.
#[test]
fn it_is_the_nearest() {
    let mut random = Random::named(11, "projections");
    let mut moved = 0;
    for _ in 0..40 {
        let raw = Linear::new(2, 2, draw(&mut random, 14)).unwrap();
        let (passive, distance) = Passive::nearest(&raw, &projection()).unwrap();
        let near = passive.to_linear().unwrap();
        let certificate = passive.certificate(&projection().mass_below).unwrap();
        assert!(certificate.holds(1.0), "{certificate:?}");
        assert!(certificate.inertia >= 1e-3 - 1e-15, "{certificate:?}");
        moved += usize::from(distance > 0.0);
        for _ in 0..20 {
            let (other, _) = Passive::nearest(&Linear::new(2, 2, draw(&mut random, 14)).unwrap(), &projection()).unwrap();
            let other = other.to_linear().unwrap();
            let product: f64 = (0..14).map(|k| (raw.theta()[k] - near.theta()[k]) * (other.theta()[k] - near.theta()[k])).sum();
            assert!(product <= 1e-13, "{product}");
        }
        let (again, distance) = Passive::nearest(&near, &projection()).unwrap();
        assert!(distance < 1e-14, "{distance}");
        assert!(again.certificate(&projection().mass_below).unwrap().holds(1.0));
    }
    assert_eq!(moved, 40);
    // The raw ones are not passive: the certificate of one says so.
    let theta = vec![0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let driven = Linear::new(2, 2, theta).unwrap();
    assert!(driven.value(&State::new(&[0.0; 2], &[1.0, 0.0], &[0.0; 2])).unwrap()[0] < 0.0);
}

/// d/dt (Ê + E) = −vᵀD v along a motion without forces. Dissipated energy is integrated beside the state.
#[test]
fn energy_obeys_the_law() {
    let model = Model::build(&lesson()).unwrap();
    let mut random = Random::named(12, "passive motion");
    let (passive, _) = Passive::nearest(&Linear::new(2, 2, draw(&mut random, 14)).unwrap(), &projection()).unwrap();
    let mut corrected = Corrected::new(Rigid::new(&model), passive.clone()).unwrap();
    let energy = |q: &[f64], v: &[f64]| {
        let own = Energy::new(&model.topology).run(&model, q, v).unwrap();
        own.kinetic + own.potential + passive.energy(q, v).unwrap()
    };
    let mut acceleration = |_: f64, q: &[f64], v: &[f64], a: &mut [f64]| {
        a.copy_from_slice(&corrected.forward(q, v, &[0.0; 2]).unwrap());
        Ok(())
    };
    let (mut q, mut v) = (vec![0.3, -0.5], vec![0.7, 0.4]);
    let (start, h, steps) = (energy(&q, &v), 1e-3, 1000);
    let mut powers = vec![passive.dissipated(&v).unwrap()];
    let mut rule = RungeKutta4::new(&model.topology);
    for step in 0..steps {
        rule.step(&mut acceleration, f64::from(step) * h, h, &mut q, &mut v).unwrap();
        powers.push(passive.dissipated(&v).unwrap());
    }
    assert!(powers.iter().all(|&power| power >= 0.0));
    // Simpson's rule.
    let lost: f64 = powers.windows(3).step_by(2).map(|p| h / 3.0 * (p[0] + 4.0 * p[1] + p[2])).sum();
    // Both rules have order four: (h·rate)⁴ with rates up to some 30/s is 1e-6 · 1e-1.
    assert!((energy(&q, &v) - start + lost).abs() < 1e-8 * start.abs().max(1.0), "{} {}", energy(&q, &v) - start, lost);
    assert!(lost > 1e-2);
}
