//! Estimators on samples whose parameters are known.

use crate::share::one_of;
use featherbench_identification::{
    Arm, Base, ConsistentSettings, Gravity, IdentificationError, Information, LinearModel, PseudoInertia, Samples, Scenario, Search,
    Stacking, Terms, disturbed, excite, fit, log_cholesky, ordinary, scatter, student, total, weighted, whiteness,
};
use featherbench_robots::{Family, Random};
use featherbench_spatial::{larger, smaller};
use nalgebra::DVector;

/// Nearly normal, mean 0, variance 1: a sum of twelve uniform numbers.
fn noise(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

/// A robot whose true parameters are not those of its description, with samples of an exciting motion.
fn arm(arm: &Arm, terms: Terms) -> (LinearModel, Vec<f64>, Samples) {
    let nominal = LinearModel::new(&arm.describe(Gravity::Parallel, 1), terms).unwrap();
    let mut other = arm.describe(Gravity::Parallel, 2);
    for (k, body) in other.bodies.iter_mut().enumerate() {
        (body.joint.armature, body.joint.damping, body.joint.friction) =
            (vec![0.1 + 0.02 * k as f64], vec![0.3 + 0.1 * k as f64], vec![0.5 + 0.05 * k as f64]);
    }
    let truth = LinearModel::new(&other, terms).unwrap().nominal();
    let base = Base::of_robot(&nominal, 1).unwrap();
    let search = Search { draws: 3, changes: 3, frequency: 0.2, ..Search::default() };
    let samples = excite(&nominal, &base, &search).unwrap().trajectory.samples(&nominal, &truth, 150, 1.0).unwrap();
    // What is not identified is known: the torques have the description's part of it.
    (nominal, truth, samples)
}

/// The largest error of base parameters over the largest of them.
fn error(found: &[f64], due: &[f64]) -> f64 {
    let largest = due.iter().fold(0.0, |most: f64, x| larger(most, x.abs()));
    found.iter().zip(due).fold(0.0, |most: f64, (a, b)| larger(most, (a - b).abs())) / largest
}

#[test]
fn without_noise_every_estimator_finds_the_base_parameters() {
    for (robot, terms) in [(Arm::puma560(), Terms::ALL), (Arm::panda(), Terms::NONE), (Arm::general(3, 4), Terms::ALL)] {
        let (linear, truth, samples) = arm(&robot, terms);
        let of =
            [("ordinary", ordinary(&linear, &samples)), ("weighted", weighted(&linear, &samples)), ("total", total(&linear, &samples))];
        for (method, estimate) in of.map(|(method, estimate)| (method, estimate.unwrap())) {
            let due = estimate.base.values(&truth);
            let found = error(&estimate.beta, &due);
            println!("{} {method}: {found:e}, condition {:.1e}", robot.name, estimate.base.condition());
            assert!(found < 1e-10, "{} {method}: {found:e}", robot.name);
            // θ̂ has these base parameters.
            assert!(error(&estimate.base.values(&estimate.theta), &estimate.beta) < 1e-12);
            assert!(estimate.fit.total < 1e-11, "{:?}", estimate.fit);
        }
    }
}

/// Intervals of 95 % hold the truth about that often, and weights help where one dof is loud.
#[test]
fn intervals_cover_the_truth_and_weights_narrow_them() {
    let (linear, truth, clean) = arm(&Arm::general(3, 4), Terms::ALL);
    let (mut covered, mut all, mut plain, mut with_weights) = (0, 0, 0.0, 0.0);
    for seed in 0..20 {
        let mut random = Random::new(seed, 8);
        let mut samples = clean.clone();
        samples.tau.iter_mut().enumerate().for_each(|(at, tau)| *tau += noise(&mut random) * if at % 3 == 0 { 2.0 } else { 0.05 });
        let estimate = weighted(&linear, &samples).unwrap();
        let due = estimate.base.values(&truth);
        for (i, (found, due)) in estimate.beta.iter().zip(&due).enumerate() {
            covered += usize::from((found - due).abs() <= estimate.half_width(i).unwrap());
            all += 1;
        }
        with_weights += error(&estimate.beta, &due);
        plain += error(&ordinary(&linear, &samples).unwrap().beta, &due);
    }
    let share = covered as f64 / all as f64;
    println!("{share} of {all} covered; errors {plain} plain, {with_weights} weighted");
    // 27 × 20 intervals, those of one draw not independent: ± 5 %.
    assert!((share - 0.95).abs() < 0.05, "{share}");
    assert!(with_weights < 0.8 * plain);
}

/// White noise is white, and a parameter that is left out is not.
#[test]
fn whiteness_tells_what_is_missing() {
    let (linear, truth, clean) = arm(&Arm::general(3, 4), Terms::ALL);
    let without = LinearModel::new(linear.description(), Terms::NONE).unwrap();
    let mut samples = clean;
    let mut random = Random::new(5, 8);
    samples.tau.iter_mut().for_each(|tau| *tau += 0.05 * noise(&mut random));
    let good = fit(&linear, &samples, &truth).unwrap();
    assert!(good.whiteness.iter().all(|white| white.unwrap().is_white()), "{:?}", good.whiteness);
    let poor = ordinary(&without, &samples).unwrap();
    assert!(poor.fit.whiteness.iter().all(|white| !white.unwrap().is_white()), "{:?}", poor.fit.whiteness);
    assert!(poor.fit.total > 3.0 * good.total);
    assert_eq!(whiteness(&[1.0; 200]), None);
    assert_eq!(whiteness(&[1.0, 2.0]), None);
}

/// Log-Cholesky: the torques of least squares, from bodies that can exist; with noise that ordinary least squares makes impossible ones of.
#[test]
fn consistent_estimates_are_consistent() {
    let (linear, truth, clean) = arm(&Arm::puma560(), Terms { viscous: true, coulomb: true, ..Terms::NONE });
    // Without noise the valley is followed far: a coarser end is enough for six digits.
    let coarse = ConsistentSettings { gain: 1e-3, ..ConsistentSettings::default() };
    let exact = log_cholesky(&linear, &clean, &Stacking::plain(&linear), coarse).unwrap();
    let base = ordinary(&linear, &clean).unwrap().base;
    let found = error(&base.values(&exact.theta), &base.values(&truth));
    println!("{found:e} after {} steps", exact.steps);
    assert!(found < 1e-6, "{found:e}");

    let mut samples = clean;
    let mut random = Random::new(5, 9);
    samples.tau.iter_mut().for_each(|tau| *tau += 0.5 * noise(&mut random));
    let plain = ordinary(&linear, &samples).unwrap();
    let consistent = log_cholesky(&linear, &samples, &Stacking::plain(&linear), ConsistentSettings::default()).unwrap();
    let smallest = |theta: &[f64]| {
        let bodies = theta.chunks_exact(10).take(6).map(|pi| PseudoInertia::of(pi.try_into().unwrap()).consistency());
        bodies.map(|body| body.smallest / body.largest).fold(f64::INFINITY, smaller)
    };
    println!("smallest eigenvalue {:e} plain, {:e} consistent", smallest(&plain.theta), smallest(&consistent.theta));
    assert!(smallest(&plain.theta) < -1e-3 && smallest(&consistent.theta) > 0.0);
    assert!(consistent.theta[60..].iter().all(|&friction| friction > 0.0));
    // The constraint costs little: the truth is a body.
    let total = fit(&linear, &samples, &consistent.theta).unwrap().total;
    assert!(total < 1.02 * plain.fit.total, "{total} {}", plain.fit.total);
    // Cramér and Rao: no worse than ordinary least squares by much on the base parameters.
    let due = plain.base.values(&truth);
    assert!(error(&plain.base.values(&consistent.theta), &due) < 2.0 * error(&plain.beta, &due));
}

/// Estimates spread as the theory says; five hundred draws, a variance known to 2 %.
#[test]
fn estimates_scatter_as_the_theory_says() {
    let scenario = Scenario::of(&Arm::general(2, 4), Terms { viscous: true, coulomb: true, ..Terms::NONE }, 40).unwrap();
    let found = scatter(&scenario, 0.2, 500, 1).unwrap();
    println!("{found:?}");
    assert!((found.variance - 1.0).abs() < 0.05, "{found:?}");
    assert!(found.extremes[0] > found.edges[0] - 0.1 && found.extremes[1] < found.edges[1] + 0.1, "{found:?}");
    assert!((found.coverage - 0.95).abs() < 0.02 && found.bias < 2.0, "{found:?}");
}

/// Another trajectory is predicted as well by bodies that can exist as by least squares: an iteration that ends too early predicts worse.
#[test]
fn consistent_estimates_predict_another_motion() {
    let scenario = Scenario::of(&Arm::puma560(), Terms { viscous: true, coulomb: true, ..Terms::NONE }, 150).unwrap();
    let (linear, deviation) = (&scenario.linear, 0.2);
    let other = disturbed(&scenario.held_out, deviation, 2);
    let size = |theta: &[f64]| {
        let rms = fit(linear, &other, theta).unwrap().rms;
        (rms.iter().map(|rms| rms * rms).sum::<f64>() / 6.0).sqrt() / deviation
    };
    let plain = weighted(linear, &scenario.noisy(deviation, 1)).unwrap();
    let stacking = Stacking { weights: plain.weights.as_deref(), ..Stacking::plain(linear) };
    let found = log_cholesky(linear, &scenario.noisy(deviation, 1), &stacking, ConsistentSettings::default()).unwrap();
    println!("{} plain, {} consistent after {} steps", size(&plain.theta), size(&found.theta), found.steps);
    assert!(size(&found.theta) < 1.15 && size(&plain.theta) < 1.15);
}

/// Whatever the arm, the unknowns and the noise: an answer is found, and the truth, which is a body, does not fit better.
#[test]
fn consistent_estimates_are_found_whatever_the_noise() {
    let (mut most, mut worst) = (0, 0.0);
    for draw in (0..200).step_by(one_of(25)) {
        let mut random = Random::named(draw, "noisy arm");
        let terms = Terms { viscous: random.unit() < 0.5, coulomb: random.unit() < 0.5, armature: random.unit() < 0.5, offset: false };
        let arm = Arm::general(2 + random.below(2), random.bits64() >> 1);
        let scenario = Scenario::of(&arm, terms, 60 + random.below(90)).unwrap();
        let (linear, noise) = (&scenario.linear, 10.0_f64.powf(random.uniform(-2.0, 0.0)));
        let samples = scenario.noisy(noise, random.bits64() >> 1);
        let stacking = Stacking::plain(linear);
        let found = log_cholesky(linear, &samples, &stacking, ConsistentSettings::default()).unwrap_or_else(|e| panic!("draw {draw}: {e}"));
        let information = Information::of(linear, &samples, &stacking).unwrap();
        let cost = |theta: &[f64]| (information.factor() * DVector::from_column_slice(theta) - information.right()).norm_squared();
        let ratio = cost(&found.theta) / cost(&scenario.truth);
        (most, worst) = (most.max(found.steps), larger(worst, ratio));
        assert!(ratio <= 1.0, "draw {draw}: {ratio} of the cost of the truth after {} steps", found.steps);
        assert!(found.steps < 2000, "draw {draw}: {} steps", found.steps);
    }
    println!("{most} steps at most, {worst} of the cost of the truth at most");
}

#[test]
fn too_few_samples_are_refused() {
    let linear = LinearModel::new(&Family::parse("chain:n=3").unwrap().generate().unwrap(), Terms::NONE).unwrap();
    let samples = Samples::random(&linear, 2, 1, &linear.nominal()).unwrap();
    // Six equations determine six combinations, exactly: there is no covariance.
    let estimate = ordinary(&linear, &samples).unwrap();
    assert_eq!((estimate.base.rank(), estimate.degrees), (6, 0));
    assert!(estimate.covariance.is_none());
    let mut still = samples.clone();
    still.tau[1] = f64::NAN;
    assert!(matches!(ordinary(&linear, &still), Err(IdentificationError::NotFinite { .. })));
    still.tau.pop();
    assert!(matches!(ordinary(&linear, &still), Err(IdentificationError::Length { array: "tau", .. })));
}

/// Student's 97.5 % points of the tables.
#[test]
fn student_is_that_of_the_tables() {
    for (degrees, due) in [(5, 2.5706), (10, 2.2281), (30, 2.0423), (120, 1.9799)] {
        assert!((student(degrees) - due).abs() < 5e-4, "{degrees}: {}", student(degrees));
    }
}
