//! v̇ = u/m with u = 1 N: the moments of 1/m, by closed forms, by a second route, and by every method.

use super::{Case, count, error, failed, told};
use featherbench_bench::NoAnswer;
use featherbench_model::{Acts, Distribution, Target, TargetField, UncertainVariable};
use featherbench_robots::Family;
use featherbench_spatial::{DoubleDouble, Dual, Real};
use featherbench_uncertainty::{Closure, Linear, Points, Sampling, Space, chaos, draw, first_order, sample, unscented};
use nalgebra::{DMatrix, DVector};
use serde_json::json;

/// The half width of the uniform mass, of its mean.
const SPREAD: f64 = 0.2;
/// Samples of a case.
const SAMPLES: u64 = 1 << 17;

/// A distribution of the mass with mean one and variance δ²/3.
#[derive(Clone, Copy, PartialEq)]
enum Mass {
    Uniform,
    Lognormal,
    Gamma,
}

impl Mass {
    const ALL: [Self; 3] = [Self::Uniform, Self::Lognormal, Self::Gamma];

    fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Lognormal => "lognormal",
            Self::Gamma => "gamma",
        }
    }

    fn distribution(self) -> Distribution {
        let deviation = SPREAD / 3.0_f64.sqrt();
        match self {
            Self::Uniform => Distribution::Uniform { low: 1.0 - SPREAD, high: 1.0 + SPREAD },
            Self::Lognormal => Distribution::Lognormal { mean: 1.0, deviation },
            Self::Gamma => Distribution::Gamma { mean: 1.0, deviation },
        }
    }

    fn space(self) -> Result<Space, NoAnswer> {
        Space::independent(&[self.distribution()]).map_err(failed)
    }

    /// Mean and variance of 1/m in closed form.
    ///
    /// - uniform: E = ln((1 + δ)/(1 − δ))/2δ, E 1/m² = 1/(1 − δ²);
    /// - lognormal with c² = δ²/3: E = 1 + c², Var = (1 + c²)² c²;
    /// - gamma with k = 1/c²: E = k/(k − 1), Var = k²/((k − 1)²(k − 2)).
    fn exact(self) -> (f64, f64) {
        let square = SPREAD * SPREAD / 3.0;
        match self {
            Self::Uniform => {
                let mean = ((1.0 + SPREAD) / (1.0 - SPREAD)).ln() / (2.0 * SPREAD);
                (mean, 1.0 / (1.0 - SPREAD * SPREAD) - mean * mean)
            }
            Self::Lognormal => (1.0 + square, (1.0 + square).powi(2) * square),
            Self::Gamma => {
                let k = 1.0 / square;
                (k / (k - 1.0), k * k / ((k - 1.0).powi(2) * (k - 2.0)))
            }
        }
    }

    /// The same by another route: the series Σ δ²ᵏ/(2k + 1) in double-double arithmetic, or a Gauss rule of thirty points.
    fn again(self) -> Result<(f64, f64), NoAnswer> {
        if self == Self::Uniform {
            let square = DoubleDouble::from_product(SPREAD, SPREAD);
            let (mut mean, mut power) = (DoubleDouble::zero(), DoubleDouble::one());
            for k in 0..40 {
                mean += power / DoubleDouble::from_f64(f64::from(2 * k + 1));
                power *= square;
            }
            let variance = DoubleDouble::one() / (DoubleDouble::one() - square) - mean * mean;
            return Ok((mean.to_f64(), variance.to_f64()));
        }
        let series = chaos(&self.space()?, &reciprocal(), 29).map_err(failed)?;
        Ok((series.mean(0), series.quadrature_variance[0]))
    }
}

/// A function of a sample that writes its answer.
type Function = fn(&[f64], &mut [f64]);

fn reciprocal() -> Closure<Function> {
    Closure::new(1, 1, |x, y| y[0] = 1.0 / x[0])
}

/// y = 1 − (m − 1) about the mean.
fn linear() -> Linear {
    Linear { at: vec![1.0], value: DVector::from_element(1, 1.0), jacobian: DMatrix::from_element(1, 1, -1.0) }
}

fn relative(found: f64, known: f64) -> f64 {
    (found / known - 1.0).abs()
}

