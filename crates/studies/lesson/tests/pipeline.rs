//! The pipeline of problem 5: each stage is better on a motion that it has not seen, and without noise the last is exact.

use featherbench_lesson::pipeline::{Setting, run};

/// Some seeds, sizes and settings.
#[test]
fn each_stage_is_better() {
    for (joints, seed) in [(4, 1), (4, 2), (3, 3)] {
        let setting = Setting { joints, seed, ..Setting::default() };
        let outcome = run(&setting).unwrap();
        println!("{joints} {seed} {outcome:?}");
        assert!(outcome.touching.iter().all(|share| *share > 0.05 && *share < 0.95), "{outcome:?}");
        assert!(outcome.held_out.windows(2).all(|pair| pair[1] < pair[0]), "{outcome:?}");
        // What is left on the log is the noise.
        assert!((outcome.logged[4] / outcome.noise - 1.0).abs() < 0.1, "{outcome:?}");
        assert!(outcome.parameters[1] < outcome.parameters[0]);
    }
}

/// Without noise: least squares where the robot has no couplings, and both together where it has.
#[test]
fn without_noise_the_truth_is_found() {
    for seed in [1, 2] {
        let clean = Setting { noise: 0.0, seed, ..Setting::default() };
        let coupled = run(&clean).unwrap();
        assert!(coupled.held_out[4] < 1e-10 && coupled.parameters[1] < 1e-10, "{coupled:?}");
        assert!(coupled.held_out[3] > 1e-3, "the flow of the lesson is biased: {coupled:?}");
        let plain = run(&Setting { coupling: 0.0, ..clean }).unwrap();
        assert!(plain.held_out[2] < 1e-10 && plain.parameters[0] < 1e-10, "{plain:?}");
    }
}

/// Bad settings are refused, and none of them panics.
#[test]
fn bad_settings_are_refused() {
    for setting in [
        Setting { joints: 0, ..Setting::default() },
        Setting { samples: 2, ..Setting::default() },
        Setting { noise: f64::NAN, ..Setting::default() },
        Setting { coupling: f64::INFINITY, ..Setting::default() },
    ] {
        assert!(run(&setting).is_err(), "{setting:?}");
    }
}
