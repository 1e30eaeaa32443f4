//! Accelerations in double-double arithmetic, against closed forms and the methods in doubles.

use crate::common::assert_within;
use featherbench_constrained::stabilise::Projection;
use featherbench_constrained::systems::{Biped, Bricard, Ladder, Pair, Squeezer, Tie};
use featherbench_constrained::{Constrained, Error, Kkt, Mechanism, RangeSpace, accelerations};
use featherbench_model::{integrate, neutral};
use featherbench_robots::Random;
use featherbench_spatial::largest;

/// The mechanism, and a state on its constraints that is drawn beside `near`.
fn drawn(mechanism: &Mechanism, near: &[f64], random: &mut Random) -> (Vec<f64>, Vec<f64>) {
    let nv = mechanism.model.topology.nv();
    let mut step = || (0..nv).map(|_| random.uniform(-0.2, 0.2)).collect::<Vec<f64>>();
    let mut q = integrate(&mechanism.model.topology, near, &step()).unwrap();
    let mut v = step();
    let closing = Projection { tolerance: 1e-13, ..Projection::default() };
    closing.configuration(&mechanism.model, &mechanism.constraints, &mut q).unwrap();
    closing.velocity(&mechanism.model, &mechanism.constraints, &q, &mut v).unwrap();
    (q, v)
}

/// θ̈ of two pendulums that are tied, by every kind of loop that is no hinge.
#[test]
fn tied_pendulums_have_their_closed_form() {
    let mut random = Random::new(4, 1);
    for tie in Tie::ALL {
        for _ in 0..20 {
            let mass = [random.uniform(0.5, 3.0), random.uniform(0.5, 3.0)];
            let length = if tie == Tie::Rod { [random.uniform(0.5, 2.0); 2] } else { [random.uniform(0.5, 2.0), random.uniform(0.5, 2.0)] };
            let bob = [random.uniform(0.0, 3.0), random.uniform(0.0, 3.0)];
            let (ratio, square) = (random.uniform(-2.0, 2.0), random.uniform(-1.0, 1.0));
            let pair = Pair { mass, bob, length, ratio, square, ..Pair::new(tie) };
            let mechanism = pair.mechanism().unwrap();
            let (theta, rate) = (random.uniform(-1.0, 1.0), random.uniform(-2.0, 2.0));
            let (q, v) = (pair.configuration(theta), pair.velocity(theta, rate));
            let found = accelerations(&mechanism.model, &mechanism.constraints, &q, &v, &[0.0; 2]).unwrap();
            let due = pair.acceleration(theta, rate);
            let missed = largest(found.iter().zip(&due).map(|(a, b)| a - b));
            // Its terms are those of gravity, and p'' times the square of the rate: some twenty roundings of the closed form in doubles.
            let terms = 1.5 * 9.81 / length[0].min(length[1]) + 2.0 * rate * rate;
            assert_within(&format!("{tie:?}"), missed / terms, 4e-15);
        }
    }
}

/// θ̈ of ladders: a rounding of the closed form, which is computed in doubles.
#[test]
fn ladders_have_their_closed_form() {
    let mut random = Random::new(4, 0);
    for windows in [1, 2, 5, 12] {
        let ladder = Ladder { windows, ..Ladder::default() };
        let mechanism = ladder.mechanism().unwrap();
        for _ in 0..20 {
            let (theta, rate) = (random.uniform(-1.2, 1.2), random.uniform(-2.0, 2.0));
            let (q, v) = (ladder.spread(theta), ladder.spread(rate));
            let found = accelerations(&mechanism.model, &mechanism.constraints, &q, &v, &vec![0.0; q.len()]).unwrap();
            let due = ladder.spread(ladder.acceleration(theta));
            // Four operations of the closed form and the rounding of our own.
            let missed = largest(found.iter().zip(&due).map(|(a, b)| a - b));
            assert_within(&format!("{windows} windows"), missed / (largest(due) + rate * rate), 6e-16);
        }
    }
}

/// Next to the flat parallelogram the rank holds, and digits are lost to the doubles of the state alone.
#[test]
fn digits_hold_beside_the_singularity() {
    let ladder = Ladder::default();
    let mechanism = ladder.mechanism().unwrap();
    for power in 1..=6 {
        let theta = std::f64::consts::FRAC_PI_2 - 10.0_f64.powi(-power);
        let (q, v) = (ladder.spread(theta), ladder.spread(1.0));
        let found = accelerations(&mechanism.model, &mechanism.constraints, &q, &v, &[0.0; 3]).unwrap();
        // The crank and the coupler have angles that are opposite to the bit, so even the state loses none.
        assert_within(&format!("10^-{power}"), (found[0] - ladder.acceleration(theta)).abs(), 1e-13);
    }
}

/// The methods in doubles agree with it on every robot of `systems`, with redundant rows and forces.
#[test]
fn methods_in_doubles_agree() {
    let mut random = Random::new(5, 0);
    let robots =
        [(Bricard::default().mechanism().unwrap(), vec![0.0; 5]), (Squeezer::default().mechanism().unwrap(), Squeezer::start().to_vec())];
    let biped = Biped::default().mechanism().unwrap();
    let upright = neutral(&biped.model.topology);
    let mut cases = 0;
    for (mechanism, near) in robots.into_iter().chain([(biped, upright)]) {
        for _ in 0..5 {
            let (q, v) = drawn(&mechanism, &near, &mut random);
            let tau: Vec<f64> = (0..v.len()).map(|_| random.uniform(-0.01, 0.01)).collect();
            let due = accelerations(&mechanism.model, &mechanism.constraints, &q, &v, &tau).unwrap();
            let mut dynamics = Constrained::new(&mechanism.model, &mechanism.constraints).unwrap();
            for (name, found) in [
                ("kkt", dynamics.run(&q, &v, &tau, &Kkt::default()).unwrap()),
                ("range space", dynamics.run(&q, &v, &tau, &RangeSpace::default()).unwrap()),
            ] {
                let missed = largest(found.acceleration.iter().zip(&due).map(|(a, b)| a - b)) / largest(due.iter().copied());
                // Inertias and rows differ by factors up to a hundred, which G squares.
                assert_within(name, missed, 1e-10);
                cases += 1;
            }
        }
    }
    assert_eq!(cases, 30);
}

#[test]
fn bad_arguments_are_refused() {
    let mechanism = Ladder::default().mechanism().unwrap();
    let ask = |q: &[f64], tau: &[f64]| accelerations(&mechanism.model, &mechanism.constraints, q, &[0.0; 3], tau);
    assert!(matches!(ask(&[0.0; 2], &[0.0; 3]), Err(Error::Dimension(_))));
    assert!(matches!(ask(&[0.0; 3], &[0.0; 2]), Err(Error::Dimension(_))));
    assert!(matches!(ask(&[f64::NAN, 0.0, 0.0], &[0.0; 3]), Err(Error::NotFinite { .. })));
    assert!(matches!(ask(&[0.0; 3], &[0.0, f64::INFINITY, 0.0]), Err(Error::NotFinite { .. })));
}
