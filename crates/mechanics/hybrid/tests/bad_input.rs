//! What is no start, no parameter or no setting is refused by name.

use featherbench_hybrid::systems::{BouncingBall, RockingBlock, StickSlip};
use featherbench_hybrid::{Direction, Hybrid, HybridError, Saltation, Settings, Start, Zeno, adjoint, sensitivity, simulate};
use featherbench_spatial::Real;

fn run(theta: &[f64], mode: usize, time: f64, state: &[f64], to: f64, settings: &Settings) -> Result<(), HybridError> {
    simulate(&BouncingBall, theta, &Start { mode, time, state: state.to_vec() }, to, settings).map(|_| ())
}

#[test]
fn starts_and_parameters() {
    let (theta, state, settings) = ([9.81, 0.8], [1.0, 0.0, 0.0], Settings::default());
    assert_eq!(run(&theta, 0, 0.0, &state, 0.1, &settings), Ok(()));
    for (result, words) in [
        (run(&[9.81], 0, 0.0, &state, 1.0, &settings), "'parameters' has 1 numbers, but the system needs 2"),
        (run(&[9.81, f64::NAN], 0, 0.0, &state, 1.0, &settings), "'parameters' is NaN"),
        (run(&theta, 0, 0.0, &[1.0], 1.0, &settings), "'state' has 1 numbers, but the system needs 3"),
        (run(&theta, 0, 0.0, &[1.0, f64::INFINITY, 0.0], 1.0, &settings), "'state' is inf"),
        (run(&theta, 0, f64::NAN, &state, 1.0, &settings), "'time' is NaN"),
        (run(&theta, 0, 0.0, &state, f64::INFINITY, &settings), "'time' is inf"),
        (run(&theta, 2, 0.0, &state, 1.0, &settings), "mode 2 does not exist: the system has 2"),
        (run(&theta, 0, 1.0, &state, 0.5, &settings), "before it begins"),
    ] {
        let error = result.unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn settings() {
    let good = Settings::default();
    let zeno = Zeno::default();
    for (settings, field) in [
        (Settings { columns: 1, ..good }, "columns"),
        (Settings { columns: 13, ..good }, "columns"),
        (Settings { absolute: 0.0, ..good }, "absolute"),
        (Settings { relative: f64::NAN, ..good }, "relative"),
        (Settings { dense: 1e-3, ..good }, "dense"),
        (Settings { longest_step: 0.0, ..good }, "longest_step"),
        (Settings { longest_step: f64::NAN, ..good }, "longest_step"),
        (Settings { time: -1.0, ..good }, "time"),
        (Settings { grazing_value: f64::INFINITY, ..good }, "grazing_value"),
        (Settings { grazing_rate: 0.0, ..good }, "grazing_rate"),
        (Settings { order: f64::NAN, ..good }, "order"),
        (Settings { zeno: Some(Zeno { intervals: 3, ..zeno }), ..good }, "zeno.intervals"),
        (Settings { zeno: Some(Zeno { spread: 0.0, ..zeno }), ..good }, "zeno.spread"),
        (Settings { zeno: Some(Zeno { ratio: 1.0, ..zeno }), ..good }, "zeno.ratio"),
    ] {
        let error = run(&[9.81, 0.8], 0, 0.0, &[1.0, 0.0, 0.0], 1.0, &settings).unwrap_err();
        assert!(matches!(error, HybridError::Setting { field: found, .. } if found == field), "{field}: {error}");
    }
}

/// Numbers that are finite, but lead to others that are not.
#[test]
fn overflows() {
    let settings = Settings::default();
    // No mass.
    let start = Start { mode: 1, time: 0.0, state: vec![1.0, 0.0] };
    let error = simulate(&StickSlip, &[0.0, 1.0, 0.1, 1.0, 0.5], &start, 1.0, &settings).unwrap_err();
    assert!(matches!(error, HybridError::Overflow { what: "guard" | "flow", .. }), "{error}");
    // No size.
    let start = Start { mode: 0, time: 0.0, state: vec![0.1, 0.0] };
    let error = simulate(&RockingBlock, &[9.81, 0.0, 0.0], &start, 1.0, &settings).unwrap_err();
    assert!(matches!(error, HybridError::Overflow { .. }), "{error}");
    // Two large numbers whose product is infinite.
    let error = run(&[9.81, 1e308], 0, 0.0, &[1.0, -10.0, 0.0], 1.0, &settings).unwrap_err();
    assert!(matches!(error, HybridError::Overflow { what: "reset", .. }), "{error}");
}

/// Three states that rest, in one mode.
struct Wide;

impl Hybrid for Wide {
    fn states(&self) -> usize {
        3
    }

    fn parameters(&self) -> usize {
        0
    }

    fn flow<T: Real>(&self, _: usize, _: T, _: &[T], _: &[T], rate: &mut [T]) {
        rate.fill(T::zero());
    }

    fn guard<T: Real>(&self, _: usize, _: usize, _: T, _: &[T], _: &[T]) -> T {
        T::one()
    }
}

#[test]
fn derivatives() {
    let (theta, start) = ([9.81, 0.8], Start { mode: 0, time: 0.0, state: vec![1.0, 0.0, 0.0] });
    let run = simulate(&BouncingBall, &theta, &start, 0.7, &Settings::default()).unwrap();
    let size = |what, expected, found| HybridError::Size { what, expected, found };
    assert_eq!(sensitivity(&BouncingBall, &theta[..1], &run).unwrap_err(), size("parameters", 2, 1));
    assert_eq!(sensitivity(&StickSlip, &[1.0; 5], &run).unwrap_err(), size("state", 2, 3));
    // A run of another system of the same size, which has fewer modes.
    assert_eq!(sensitivity(&Wide, &[], &run).unwrap_err(), HybridError::Mode { mode: 1, modes: 1 });
    let mut cut = run.clone();
    cut.events.clear();
    assert_eq!(sensitivity(&BouncingBall, &theta, &cut).unwrap_err(), size("events", 1, 0));
    assert_eq!(adjoint(&BouncingBall, &theta, &run, &[1.0], &[0.0]).unwrap_err(), size("of_state", 3, 1));
    assert_eq!(adjoint(&BouncingBall, &theta, &run, &[1.0; 3], &[]).unwrap_err(), size("of_times", 1, 0));
    let at = |mode, guard, before: &[f64]| Saltation::new(&BouncingBall, &theta, mode, guard, 0, 0.0, before).unwrap_err();
    assert_eq!(at(0, 0, &[1.0]), size("state", 3, 1));
    assert_eq!(at(5, 0, &[1.0; 3]), HybridError::Mode { mode: 5, modes: 2 });
    assert_eq!(at(0, 3, &[1.0; 3]), size("guards", 4, 1));
    assert!(at(0, 0, &[f64::NAN; 3]).to_string().contains("'state' is NaN"));
}

/// x grows so fast that it is infinite at t = 1; and a guard that jumps at x = 1.9, so that Newton's method has no root to find.
struct Wild {
    guards: usize,
    jump: f64,
}

impl Hybrid for Wild {
    fn states(&self) -> usize {
        1
    }

    fn parameters(&self) -> usize {
        0
    }

    fn guards(&self, _: usize) -> usize {
        self.guards
    }

    fn direction(&self, _: usize, _: usize) -> Direction {
        Direction::Rising
    }

    fn flow<T: Real>(&self, _: usize, _: T, x: &[T], _: &[T], rate: &mut [T]) {
        rate[0] = x[0] * x[0];
    }

    fn guard<T: Real>(&self, _: usize, _: usize, _: T, x: &[T], _: &[T]) -> T {
        // x is a multiple of 2.2·10⁻¹⁶ there: the distance is never zero. The small jump is below the tolerance of grazing, and above that
        // of time.
        let distance = x[0] - T::from_f64(1.9) + T::from_f64(1e-16);
        let sign = distance / (distance * distance + T::from_f64(1e-60)).sqrt();
        distance + T::from_f64(self.jump) * sign
    }
}

#[test]
fn wild_systems() {
    let start = Start { mode: 0, time: 0.0, state: vec![1.0] };
    let run = |guards, jump| simulate(&Wild { guards, jump }, &[], &start, 2.0, &Settings::default()).unwrap_err();
    // 1/(1 − t): the steps shrink towards its pole.
    let error = run(0, 0.0);
    assert!(matches!(error, HybridError::StepTooSmall { time, .. } if (time - 1.0).abs() < 1e-12), "{error}");
    // x = 1.9 at t = 1 − 1/1.9. They shrink towards a large jump of a guard; a small one is no crossing.
    let due = 0.9 / 1.9;
    let error = run(1, 1.0);
    assert!(matches!(error, HybridError::StepTooSmall { time, .. } if (time - due).abs() < 1e-12), "{error}");
    let error = run(1, 5e-11);
    assert!(matches!(error, HybridError::NotLocated { guard: 0, time, .. } if (time - due).abs() < 1e-12), "{error}");
}
