//! The robots of the library move as their closed forms say.

use crate::common::assert_within;
use featherbench_constrained::library::{Biped, Bricard, Ladder};
use featherbench_constrained::stabilise::{Projection, Simulation, Stabilisation};
use featherbench_constrained::{Constrained, Kkt, Mechanism, Method, Proximal, RangeSpace};
use featherbench_robots::Random;
use featherbench_spatial::largest;

fn none(_: f64, _: &[f64], _: &[f64], _: &mut [f64]) {}

fn projected(mechanism: &Mechanism) -> Simulation<'_> {
    Simulation {
        model: &mechanism.model,
        constraints: &mechanism.constraints,
        forces: &none,
        method: &Kkt { tolerance: 1e-10 },
        stabilisation: Stabilisation::Projection(Projection { tolerance: 1e-12, cut: 1e-8, iterations: 50, reach: 0.5 }),
    }
}

/// (2 m_c a²/3 + m_k a²) θ̈ = −(m_c + m_k) a g sin θ for one window, and its like for several, with random numbers at random angles.
#[test]
fn ladders_accelerate_as_the_closed_form_says() {
    let random = &mut Random::new(3, 3);
    let mut cases = 0;
    for windows in [1, 1, 1, 2, 5, 40] {
        let ladder = Ladder {
            windows,
            crank: random.uniform(0.5, 2.0),
            coupler: random.uniform(0.5, 2.0),
            crank_mass: random.uniform(0.5, 2.0),
            coupler_mass: random.uniform(0.5, 2.0),
            gravity: random.uniform(5.0, 15.0),
        };
        if windows == 1 {
            // The form of the literature.
            let Ladder { crank: a, crank_mass: c, coupler_mass: k, gravity: g, .. } = ladder;
            let due = -(c + k) * a * g * 0.4_f64.sin() / (2.0 * c * a * a / 3.0 + k * a * a);
            assert_within("closed form", (ladder.acceleration(0.4) - due).abs(), 1e-14 * due.abs());
        }
        let mechanism = ladder.mechanism().unwrap();
        let mut dynamics = Constrained::new(&mechanism.model, &mechanism.constraints).unwrap();
        for _ in 0..4 {
            let (theta, rate) = (random.uniform(-1.2, 1.2), random.uniform(-2.0, 2.0));
            let (q, v) = (ladder.spread(theta), ladder.spread(rate));
            let tau = vec![0.0; v.len()];
            let due = ladder.spread(ladder.acceleration(theta));
            // Eigenvalues of G fall with the square of the row of windows, and the proximal method divides its tolerance by them.
            for (method, tolerance) in
                [(&Kkt::default() as &dyn Method, 1e-11), (&RangeSpace::default(), 1e-9), (&Proximal::default(), 1e-6)]
            {
                let found = dynamics.run(&q, &v, &tau, method).unwrap();
                let error = largest(found.acceleration.iter().zip(&due).map(|(a, due)| a - due));
                assert_within(&format!("θ̈ of {windows} windows by {}", method.name()), error, tolerance * (1.0 + rate * rate));
                cases += 1;
            }
        }
    }
    assert_eq!(cases, 72);
}

/// Three times through the flat configuration: the parallelogram's crank against the pendulum equation, which is integrated apart. The loop
/// stays closed, and the drift of the energy is that of an integrator of order 4.
#[test]
fn the_parallelogram_passes_its_singularity() {
    let ladder = Ladder::default();
    let mechanism = ladder.mechanism().unwrap();
    let (start, rate) = (3.0, 1.0);
    let mut drifts = Vec::new();
    for (step, steps) in [(4e-3, 750), (2e-3, 1500), (1e-3, 3000)] {
        let run = projected(&mechanism).run(&ladder.spread(start), &ladder.spread(rate), step, steps).unwrap();
        let (theta, crossings) = pendulum(&ladder, start, rate, step, steps);
        assert_eq!(crossings, 3);
        assert_within("loop through the singularity", run.position_drift(), 1e-10);
        // Both have the errors of the same method, which cancel: what is left is rounding, divided by the distance from the flat state
        // at the nearest stage, about 10⁻³.
        assert_within("θ", (run.q[0] - theta).abs(), 1e-9);
        drifts.push(run.energy_drift());
    }
    for pair in drifts.windows(2) {
        // 2⁴ = 16, and what higher orders add.
        assert!((13.0..20.0).contains(&(pair[0] / pair[1])), "{drifts:?}");
    }
}

