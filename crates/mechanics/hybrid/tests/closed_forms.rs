//! Closed forms of `systems` by a second route. That runs have their event times is asked by the study `contact`.

use featherbench_hybrid::systems::{RimlessWheel, RockingBlock, SlidingSphere, carlson, incomplete};
use featherbench_hybrid::{Hybrid, Run, Settings, Start, sensitivity, simulate};
use featherbench_spatial::{DoubleDouble, Real};

fn go<S: Hybrid>(system: &S, theta: &[f64], mode: usize, state: &[f64], to: f64) -> Run<f64> {
    let start = Start { mode, time: 0.0, state: state.to_vec() };
    simulate(system, theta, &start, to, &Settings::default()).unwrap()
}

/// The angular momentum about the point of contact is kept while it slides: m ρ v + (2/5) m ρ² ω, a second route to 5v₀/7.
#[test]
fn sphere_keeps_its_momentum() {
    let run = go(&SlidingSphere, &[0.3, 9.81, 0.1], 0, &[0.0, 5.0, 0.0], 0.9);
    let momentum = |x: &[f64]| x[1] + 0.4 * 0.1 * x[2];
    assert!((momentum(&run.events[0].before) - 5.0).abs() < 1e-14 && (momentum(&run.state) - 5.0).abs() < 1e-14);
}

/// The limit cycle: after one step the state is the same, and a small deviation is multiplied by cos² 2α.
#[test]
fn wheel_has_a_limit_cycle() {
    let mut random = featherbench_robots::Random::named(3, "wheel");
    let mut multipliers = 0;
    for _ in 0..20 {
        let alpha = random.uniform(0.15, 0.5);
        let theta = [random.uniform(3.0, 30.0), random.uniform(0.6, 1.0) * alpha, alpha];
        let rate = RimlessWheel::limit_cycle(&theta);
        let start = vec![theta[1] - alpha, rate];
        // The top is passed only with ω₊² > 2(g/l)(1 − cos(γ − α)).
        if rate * rate <= 2.1 * theta[0] * (1.0 - (theta[1] - alpha).cos()) {
            continue;
        }
        let run = go(&RimlessWheel, &theta, 0, &start, 3.0);
        assert!(run.events.len() >= 2, "{theta:?}");
        for event in &run.events {
            assert!((event.after[1] / rate - 1.0).abs() <= 1e-12, "{} {rate}", event.after[1]);
        }
        // To the first impact: ∂(ω₊)/∂ω₀ along the return map is what saltation and flow give on the section.
        let until = run.events[0].time;
        let one = go(&RimlessWheel, &theta, 0, &start, until + 1e-9);
        let derivative = sensitivity(&RimlessWheel, &theta, &one).unwrap();
        // Over a period the derivative has the eigenvalues 1 (along the flow) and cos² 2α: its determinant is the product, up to 1 ns.
        let columns = &derivative.columns;
        let determinant = columns[0][0] * columns[1][1] - columns[0][1] * columns[1][0];
        let trace = columns[0][0] + columns[1][1];
        let multiplier = RimlessWheel::multiplier(&theta);
        assert!((determinant - multiplier).abs() < 1e-7 && (trace - 1.0 - multiplier).abs() < 1e-7, "{determinant} {trace} {multiplier}");
        multipliers += 1;
    }
    assert!(multipliers >= 10, "{multipliers}");
}

/// r by angular momentum in numbers, and the quarter periods by what SCIENCE has.
#[test]
fn block_rocks() {
    for (width, height, ratio) in [(0.25_f64, 1.0_f64, 31.0 / 34.0_f64), (0.2, 1.0, 49.0 / 52.0)] {
        assert!((RockingBlock::ratio(width, height) - ratio).abs() < 1e-15);
        let momenta = momentum_about_new_edge(width, height);
        assert!((RockingBlock::ratio(width, height) - momenta).abs() < 1e-15, "{momenta}");
    }
    let alpha = 0.25_f64.atan();
    let (linear, exact) = (RockingBlock::linear_quarter(alpha, 0.5 * alpha).unwrap(), RockingBlock::quarter(alpha, 0.5 * alpha).unwrap());
    // The linear one is arccosh 2 = ln(2 + √3).
    assert!((linear - (2.0 + 3.0_f64.sqrt()).ln()).abs() < 1e-15 && (exact - 1.319_279_499_56).abs() < 1e-11, "{exact}");
    // A slender block is linear: the difference falls like α².
    let difference = |alpha: f64| RockingBlock::quarter(alpha, 0.5 * alpha).unwrap() - linear;
    assert!((difference(0.02) / difference(0.01) - 4.0).abs() < 0.01);
}

