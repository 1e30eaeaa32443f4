//! Drift, and what is done against it.

use crate::common::{EVERY_JOINT, assert_within, model};
use featherbench_constrained::stabilise::{Projection, Simulation, Stabilisation};
use featherbench_constrained::systems::{Biped, Ladder};
use featherbench_constrained::{Attachment, Constraint, Constraints, Error, Kkt, Mechanism, Proximal, Rows};
use featherbench_dynamics::mass_matrix;
use featherbench_robots::StateBatch;
use featherbench_spatial::largest;

fn none(_: f64, _: &[f64], _: &[f64], _: &mut [f64]) {}

fn simulation(mechanism: &Mechanism, stabilisation: Stabilisation) -> Simulation<'_> {
    let method = &Kkt { tolerance: 1e-10 };
    Simulation { model: &mechanism.model, constraints: &mechanism.constraints, forces: &none, method, stabilisation }
}

/// Without help φ grows, with the order of the integrator; Baumgarte's stays bounded and is smaller; projection's is rounding.
#[test]
fn each_stabilisation_has_its_drift() {
    // A chain in space whose tip is held where it is at the start. (Parallelograms do not drift: their φ is linear along the motion.)
    let arm = model("chain:n=5,layout=spatial");
    let q = [0.3, 0.6, -0.5, 0.8, 0.4];
    let tip = Attachment::point(4, [0.2, 0.1, 0.0]);
    let still = [0.0; 5];
    let placed = featherbench_dynamics::forward_kinematics(&arm, &q, &still, &still).unwrap().body(4).unwrap().placement;
    let held = Constraint::point("tip", Attachment::world(placed.point(tip.placement.translation).to_array()), tip);
    let constraints = Constraints::new(&arm.topology, vec![held]).unwrap();
    let run = |stabilisation, step, steps| {
        let method = &Kkt { tolerance: 1e-10 };
        let simulation = Simulation { model: &arm, constraints: &constraints, forces: &none, method, stabilisation };
        simulation.run(&q, &still, step, steps).unwrap()
    };
    let free: Vec<f64> = [(8e-3, 500), (4e-3, 1000), (2e-3, 2000)]
        .into_iter()
        .map(|(step, steps)| run(Stabilisation::None, step, steps).position_drift())
        .collect();
    for pair in free.windows(2) {
        // 2⁴ for the order of the method, up to 2⁵ where its first error term cancels in φ.
        assert!((12.0..40.0).contains(&(pair[0] / pair[1])), "{free:?}");
    }
    let held = run(Stabilisation::Baumgarte { alpha: 20.0, beta: 20.0 }, 4e-3, 1000);
    assert!(held.position_drift() < 0.5 * free[1], "{:e} of {:e}", held.position_drift(), free[1]);
    let projected = run(Stabilisation::Projection(Projection::default()), 4e-3, 1000);
    assert!(projected.position_drift() <= 1e-12 && projected.drift.iter().all(|drift| drift.velocity < 1e-12));
    assert_eq!((projected.drift.len(), projected.drift[1000].time), (1001, 4.0));
}

/// A loop that is open by φ₀ at rest closes as φ₀ (1 + αt) e^(−αt), for α = β.
#[test]
fn baumgarte_closes_a_loop_as_the_formula_says() {
    let ladder = Ladder { gravity: 0.0, ..Ladder::default() };
    let mechanism = ladder.mechanism().unwrap();
    let mut q = ladder.spread(0.4);
    q[1] += 1e-3;
    let (alpha, step) = (10.0, 1e-3);
    let run = simulation(&mechanism, Stabilisation::Baumgarte { alpha, beta: alpha }).run(&q, &[0.0; 3], step, 500).unwrap();
    let start = run.drift[0].position;
    assert!(start > 5e-4, "{start}");
    for drift in &run.drift {
        let due = start * (1.0 + alpha * drift.time) * (-alpha * drift.time).exp();
        // φ̈ is prescribed exactly for every row at once; what is left is the error of the integrator, (αh)⁴/120 of φ₀.
        assert_within("φ(t)", (drift.position - due).abs(), 1e-10 * start.max(1.0));
    }
}

