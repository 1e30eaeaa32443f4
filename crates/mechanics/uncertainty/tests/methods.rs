//! Methods on functions with known moments.

use crate::share::one_of;
use featherbench_model::Distribution;
use featherbench_robots::Random;
use featherbench_uncertainty::{
    Closure, Error, Histogram, Linear, Points, Sampling, Space, chaos, draw, first_order, mixture, sample, sensitivity, unscented,
};
use nalgebra::{DMatrix, DVector};

/// A function of a sample that writes its answer.
type Function = fn(&[f64], &mut [f64]);

fn reciprocal() -> Closure<Function> {
    Closure::new(1, 1, |x, y| y[0] = 1.0 / x[0])
}

fn uniform() -> Space {
    Space::independent(&[Distribution::Uniform { low: 0.8, high: 1.2 }]).unwrap()
}

fn exact() -> (f64, f64) {
    let mean = (1.2_f64 / 0.8).ln() / 0.4;
    (mean, 1.0 / 0.96 - mean * mean)
}

/// Gauss–Legendre: the error of the variance falls by the square of ρ = (1 − √(1 − δ²))/δ per point. It falls to the rounding of a
/// deviation of 0.1 that is the sum of products near one (some 1e-15 each, and it is squared).
#[test]
fn chaos_converges_exponentially() {
    let (mean, variance) = exact();
    let errors: Vec<f64> = [2, 3, 5, 8].map(|order| chaos(&uniform(), &reciprocal(), order).unwrap().variance(0) / variance - 1.0).into();
    assert!(errors[0].abs() < 1e-3 && errors[1].abs() < 2e-5 && errors[2].abs() < 5e-9 && errors[3].abs() < 3e-13, "{errors:?}");
    assert!((chaos(&uniform(), &reciprocal(), 12).unwrap().mean(0) - mean).abs() < 1e-15);
}

/// Two thirds and a sixth at ±√3 σ.
#[test]
fn the_unscented_transform_is_that_of_three_points() {
    let found = unscented(&uniform(), &reciprocal(), 2.0).unwrap();
    let mean: f64 = 2.0 / 3.0 + (1.0 / 0.8 + 1.0 / 1.2) / 6.0;
    let variance = 2.0 / 3.0 * (1.0 - mean).powi(2) + ((1.0 / 0.8 - mean).powi(2) + (1.0 / 1.2 - mean).powi(2)) / 6.0;
    assert!((found.mean[0] - mean).abs() < 1e-15 && (found.covariance[(0, 0)] - variance).abs() < 1e-15);
    let wide = Space::independent(&[Distribution::Lognormal { mean: 1.0, deviation: 0.7 }]).unwrap();
    assert!(matches!(unscented(&wide, &reciprocal(), 2.0), Err(Error::OutsideSupport { variable: 0, .. })));
}

#[test]
fn samples_agree_with_the_closed_form() {
    let (mean, variance) = exact();
    let linear = Linear { at: vec![1.0], value: DVector::from_vec(vec![1.0]), jacobian: DMatrix::from_vec(1, 1, vec![-1.0]) };
    for points in [Points::Random, Points::Sobol] {
        let settings = Sampling { points, samples: 1 << 16, ..Sampling::default() };
        let found = sample(&uniform(), &reciprocal(), Some(&linear), &settings, &|_| ()).unwrap();
        let output = &found.outputs[0];
        let controlled = output.controlled.unwrap();
        assert!((output.mean.value - mean).abs() < 4.0 * output.mean.error);
        assert!((output.variance.value - variance).abs() < 4.0 * output.variance.error);
        assert!((controlled.value - mean).abs() < 4.0 * controlled.error, "{controlled:?} {mean}");
        // The linear part leaves what is quadratic: a twentieth of the deviation and less.
        assert!(output.reduction.unwrap() > 50.0 && controlled.error < output.mean.error, "{:?}", output.reduction);
        // The median of 1/m is 1; a bin is a thousandth of the range.
        assert!((output.histogram.quantile(0.5).unwrap() - 1.0).abs() < 3e-3);
        assert_eq!(output.histogram.total(), found.samples);
        let spread = first_order(&uniform(), &linear).unwrap().covariance[(0, 0)];
        assert!((spread - 0.16 / 12.0).abs() < 1e-15);
    }
}