/// The moments of impulse of a block as four corner masses and a centre, with the same mass and inertia: a sum over points, not a formula.
fn momentum_about_new_edge(width: f64, height: f64) -> f64 {
    // Masses at the corners 1/12 each and 2/3 at the centre: the inertia (b² + h²)/3 of a rectangle.
    let points = [(-1.0, 0.0, 1.0), (1.0, 0.0, 1.0), (-1.0, 2.0, 1.0), (1.0, 2.0, 1.0), (0.0, 1.0, 8.0)];
    let about = |turn: f64, edge: f64| -> f64 {
        let of = |(x, y, weight): &(f64, f64, f64)| {
            let (x, y) = (x * width, y * height);
            // The velocity of a unit rate about (turn, 0), and its moment about (edge, 0).
            let (vx, vy) = (-y, x - turn);
            weight * ((x - edge) * vy - y * vx)
        };
        points.iter().map(of).sum()
    };
    about(width, -width) / about(-width, -width)
}

/// R_F by a second route: the integral over θ by the trapezoidal rule, which converges geometrically for a periodic integrand; and Gauss'
/// mean.
#[test]
fn elliptic_integrals() {
    for modulus in [0.1, 0.7, 0.95] {
        let complete = carlson(0.0, 1.0 - modulus * modulus, 1.0).unwrap();
        let (mut a, mut b) = (1.0_f64, (1.0 - modulus * modulus).sqrt());
        for _ in 0..8 {
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
        }
        assert!((complete / (std::f64::consts::FRAC_PI_2 / a) - 1.0).abs() < 1e-15);
        // F by Simpson's rule in 20000 parts: its error is below (φ/20000)⁴ times a fourth derivative of at most 10⁵.
        let angle = 1.2_f64;
        let integrand = |t: f64| 1.0 / (1.0 - (modulus * t.sin()).powi(2)).sqrt();
        let parts = 20_000;
        let h = angle / f64::from(parts);
        let weight = |k: i32| if k == 0 || k == parts { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
        let simpson: f64 = (0..=parts).map(|k| weight(k) * integrand(f64::from(k) * h)).sum::<f64>() * h / 3.0;
        assert!((incomplete(angle.sin(), modulus).unwrap() / simpson - 1.0).abs() < 1e-12);
    }
    assert!(carlson(-1.0, 1.0, 1.0).unwrap_err().to_string().contains("'x'"));
    assert!(carlson(0.0, 0.0, 1.0).unwrap_err().to_string().contains("infinite"));
    assert!(incomplete(1.5, 0.5).is_err() && incomplete(0.5, 1.0).is_err() && incomplete(f64::NAN, 0.5).is_err());
    assert!(RockingBlock::quarter(0.2, 0.3).is_err() && RockingBlock::linear_quarter(2.0, 0.1).is_err());
}

/// The same text in double-double: the order of the integrator and the location of events hold to 10⁻²⁵.
#[test]
fn double_double_goes_further() {
    let theta = [9.81, 0.2, 0.3].map(DoubleDouble::from_f64);
    let rate = RimlessWheel::limit_cycle(&theta);
    let start = Start { mode: 0, time: DoubleDouble::zero(), state: vec![theta[1] - theta[2], rate] };
    let run = simulate(&RimlessWheel, &theta, &start, DoubleDouble::from_f64(2.0), &Settings::extended()).unwrap();
    assert!(run.events.len() >= 2);
    for event in &run.events {
        let error = (event.after[1] - rate).abs().to_f64();
        println!("{error:e}");
        // The rounding of inputs, 10⁻³², grows little in two steps; 10⁻²⁷ per step of the tolerance.
        assert!(error < 1e-25, "{error:e}");
    }
}
