//! Distributions: quantiles against distribution functions, moments and Gauss rules against integrals.

use featherbench_model::Distribution;
use featherbench_uncertainty::{Recurrence, Space, Variable, normal_cdf, normal_quantile};

fn every() -> Vec<Distribution> {
    vec![
        Distribution::Uniform { low: 0.8, high: 1.2 },
        Distribution::Lognormal { mean: 1.0, deviation: 0.3 },
        Distribution::Gamma { mean: 2.0, deviation: 0.2 },
        Distribution::Gamma { mean: 1.0, deviation: 0.9 },
        Distribution::Normal { mean: -0.3, deviation: 0.1 },
        Distribution::TruncatedNormal { mean: 1.0, deviation: 0.3, low: 0.5, high: 1.4 },
        Distribution::TruncatedNormal { mean: 0.0, deviation: 1.0, low: 1.0, high: 50.0 },
        Distribution::TruncatedNormal { mean: 2.0, deviation: 1.0, low: 1.999, high: 2.004 },
    ]
}

/// F(F⁻¹(p)) = p to a few units in the last place of p, or of 1 − p: the functions of `statrs` are good to 1e-14.
#[test]
fn quantiles_invert_distribution_functions() {
    for distribution in every() {
        let variable = Variable::new(distribution).unwrap();
        for p in [1e-9, 1e-4, 0.02, 0.3, 0.5, 0.8, 0.99, 1.0 - 1e-6] {
            let x = variable.quantile(p);
            assert!((variable.cdf(x) - p).abs() < 1e-12, "{distribution:?} {p} {x} {}", variable.cdf(x));
        }
        let [low, high] = variable.support();
        assert!(variable.cdf(low) <= 0.0 && variable.cdf(high.min(1e300)) >= 1.0 - 1e-12, "{distribution:?}");
    }
}

/// Mean and variance by ∫ x(u) du with 2 000 000 midpoints, whose error is that of the ends.
#[test]
fn moments_are_those_of_the_quantiles() {
    let count = 400_000;
    for distribution in every() {
        let variable = Variable::new(distribution).unwrap();
        let values: Vec<f64> = (0..count).map(|k| variable.quantile((k as f64 + 0.5) / count as f64)).collect();
        let mean = values.iter().sum::<f64>() / count as f64;
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count as f64;
        let scale = variable.variance().sqrt();
        assert!((mean - variable.mean()).abs() < 1e-4 * scale, "{distribution:?} {mean} {}", variable.mean());
        // Tails beyond 1/(2 count) are missing.
        assert!((variance / variable.variance() - 1.0).abs() < 1e-3, "{distribution:?} {variance} {}", variable.variance());
    }
}

/// The first two coefficients of the germ's polynomials give mean and variance of a linear germ; every rule integrates its polynomials.
#[test]
fn rules_are_exact_for_polynomials() {
    for distribution in every() {
        let variable = Variable::new(distribution).unwrap();
        let polynomials = variable.polynomials();
        let rule = polynomials.rule(6);
        assert!((rule.weights.iter().sum::<f64>() - 1.0).abs() < 1e-13);
        for i in 0..=5 {
            for j in 0..=5 {
                let product: f64 = rule
                    .nodes
                    .iter()
                    .zip(&rule.weights)
                    .map(|(t, w)| {
                        let values = polynomials.orthonormal(5, *t);
                        w * values[i] * values[j]
                    })
                    .sum();
                let due = f64::from(u8::from(i == j));
                assert!((product - due).abs() < 1e-9, "{distribution:?} {i} {j} {product}");
            }
        }
        let mean: f64 = polynomials.rule(30).nodes.iter().zip(polynomials.rule(30).weights).map(|(t, w)| w * variable.of_germ(*t)).sum();
        assert!((mean - variable.mean()).abs() < 1e-10 * (1.0 + mean.abs()), "{distribution:?} {mean}");
    }
}

/// The three-point rules by hand: ±√(3/5) with 5/18 and 8/18; ±√3 with 1/6 and 2/3.
#[test]
fn small_rules_are_the_known_ones() {
    let close = |a: &[f64], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14);
    let legendre = Recurrence::legendre(3).rule(3);
    assert!(
        close(&legendre.nodes, [-0.6_f64.sqrt(), 0.0, 0.6_f64.sqrt()]) && close(&legendre.weights, [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0])
    );
    let hermite = Recurrence::hermite(3).rule(3);
    assert!(close(&hermite.nodes, [-3.0_f64.sqrt(), 0.0, 3.0_f64.sqrt()]) && close(&hermite.weights, [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0]));
    // ∫ t^k t² e^(−t)/2 dt = (k + 2)!/2.
    let laguerre = Recurrence::laguerre(4, 3.0).rule(4);
    for (k, due) in [1.0, 3.0, 12.0, 60.0, 360.0, 2520.0].into_iter().enumerate() {
        let sum: f64 = laguerre.nodes.iter().zip(&laguerre.weights).map(|(t, w)| w * t.powi(k as i32)).sum();
        assert!((sum / due - 1.0).abs() < 1e-12, "{k} {sum}");
    }
}

#[test]
fn normal_functions_are_inverse() {
    assert_eq!(normal_cdf(0.0), 0.5);
    for z in [-6.0, -1.0, -0.1, 0.3, 2.0] {
        assert!((normal_quantile(normal_cdf(z)) - z).abs() < 1e-13 * (1.0 + z * z), "{z}");
    }
}

/// Correlated lognormal variables: cov = m₁ m₂ (e^(ρ s₁ s₂) − 1), in closed form.
#[test]
fn covariances_of_a_copula_are_exact() {
    use featherbench_model::{Acts, Correlation, Target, TargetField, Uncertain, UncertainVariable};
    let of = |name: &str, mean: f64, deviation: f64| UncertainVariable {
        name: name.into(),
        distribution: Distribution::Lognormal { mean, deviation },
        acts: Acts::Value,
        on: vec![Target { body: 0, field: TargetField::Mass }],
    };
    let variables = vec![of("a", 1.0, 0.2), of("b", 3.0, 0.9)];
    let uncertain = Uncertain { variables, correlations: vec![Correlation { first: 0, second: 1, value: -0.6 }] };
    let space = Space::of(&uncertain).unwrap();
    let scale = |cv: f64| (cv * cv).ln_1p().sqrt();
    let due = 3.0 * (-0.6 * scale(0.2) * scale(0.3)).exp_m1();
    assert!((space.covariance()[(0, 1)] - due).abs() < 1e-12, "{} {due}", space.covariance()[(0, 1)]);
}
