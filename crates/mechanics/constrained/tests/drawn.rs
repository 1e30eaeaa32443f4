//! Drawn configurations are projected onto the loops, whatever the seed.

use crate::share::one_of;
use featherbench_constrained::Mobility;
use featherbench_constrained::stabilise::{HALVINGS, Projection};
use featherbench_constrained::systems::{Bricard, Squeezer};
use featherbench_robots::Random;

/// Bricard's ring has a curve of configurations, and 0 to 4 of 200 draws do not end by Newton's method alone.
#[test]
fn every_draw_is_projected() {
    let systems = [
        ("Bricard", Bricard::default().mechanism().unwrap(), vec![0.0; 5], 1),
        ("Andrews' squeezer", Squeezer::default().mechanism().unwrap(), Squeezer::start().to_vec(), 1),
    ];
    let closing = Projection { tolerance: 1e-14, ..Projection::default() };
    let mut shortened = 0;
    for (name, mechanism, start, freedom) in &systems {
        let (model, constraints) = (&mechanism.model, &mechanism.constraints);
        for seed in (1..=40).step_by(one_of(8)) {
            let mut random = Random::named(seed, name);
            let freedom_at = |draw: usize| {
                let step: Vec<f64> = (0..model.topology.nv()).map(|_| random.uniform(-0.2, 0.2)).collect();
                let (q, halved) =
                    closing.beside(model, constraints, start, &step).unwrap_or_else(|error| panic!("{name} {seed} {draw}: {error}"));
                assert!(halved < HALVINGS / 2, "{name} {seed} {draw}: halved {halved} times");
                let mobility = Mobility::at(model, constraints, &q).unwrap();
                assert!(mobility.residual <= 1e-14, "{name} {seed} {draw}: {:e}", mobility.residual);
                shortened += usize::from(halved > 0);
                mobility.freedom()
            };
            assert_eq!((0..200).map(freedom_at).min(), Some(*freedom), "{name} {seed}");
        }
    }
    assert!(shortened > 0);
}