pub(super) fn cases() -> Vec<Case> {
    let of = |mass: Mass| {
        let sampled = [Points::Random, Points::Sobol].map(|points| by_samples(mass, points));
        [closed(mass), linearised(mass)].into_iter().chain(sampled)
    };
    let orders = [3, 4, 6].map(by_rule);
    Mass::ALL.into_iter().flat_map(of).chain(orders).chain([by_points(), by_distribution(), refused()]).collect()
}

fn name(mass: Mass) -> String {
    format!("1/m, {}", mass.name())
}

fn params(mass: Mass) -> serde_json::Value {
    json!({"mass": mass.name(), "spread": SPREAD})
}

fn closed(mass: Mass) -> Case {
    Case {
        name: name(mass),
        quantity: "ratio",
        method: "closed_form".into(),
        params: params(mass),
        numbers: vec![
            error("mean_error", "second route"),
            error("variance_error", "second route"),
            told("mean", "1"),
            told("variance", "1"),
        ],
        evaluate: Box::new(move |_| {
            let ((mean, variance), again) = (mass.exact(), mass.again()?);
            Ok(vec![relative(mean, again.0), relative(variance, again.1), mean, variance])
        }),
    }
}

/// The variance of first order is c² = δ²/3: below the true one by a part that is told.
fn linearised(mass: Mass) -> Case {
    Case {
        name: name(mass),
        quantity: "ratio",
        method: "first_order".into(),
        params: params(mass),
        numbers: vec![error("rule_error", "closed form"), told("variance_shortfall", "1")],
        evaluate: Box::new(move |_| {
            let found = first_order(&mass.space()?, &linear()).map_err(failed)?.covariance[(0, 0)];
            Ok(vec![relative(found, SPREAD * SPREAD / 3.0), 1.0 - found / mass.exact().1])
        }),
    }
}

fn by_samples(mass: Mass, points: Points) -> Case {
    let method = if points == Points::Random { "monte_carlo" } else { "sobol" };
    Case {
        name: name(mass),
        quantity: "ratio",
        method: method.into(),
        params: params(mass),
        numbers: vec![
            error("mean_deviation", "closed form"),
            error("variance_deviation", "closed form"),
            error("controlled_deviation", "closed form"),
            told("reduction", "1"),
        ],
        evaluate: Box::new(move |seed| {
            // More replicates than usual: the mean of many is nearer to normal far from its middle, where the gate is.
            let settings = Sampling { points, samples: SAMPLES, seed, replicates: 64, threads: None };
            let found = sample(&mass.space()?, &reciprocal(), Some(&linear()), &settings, &|_| ()).map_err(failed)?;
            let (output, (mean, variance)) = (&found.outputs[0], mass.exact());
            let (Some(controlled), Some(reduction)) = (output.controlled, output.reduction) else {
                return Err(NoAnswer::Failed("there is no control variate".into()));
            };
            Ok(vec![output.mean.deviations(mean), output.variance.deviations(variance), controlled.deviations(mean), reduction])
        }),
    }
}

/// N points of Gauss and Legendre against the N-th convergent of `artanh δ/δ = 1/(1 − δ²/(3 − 4δ²/(5 − 9δ²/(7 − …))))`.
///
/// With m(δ) = E 1/(1 + δt): E 1/(1 + δt)² = m + δ m′. A rule is linear: so it holds for the rule and its convergent too.
fn by_rule(points: u32) -> Case {
    Case {
        name: name(Mass::Uniform),
        quantity: "ratio",
        method: format!("chaos, {points} points"),
        params: json!({"mass": "uniform", "spread": SPREAD, "points": points}),
        numbers: vec![error("rule_error", "continued fraction"), told("variance_shortfall", "1")],
        evaluate: Box::new(move |_| {
            let series = chaos(&Mass::Uniform.space()?, &reciprocal(), points as usize - 1).map_err(failed)?;
            let delta = Dual::new(SPREAD, 1.0);
            let number = |x: f64| Dual::constant(x);
            let mut fraction = number(f64::from(2 * points - 1));
            for k in (1..points).rev() {
                let k = f64::from(k);
                fraction = number(2.0 * k - 1.0) - number(k * k) * delta * delta / fraction;
            }
            let mean = number(1.0) / fraction;
            let variance = mean.value + SPREAD * mean.derivative - mean.value * mean.value;
            Ok(vec![relative(series.variance(0), variance), 1.0 - series.variance(0) / Mass::Uniform.exact().1])
        }),
    }
}