/// The same bits by one thread, two and five; blocks that are not full, registers that are not full.
#[test]
fn threads_do_not_change_a_bit() {
    let space =
        Space::independent(&[Distribution::Gamma { mean: 1.0, deviation: 0.2 }, Distribution::Uniform { low: -1.0, high: 2.0 }]).unwrap();
    let response = Closure::new(2, 2, |x: &[f64], y: &mut [f64]| (y[0], y[1]) = (x[1].sin() / x[0], x[0] * x[1]));
    for points in [Points::Random, Points::Sobol] {
        let run = |threads| {
            let settings = Sampling { points, samples: 50_013, threads: Some(threads), replicates: 3, ..Sampling::default() };
            sample(&space, &response, None, &settings, &|_| ()).unwrap()
        };
        let one = run(1);
        assert_eq!(one, run(2));
        assert_eq!(one, run(5));
        let settings = |threads| Sampling { points, samples: 9_000, threads: Some(threads), ..Sampling::default() };
        assert_eq!(sensitivity(&space, &response, &settings(1)).unwrap(), sensitivity(&space, &response, &settings(2)).unwrap());
    }
}

/// Ishigami's function sin x₁ + a sin² x₂ + b x₃⁴ sin x₁, whose indices are known.
#[test]
fn sobol_indices_are_those_of_ishigami() {
    let (a, b) = (7.0, 0.1);
    let pi = std::f64::consts::PI;
    let space = Space::independent(&[Distribution::Uniform { low: -pi, high: pi }; 3]).unwrap();
    let response =
        Closure::new(3, 1, move |x: &[f64], y: &mut [f64]| y[0] = x[0].sin() + a * x[1].sin().powi(2) + b * x[2].powi(4) * x[0].sin());
    let first = 0.5 * (1.0 + b * pi.powi(4) / 5.0).powi(2);
    let second = a * a / 8.0;
    let pair = b * b * pi.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
    let total = first + second + pair;
    let due = [[first / total, (first + pair) / total], [second / total; 2], [0.0, pair / total]];
    let settings = Sampling { points: Points::Sobol, samples: 1 << 15, ..Sampling::default() };
    let found = &sensitivity(&space, &response, &settings).unwrap()[0];
    for (i, [s, t]) in due.into_iter().enumerate() {
        assert!((found.first[i].value - s).abs() < 4.0 * found.first[i].error + 1e-12, "{i} {:?} {s}", found.first[i]);
        assert!((found.total[i].value - t).abs() < 4.0 * found.total[i].error + 1e-12, "{i} {:?} {t}", found.total[i]);
    }
    // And by the series, to what order 14 leaves.
    let series = chaos(&space, &response, 14).unwrap();
    for (found, due) in series.sobol_indices(0).unwrap().into_iter().zip(due) {
        assert!((found[0] - due[0]).abs() < 1e-4 && (found[1] - due[1]).abs() < 1e-4, "{found:?} {due:?}");
    }
    assert!((series.variance(0) / total - 1.0).abs() < 1e-4);
}