/// The projected velocity has J v = 0 and is the nearest one: what was taken away is orthogonal to it in the metric of M.
#[test]
fn velocities_are_projected_in_the_metric_of_m() {
    for spec in EVERY_JOINT {
        let model = model(spec);
        let constraints = crate::common::every_law(&model, 3);
        let states = StateBatch::random(&model, 3, 6);
        for k in 0..states.count() {
            let mut v = states.v(k).to_vec();
            Projection { cut: 1e-10, ..Projection::default() }.velocity(&model, &constraints, states.q(k), &mut v).unwrap();
            let mut rows = Rows::new(&constraints);
            rows.run(&model, &constraints, states.q(k), &v).unwrap();
            let mut rate = vec![0.0; constraints.rows()];
            rows.multiply(&v, &mut rate).unwrap();
            // κ(J)·ε, up to 10⁵ ε.
            assert_within("J v", largest(rate), 1e-10);
            let taken: Vec<f64> = states.v(k).iter().zip(&v).map(|(before, after)| before - after).collect();
            let momentum = mass_matrix(&model, states.q(k)).unwrap().product(&taken).unwrap();
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let (energy, cross) = (dot(&momentum, &taken), dot(&momentum, &v));
            assert!(energy > 1e-3);
            assert_within("vᵀM(v₀ − v)", cross.abs() / energy, 1e-10);
        }
    }
}

/// A biped in free fall: its base turns and its legs swing, and its energy stays.
#[test]
fn the_biped_keeps_its_energy() {
    let mechanism = Biped::default().mechanism().unwrap();
    let model = &mechanism.model;
    let random = &mut featherbench_robots::Random::new(2, 2);
    let q = featherbench_model::neutral::<f64>(&model.topology);
    let mut v: Vec<f64> = (0..model.topology.nv()).map(|_| random.uniform(-1.0, 1.0)).collect();
    Projection::default().velocity(model, &mechanism.constraints, &q, &mut v).unwrap();
    assert!(v.iter().any(|v| v.abs() > 0.1));
    let run = simulation(&mechanism, Stabilisation::Projection(Projection::default())).run(&q, &v, 1e-3, 300).unwrap();
    assert_within("loops", run.position_drift(), 1e-12);
    // 300 steps of h⁵·10³; 4e-12 is seen, of some ten joules.
    assert_within("energy", run.energy_drift(), 1e-9);
}

#[test]
fn bad_parameters_and_open_loops_are_refused() {
    let ladder = Ladder::default();
    let mechanism = ladder.mechanism().unwrap();
    let (q, v) = (ladder.spread(0.3), ladder.spread(0.0));
    for (alpha, beta) in [(f64::NAN, 1.0), (1.0, -1.0), (f64::INFINITY, 0.0)] {
        let found = simulation(&mechanism, Stabilisation::Baumgarte { alpha, beta }).run(&q, &v, 1e-3, 1);
        assert!(matches!(found, Err(Error::Parameter { .. })), "{found:?}");
    }
    for step in [0.0, f64::NAN] {
        let found = simulation(&mechanism, Stabilisation::None).run(&q, &v, step, 1);
        assert!(matches!(found, Err(Error::Parameter { parameter: "step", .. })));
    }
    assert!(matches!(simulation(&mechanism, Stabilisation::None).run(&q, &[0.0; 2], 1e-3, 1), Err(Error::Dimension(_))));
    // An iterative method that reaches its cap ends the run.
    let method = &Proximal { mu: 10.0, iterations: 1, ..Proximal::default() };
    let capped = Simulation { method, ..simulation(&mechanism, Stabilisation::None) };
    assert!(matches!(capped.run(&q, &v, 1e-3, 1), Err(Error::NotConverged { iterations: 1, .. })));
    // A tip that is held farther away than the arm reaches.
    let arm = model("chain:n=3");
    let held = Constraint::point("tip", Attachment::world([100.0, 0.0, 0.0]), Attachment::point(2, [0.0; 3]));
    let constraints = Constraints::new(&arm.topology, vec![held]).unwrap();
    let mut q = [0.1, 0.2, 0.3];
    let found = Projection::default().configuration(&arm, &constraints, &mut q);
    assert!(matches!(found, Err(Error::NotConverged { residual, .. }) if residual > 90.0), "{found:?}");
    assert_eq!(q, [0.1, 0.2, 0.3]);
}
