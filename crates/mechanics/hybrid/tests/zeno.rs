//! Infinitely many events in finite time, against geometric sums.

use featherbench_hybrid::systems::{BouncingBall, RockingBlock};
use featherbench_hybrid::{Cap, Run, Settings, Start, Status, Tail, Zeno, simulate};
use featherbench_spatial::{DoubleDouble, Dual, Real};

fn ball(height: f64, gravity: f64, restitution: f64, settings: &Settings) -> Run<f64> {
    let start = Start { mode: 0, time: 0.0, state: vec![height, 0.0, 0.0] };
    simulate(&BouncingBall, &[gravity, restitution], &start, 1e3, settings).unwrap()
}

fn tail<T: Real>(run: &Run<T>) -> &Tail<T> {
    match &run.status {
        Status::Zeno(tail) => tail,
        other => panic!("{other:?}"),
    }
}

/// The stated errors hold for the brief's numbers and 40 drawn ones, and the ball ends on the ground at rest.
#[test]
fn ball_comes_to_rest() {
    let mut random = featherbench_robots::Random::named(1, "ball");
    let mut cases = vec![(1.0, 9.81, 0.8)];
    cases.extend((0..40).map(|_| (random.uniform(0.05, 20.0), random.uniform(1.0, 25.0), random.uniform(0.2, 0.95))));
    for (height, gravity, e) in cases {
        let run = ball(height, gravity, e, &Settings::default());
        let tail = tail(&run);
        let time = BouncingBall::zeno_time(height, gravity, e);
        let path = tail.state[2].unwrap();
        let length = BouncingBall::path(height, e);
        assert!((tail.time.value - time).abs() <= tail.time.error && (path.value - length).abs() <= path.error, "{tail:?}");
        assert!((tail.ratio - e).abs() < 1e-8);
        // It ends on the ground at rest. The stated error grows as 64ε/(1 − e)², to 6·10⁻¹² times the speed.
        for rest in [tail.state[0].unwrap(), tail.state[1].unwrap()] {
            assert!(rest.value.abs() <= rest.error && rest.error < 1e-9, "{rest:?}");
        }
    }
}

/// The closed forms are sums: the terms of each from the speeds, in double-double.
#[test]
fn closed_forms_are_the_sums() {
    let [height, gravity, e] = [1.0, 9.81, 0.8].map(DoubleDouble::from_f64);
    let first = ((height + height) / gravity).sqrt();
    let (mut time, mut path, mut speed) = (first, height, gravity * first);
    for _ in 0..300 {
        speed *= e;
        time += (speed + speed) / gravity;
        path += speed * speed / gravity;
    }
    // 300 terms leave 0.8³⁰⁰ ≈ 10⁻²⁹ of the time.
    assert!((time - BouncingBall::zeno_time(height, gravity, e)).abs().to_f64() < 1e-26);
    assert!((path - BouncingBall::path(height, e)).abs().to_f64() < 1e-26);
    // And the numbers of SCIENCE.
    assert!((time.to_f64() - 4.063_712_768_872).abs() < 1e-12 && (path.to_f64() - 41.0 / 9.0).abs() < 1e-14);
}

/// Housner's block loses amplitude until its rocking is a Zeno tail whose ratio tends to r. Two settings that look at different parts of
/// the tail agree within the errors that they state.
#[test]
fn block_comes_to_rest() {
    let theta = [9.81, 0.25, 1.0];
    let start = Start { mode: 0, time: 0.0, state: vec![0.1, 0.0] };
    let run = |spread: f64| -> Run<f64> {
        let settings = Settings { zeno: Some(Zeno { spread, ..Zeno::default() }), ..Settings::default() };
        simulate(&RockingBlock, &theta, &start, 1e3, &settings).unwrap()
    };
    let (early, late) = (run(1e-5), run(1e-7));
    let (early, late) = (tail(&early), tail(&late));
    assert!(early.computed + 5 < late.computed, "{} {}", early.computed, late.computed);
    println!("t∞ {:?} {:?}", early.time, late.time);
    assert!((early.time.value - late.time.value).abs() <= early.time.error + late.time.error);
    // Events of one mode are every second impact: their ratio is r².
    let r = RockingBlock::ratio(theta[1], theta[2]);
    assert!((late.ratio - r * r).abs() < 1e-6, "{}", late.ratio);
}

/// Without the recognition a run of infinitely many events ends at a cap or as grazing, and says so.
#[test]
fn without_recognition_nothing_is_silent() {
    let settings = Settings { zeno: None, ..Settings::default() };
    let run = ball(1.0, 9.81, 0.8, &Settings { events: 20, ..settings });
    assert!(run.status == Status::Capped(Cap::Events) && run.events.len() == 20);
    let run = ball(1.0, 9.81, 0.8, &settings);
    assert!(matches!(run.status, Status::Grazing { rate, .. } if rate.abs() <= settings.grazing_rate), "{:?}", run.status);
    // An elastic ball has no tail.
    let start = Start { mode: 0, time: 0.0, state: vec![1.0, 0.0, 0.0] };
    let run = simulate(&BouncingBall, &[9.81, 1.0], &start, 10.0, &Settings::default()).unwrap();
    assert_eq!(run.status, Status::Finished);
}

/// The limit has derivatives: the same run with duals gives ∂t∞/∂h = t∞/(2h), ∂t∞/∂g = −t∞/(2g) and ∂t∞/∂e = 2t₁/(1 − e)².
#[test]
fn limits_have_derivatives() {
    let (height, gravity, e) = (1.3, 9.81, 0.6);
    let (first, time) = ((2.0 * height / gravity).sqrt(), BouncingBall::zeno_time(height, gravity, e));
    let known = [time / (2.0 * height), -time / (2.0 * gravity), 2.0 * first / (1.0_f64 - e).powi(2)];
    for (input, known) in known.iter().enumerate() {
        let of = |index: usize, value: f64| Dual::new(value, if index == input { 1.0 } else { 0.0 });
        let zero = Dual::constant(0.0);
        let start = Start { mode: 0, time: zero, state: vec![of(0, height), zero, zero] };
        let run = simulate(&BouncingBall, &[of(1, gravity), of(2, e)], &start, Dual::constant(100.0), &Settings::default()).unwrap();
        let found = tail(&run).time.value.derivative;
        // A ratio of intervals of 0.6⁶ s, each with the rounding of a second, and its derivative: 10⁻¹⁴/0.05 twice.
        assert!((found / known - 1.0).abs() < 1e-11, "{input}: {found} {known}");
    }
}

/// In double-double the same run gives t∞ to 10⁻²⁴, and states that.
#[test]
fn limits_in_double_double() {
    let [height, gravity, e] = [1.0, 9.81, 0.8].map(DoubleDouble::from_f64);
    let zero = DoubleDouble::zero();
    let start = Start { mode: 0, time: zero, state: vec![height, zero, zero] };
    let run = simulate(&BouncingBall, &[gravity, e], &start, DoubleDouble::from_f64(10.0), &Settings::extended()).unwrap();
    let tail = tail(&run);
    let error = (tail.time.value - BouncingBall::zeno_time(height, gravity, e)).abs().to_f64();
    assert!(error <= tail.time.error && tail.time.error < 1e-24, "{error:e} {:?}", tail.time);
}