/// θ after a time by the method of Runge and Kutta, and how often all bars were on one line.
fn pendulum(ladder: &Ladder, mut theta: f64, mut speed: f64, step: f64, steps: usize) -> (f64, usize) {
    let f = |theta: f64| ladder.acceleration(theta);
    let mut crossings = 0;
    for _ in 0..steps {
        let before = theta;
        let (k1, l1) = (speed, f(theta));
        let (k2, l2) = (speed + 0.5 * step * l1, f(theta + 0.5 * step * k1));
        let (k3, l3) = (speed + 0.5 * step * l2, f(theta + 0.5 * step * k2));
        let (k4, l4) = (speed + step * l3, f(theta + step * k3));
        theta += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        speed += step / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
        crossings += usize::from(before.cos().signum() != theta.cos().signum());
    }
    (theta, crossings)
}

/// IFToMM A02 with few windows: upright, ẋ = 1 m/s at the first tip, 10 s. It passes the flat state again and again.
#[test]
fn ladders_keep_their_energy_for_ten_seconds() {
    for windows in [1, 2] {
        let ladder = Ladder { windows, ..Ladder::default() };
        let mechanism = ladder.mechanism().unwrap();
        // θ = π points up, where the tip's speed along x is −a cos θ·(−θ̇) = a θ̇.
        let (start, rate, step, steps) = (std::f64::consts::PI, 1.0 / ladder.crank, 4e-3, 2500);
        let run = projected(&mechanism).run(&ladder.spread(start), &ladder.spread(rate), step, steps).unwrap();
        let (theta, crossings) = pendulum(&ladder, start, rate, step, steps);
        assert!(crossings >= 10, "{crossings}");
        assert_within("loops", run.position_drift(), 1e-10);
        // The error of the method in 2500 steps, each of h⁵ = 1e-12 times derivatives of the motion: 2e-8 is seen.
        assert_within("energy", run.energy_drift(), 1e-7);
        assert_within("energy of the closed form", (run.drift[0].energy - ladder.energy(start, rate)).abs(), 1e-12);
        // As above; 2e-12 is seen.
        assert_within("θ", (run.q[0] - theta).abs(), 1e-9);
    }
}

/// IFToMM A04: ten seconds of the ring of six hinges keep its energy, with a row that is redundant all the time.
#[test]
fn bricard_keeps_its_energy() {
    let mechanism = Bricard::default().mechanism().unwrap();
    let run = projected(&mechanism).run(&[0.0; 5], &[0.0; 5], 2e-3, 5_000).unwrap();
    assert!(run.drift.iter().any(|drift| drift.energy.is_finite()) && run.q.iter().any(|q| q.abs() > 0.5), "it moves");
    assert_within("loop", run.position_drift(), 1e-10);
    // The error of the method in 5000 steps: 5e-9 is seen.
    assert_within("energy", run.energy_drift(), 5e-8);
}

/// A biped in free fall: its base turns and its legs swing, and its energy stays.
#[test]
fn the_biped_keeps_its_energy() {
    let mechanism = Biped::default().mechanism().unwrap();
    let model = &mechanism.model;
    let random = &mut Random::new(2, 2);
    let q = featherbench_model::neutral::<f64>(&model.topology);
    let mut v: Vec<f64> = (0..model.topology.nv()).map(|_| random.uniform(-1.0, 1.0)).collect();
    Projection::default().velocity(model, &mechanism.constraints, &q, &mut v).unwrap();
    assert!(v.iter().any(|v| v.abs() > 0.1));
    let run = projected(&mechanism).run(&q, &v, 1e-3, 300).unwrap();
    assert_within("loops", run.position_drift(), 1e-12);
    // 300 steps of h⁵·10³; 4e-12 is seen, of some ten joules.
    assert_within("energy", run.energy_drift(), 1e-9);
}