#[test]
fn mixtures_have_weights_and_moments() {
    let space = Space::independent(&[Distribution::Uniform { low: 0.0, high: 1.0 }]).unwrap();
    let settings = Sampling { samples: 40_000, ..Sampling::default() };
    let found = mixture(&space, &settings, |x| Some((u64::from(x[0] > 0.75), if x[0] > 0.75 { 5.0 } else { x[0] }))).unwrap();
    assert_eq!(found.modes.len(), 2);
    assert!((found.modes[1].weight.value - 0.25).abs() < 4.0 * found.modes[1].weight.error);
    assert!((found.modes[0].moments.mean - 0.375).abs() < 4.0 * found.modes[0].moments.mean_error());
    assert_eq!(found.modes[1].moments.variance(), 0.0);
    let mean = 0.75 * 0.375 + 0.25 * 5.0;
    assert!((found.all.mean - mean).abs() < 4.0 * found.all.mean_error());
    assert!(matches!(mixture(&space, &settings, |x| (x[0] < 0.9).then_some((0, 1.0))), Err(Error::NotFinite { .. })));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let normal = Space::independent(&[Distribution::Normal { mean: 0.0, deviation: 1.0 }]).unwrap();
    let broken = Closure::new(1, 1, |x: &[f64], y: &mut [f64]| y[0] = x[0].sqrt());
    assert!(matches!(sample(&normal, &broken, None, &Sampling::default(), &|_| ()), Err(Error::NotFinite { replicate: 0, sample: 0..10 })));
    assert!(matches!(chaos(&normal, &broken, 3), Err(Error::NotFinitePoint { .. })));
    let setting = |settings: Sampling| sample(&uniform(), &reciprocal(), None, &settings, &|_| ()).unwrap_err().to_string();
    assert!(setting(Sampling { replicates: 1, ..Sampling::default() }).starts_with("replicates is 1"));
    assert!(setting(Sampling { samples: 3, ..Sampling::default() }).starts_with("samples is 3"));
    assert!(setting(Sampling { threads: Some(0), ..Sampling::default() }).starts_with("threads is 0"));
    let many = Space::independent(&[Distribution::Uniform { low: 0.0, high: 1.0 }; 30]).unwrap();
    let sum = Closure::new(30, 1, |x: &[f64], y: &mut [f64]| y[0] = x.iter().sum());
    assert!(matches!(chaos(&many, &sum, 2), Err(Error::TooManyNodes { variables: 30, .. })));
    assert!(sample(&many, &reciprocal(), None, &Sampling::default(), &|_| ()).unwrap_err().to_string().contains("expected 30, found 1"));
    assert_eq!(Space::independent(&[]).unwrap_err(), Error::NoVariables);
    assert!(Space::independent(&[Distribution::Uniform { low: 1.0, high: f64::NAN }]).unwrap_err().to_string().contains("high is NaN"));
    assert!(Space::independent(&[Distribution::TruncatedNormal { mean: 0.0, deviation: 1.0, low: 9.0, high: 10.0 }]).is_err());
}

/// The reason that is given for a refused order is the true one, and the order that is advised is the highest that works.
#[test]
fn refused_orders_are_refused_for_their_reason() {
    let mut random = Random::named(1, "orders");
    for _ in 0..200 / one_of(4) {
        let variables = 1 + random.below(40);
        let order = 1 + random.below(if variables < 3 { 80 } else { 12 });
        let space = Space::independent(&vec![Distribution::Uniform { low: 0.9, high: 1.1 }; variables]).unwrap();
        let sum = Closure::new(variables, 1, |x: &[f64], y: &mut [f64]| y[0] = x.iter().sum());
        let nodes = |order: usize| ((order + 1) as f64).powi(variables as i32);
        match chaos(&space, &sum, order) {
            Ok(found) => assert!(found.nodes as f64 == nodes(order) && order <= 38, "{order} {variables}"),
            Err(Error::OrderTooHigh { limit, highest, .. }) => {
                assert!(order > limit && limit == 38 && highest <= limit && nodes(highest) <= 262_144.0, "{order} {variables}");
                assert!(variables > 1 || chaos(&space, &sum, highest).is_ok());
            }
            Err(Error::TooManyNodes { points, limit, highest, .. }) => {
                assert!(points == order + 1 && nodes(order) > limit as f64, "{order} {variables}");
                assert!(nodes(highest) <= limit as f64 && nodes(highest + 1) > limit as f64, "{order} {variables}");
            }
            Err(other) => panic!("{other}"),
        }
    }
    let text = chaos(&uniform(), &reciprocal(), 40).unwrap_err().to_string();
    assert!(text.contains("order 40 is above 38"), "{text}");
}

#[test]
fn drawn_answers_are_those_of_the_first_replicate() {
    let drawn = draw(&uniform(), &reciprocal(), Points::Random, 5000, 9).unwrap();
    assert_eq!((drawn.len(), drawn[0].len()), (1, 5000));
    assert!(drawn[0].iter().all(|y| (1.0 / 1.2..=1.0 / 0.8).contains(y)));
}

/// An answer that no parameter changes has its value as every quantile, whatever the bins.
#[test]
fn quantiles_of_a_constant_are_the_constant() {
    for value in [0.0, -7.25, 1e300] {
        let mut histogram = Histogram::new(value, value);
        histogram.count(&[value; 10]);
        let found = [0.01, 0.5, 0.99].map(|p| histogram.quantile(p));
        assert_eq!(found, [Some(value); 3]);
    }
}
