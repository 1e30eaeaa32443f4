//! The known answers, each by a second route.

use crate::wide::wide;
use featherbench_continua::known::{
    bessel_zero, cantilever_root, elastica, exact_modes_tip_ratio, hermite_frequency_prefactor, laguerre_zeros,
    sections_frequency_prefactor,
};
use featherbench_continua::{Basis, quadrature};
use featherbench_dynamics::Error;
use featherbench_dynamics::integrate::{DormandPrince, Tolerance};
use featherbench_model::{Axis, JointKind, Topology};
use featherbench_spatial::Real;

/// The elastica by shooting: θ'' = −α cos θ from (0, κ) along the rod, with the tip's moment zero by the secant rule. x and y are
/// integrated too, as x'' = −sin θ θ' and y'' = cos θ θ'.
fn shot(alpha: f64) -> [f64; 2] {
    let slides = Topology::new(&[None, Some(0), Some(1)].map(|parent| (parent, JointKind::Prismatic(Axis::Z)))).unwrap();
    let mut rod = |_: f64, q: &[f64], v: &[f64], a: &mut [f64]| -> Result<(), Error> {
        let (sin, cos) = q[0].sin_cos();
        a.copy_from_slice(&[-alpha * cos, -sin * v[0], cos * v[0]]);
        Ok(())
    };
    let tolerance = Tolerance { absolute: 1e-13, relative: 1e-13, ..Tolerance::default() };
    let mut end = |curvature: f64| {
        let (mut q, mut v) = ([0.0; 3], [curvature, 1.0, 0.0]);
        DormandPrince::new(&slides).run(&mut rod, [0.0, 1.0], &mut q, &mut v, &tolerance, |_, _, _| ()).unwrap();
        (v[0], [q[1], q[2]])
    };
    // The curvature at the clamp is α times the reach, at most α and at most √(2α) by the first integral.
    let (mut low, mut high) = (0.0, alpha.min((2.0 * alpha).sqrt()) * 1.0001);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if end(middle).0 < 0.0 { low = middle } else { high = middle }
    }
    end(0.5 * (low + high)).1
}

#[test]
fn elastica_by_quadrature_is_that_by_shooting() {
    for alpha in [0.1, 1.0, 2.0, 5.0, 10.0] {
        let (table, [reach, deflection]) = (elastica(alpha), shot(alpha));
        // The integrator's tolerance of 1e-13 per step, over some hundred steps.
        assert!((table.deflection - deflection).abs() < 1e-11, "{alpha}: {} {deflection}", table.deflection);
        assert!((table.reach - reach).abs() < 1e-11, "{alpha}: {} {reach}", table.reach);
    }
    for (alpha, printed) in [(0.1, 0.033295319268174), (1.0, 0.30172077379981), (2.0, 0.49345748039671), (5.0, 0.71379152361191)] {
        assert!((elastica(alpha).deflection - printed).abs() < 1e-13);
    }
    assert!((elastica(10.0).reach - 0.44500440224625).abs() < 1e-13);
    assert!(elastica(-1.0).deflection.is_nan() && elastica(f64::NAN).reach.is_nan());
}

#[test]
fn cantilever_roots_solve_their_equation_in_double_double() {
    for k in 0..12 {
        let beta = cantilever_root(k);
        // cos β + 2 e/(1 + e²), e = e^{−β} = (e^{−β/64})^64 by its series.
        let small = wide(-beta / 64.0);
        let mut e = (1..30).rev().fold(wide(1.0), |sum, i| wide(1.0) + small * sum / wide(f64::from(i)));
        (0..6).for_each(|_| e = e * e);
        let (sin, cos) = wide(beta).sin_cos();
        let value = cos + e * wide(2.0) / (wide(1.0) + e * e);
        // A root is right to an ulp if the value is at most the slope times an ulp.
        assert!(value.to_f64().abs() <= 1.01 * (sin.to_f64().abs() + 0.31) * beta * f64::EPSILON, "{k}");
    }
    for (k, printed) in [1.87510406871196, 4.69409113297417, 7.85475743823761, 10.9955407348755].into_iter().enumerate() {
        assert!((cantilever_root(k) - printed).abs() < 1e-13);
    }
}