/// κ = 2: 2/3 at the mean, 1/6 at m = 1 ± δ.
fn by_points() -> Case {
    Case {
        name: name(Mass::Uniform),
        quantity: "ratio",
        method: "unscented, κ = 2".into(),
        params: json!({"mass": "uniform", "spread": SPREAD, "kappa": 2.0}),
        numbers: vec![error("rule_error", "closed form"), told("mean", "1"), told("variance", "1")],
        evaluate: Box::new(move |_| {
            let found = unscented(&Mass::Uniform.space()?, &reciprocal(), 2.0).map_err(failed)?;
            let ends = [1.0 / (1.0 - SPREAD), 1.0 / (1.0 + SPREAD)];
            let mean = 2.0 / 3.0 + (ends[0] + ends[1]) / 6.0;
            let square = |y: f64| (y - mean) * (y - mean);
            let variance = 2.0 / 3.0 * square(1.0) + (square(ends[0]) + square(ends[1])) / 6.0;
            let (found_mean, found_variance) = (found.mean[0], found.covariance[(0, 0)]);
            let worst = super::largest([relative(found_mean, mean), relative(found_variance, variance)]);
            Ok(vec![worst, found_mean, found_variance])
        }),
    }
}

/// The distribution function of 1/m is F(y) = (1 + δ − 1/y)/2δ. Kolmogorov's distance, and Wasserstein's (the mean absolute difference of
/// quantiles), in units of what is expected.
fn by_distribution() -> Case {
    Case {
        name: name(Mass::Uniform),
        quantity: "ratio_distribution",
        method: "monte_carlo".into(),
        params: json!({"mass": "uniform", "spread": SPREAD, "samples": SAMPLES}),
        numbers: vec![error("kolmogorov", "closed form"), error("wasserstein", "closed form")],
        evaluate: Box::new(move |seed| {
            let mut drawn = draw(&Mass::Uniform.space()?, &reciprocal(), Points::Random, SAMPLES, seed).map_err(failed)?;
            let values = &mut drawn[0];
            values.sort_by(f64::total_cmp);
            let n = values.len() as f64;
            let below = |y: f64| (1.0 + SPREAD - 1.0 / y) / (2.0 * SPREAD);
            let quantile = |p: f64| 1.0 / (1.0 + SPREAD - 2.0 * SPREAD * p);
            let (mut distance, mut moved) = (0.0, 0.0);
            for (k, &y) in values.iter().enumerate() {
                let k = k as f64;
                distance = super::largest([distance, below(y) - k / n, below(y) - (k + 1.0) / n]);
                moved += (y - quantile((k + 0.5) / n)).abs() / n;
            }
            // E √N |F_N − F| is at most √(F (1 − F)); dy = dF / f. By midpoints.
            let steps = 10_000;
            let expected: f64 = (0..steps)
                .map(|k| (f64::from(k) + 0.5) / f64::from(steps))
                .map(|p| (p * (1.0 - p)).sqrt() * 2.0 * SPREAD * quantile(p).powi(2) / f64::from(steps))
                .sum();
            Ok(vec![n.sqrt() * distance, n.sqrt() * moved / expected])
        }),
    }
}

/// A normal mass has no mean of 1/m: it is refused, and a truncated one is not.
fn refused() -> Case {
    let normal = Distribution::Normal { mean: 1.0, deviation: 0.1 };
    let truncated = Distribution::TruncatedNormal { mean: 1.0, deviation: 0.1, low: 0.5, high: 1.5 };
    Case {
        name: "normal mass".into(),
        quantity: "refusal",
        method: "description".into(),
        params: json!({"mean": 1.0, "deviation": 0.1}),
        numbers: vec![count("refused", 1.0, "theory"), count("truncated_refused", 0.0, "theory")],
        evaluate: Box::new(move |_| {
            let refused = [normal, truncated].map(|distribution| -> Result<f64, NoAnswer> {
                let mut robot = Family::parse("chain:n=1,layout=planar").and_then(|family| family.generate()).map_err(failed)?;
                let on = vec![Target { body: 0, field: TargetField::Mass }];
                robot.uncertain.variables = vec![UncertainVariable { name: "mass".into(), distribution, acts: Acts::Value, on }];
                Ok(f64::from(u8::from(robot.validate().is_err())))
            });
            refused.into_iter().collect()
        }),
    }
}