#[test]
fn bessel_zeros_are_those_of_the_integral() {
    for k in 0..10 {
        // J₀(x) = 1/π ∫ cos(x sin t) dt over [0, π]: the trapezoidal rule converges faster than any power for a periodic function.
        let j0 = |x: f64| (0..200).map(|i| (x * (std::f64::consts::PI * f64::from(i) / 200.0).sin()).cos()).sum::<f64>() / 200.0;
        let x = bessel_zero(k);
        // The slope there is −J₁, of magnitude √(2/πx): the sum of 200 terms has roundings of 1e-15.
        assert!(j0(x).abs() < 3e-15, "{k}: {}", j0(x));
        assert!(j0(x - 1e-12) * j0(x + 1e-12) < 0.0, "{k}");
    }
    for (k, printed) in [1.20241277885, 2.76003905514, 4.32686395646].into_iter().enumerate() {
        assert!((bessel_zero(k) / 2.0 - printed).abs() < 1e-11);
    }
}

#[test]
fn laguerre_zeros_are_those_of_the_sum() {
    for n in [1, 2, 3, 5, 10, 20] {
        let zeros = laguerre_zeros(n);
        // L_n(x) = Σ C(n, k) (−x)^k/k!: its sign changes within an ulp or two of each zero.
        let value = |x: f64| {
            let (mut term, mut sum) = (wide(1.0), wide(1.0));
            for k in 0..n {
                let next = (k + 1) as f64;
                term = term * wide(-x) * wide((n - k) as f64) / wide(next * next);
                sum += term;
            }
            sum.to_f64()
        };
        for x in &zeros {
            assert!(value(x * (1.0 - 2.0 * f64::EPSILON)) * value(x * (1.0 + 2.0 * f64::EPSILON)) < 0.0, "{n} {x}");
        }
        // Σ x = n²
        assert!((zeros.iter().sum::<f64>() / (n * n) as f64 - 1.0).abs() < 1e-14);
        assert_eq!(zeros.len(), n);
    }
}

#[test]
fn modes_are_orthonormal_and_their_integrals_are_those_of_the_laws() {
    let rule = quadrature::composite(24, 10);
    let integral = |f: &dyn Fn(f64) -> f64| rule.iter().map(|(x, w)| w * f(*x)).sum::<f64>();
    let basis = Basis::Modes(5);
    for i in 0..5 {
        let beta = cantilever_root(i);
        for j in 0..=i {
            let product = integral(&|x| basis.at(true, i, x).value * basis.at(true, j, x).value);
            assert!((product - f64::from(i == j)).abs() < 1e-13, "{i} {j} {product}");
        }
        assert!((basis.at(true, i, 1.0).value.abs() - 2.0).abs() < 1e-14 * beta);
        assert!((basis.at(true, i, 1.0).curvature / beta.powi(2)).abs() < 1e-13);
        let slopes = integral(&|x| basis.at(true, i, x).slope.powi(2));
        assert!((sections_frequency_prefactor(i) * 24.0 / slopes - 1.0).abs() < 1e-12);
        assert!((hermite_frequency_prefactor(i) * 1440.0 / beta.powi(4) - 1.0).abs() < 1e-14);
    }
    for (r, printed) in [(1, 0.970688), (2, 0.995404), (3, 0.998556), (4, 0.999377)] {
        assert!((exact_modes_tip_ratio(r) - printed).abs() < 1e-6);
    }
    // δ/δ_exact = 3 Σ φ(1)²/β⁴ with all modes is 1: the rest after r of them is 12 Σ 1/β⁴ with β ≈ (k + ½) π.
    let rest: f64 = (40..4000).map(|k| 12.0 / ((f64::from(k) + 0.5) * std::f64::consts::PI).powi(4)).sum();
    assert!((exact_modes_tip_ratio(40) + rest - 1.0).abs() < 1e-10);
}

#[test]
fn gauss_points_integrate_polynomials_of_degree_2n_minus_1() {
    for n in 1..=20 {
        for degree in 0..2 * n {
            let sum: f64 = quadrature::gauss(n).iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
            assert!((sum * (degree + 1) as f64 - 1.0).abs() < 1e-13, "{n} {degree}");
        }
        let beyond: f64 = quadrature::gauss(n).iter().map(|(x, w)| w * x.powi(2 * n as i32)).sum();
        assert!(n > 8 || beyond * (2 * n + 1) as f64 - 1.0 < -1e-12, "{n}");
    }
}
