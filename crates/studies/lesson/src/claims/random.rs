//! §5 and problem 2: random parameters.
//!
//! q̈ = u/m with u = 1 and a mean mass of 1. Uniform in 1 ± δ: E = Σ δ²ᵏ/(2k + 1), E[q̈²] = 1/(1 − δ²). Lognormal of the squared variation c:
//! Var = (1 + c)² c. Gamma of shape k = 1/c: Var = k²/((k − 1)²(k − 2)). Second routes: quadrature.

use crate::arm::Arm;
use crate::claim::{Claim, Failure, Holds, Number};
use crate::quadrature::{Rule, simpson};
use featherbench_dynamics::{ParameterSensitivity, State, inertial_parameters};
use featherbench_model::Model;
use featherbench_spatial::{DoubleDouble, Dual, Real};
use std::f64::consts::TAU;

/// ∫ f dz over the whole line by equal steps: all digits where f and its derivatives vanish at ±12.
fn line(f: impl Fn(f64) -> f64) -> f64 {
    let step = 1.0 / 32.0;
    (-384..=384).map(|k| f(f64::from(k) * step)).sum::<f64>() * step
}

fn normal(z: f64) -> f64 {
    (-0.5 * z * z).exp() / TAU.sqrt()
}

/// Mean and variance of 1/m for m uniform in 1 ± δ, as series in double-double.
fn uniform_series(deviation: f64) -> [f64; 2] {
    let square = DoubleDouble::from_f64(deviation) * DoubleDouble::from_f64(deviation);
    let (mut mean, mut moment, mut power) = (DoubleDouble::zero(), DoubleDouble::zero(), DoubleDouble::one());
    let mut k = 0;
    // Until the terms are below the last digit of a double-double.
    while power.to_f64() > 1e-34 && k < 4000 {
        mean += power / DoubleDouble::from_f64(f64::from(2 * k + 1));
        moment += power;
        power *= square;
        k += 1;
    }
    [mean.to_f64(), (moment - mean * mean).to_f64()]
}

/// The single joint with a mass within ±δ, or of the same variation by other laws.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ratio {
    pub(crate) deviation: f64,
}

impl Ratio {
    pub(crate) fn numbers(&self) -> Vec<Number> {
        let delta = self.deviation;
        let percent = 100.0 * delta;
        let square = delta * delta / 3.0;
        let rule = Rule::gauss(40);
        let [mean, variance] = uniform_series(delta);
        let over = |f: &dyn Fn(f64) -> f64| rule.integral(1.0 - delta, 1.0 + delta, f) / (2.0 * delta);
        // The mean of 1/m − 1 = (1 − m)/m, so that small deviations keep their digits.
        let shift = over(&|m| (1.0 - m) * (1.0 - m) / m);
        let spread = over(&|m| ((1.0 - m) / m - shift).powi(2));
        // Lognormal with mean 1: m = exp(s z − s²/2).
        let s = (1.0 + square).ln().sqrt();
        let inverse = |z: f64| (0.5 * s * s - s * z).exp();
        let log_mean = line(|z| normal(z) * inverse(z));
        let log_spread = line(|z| normal(z) * (inverse(z) - log_mean).powi(2));
        // Gamma with mean 1 and shape k, over y = ln m in units of 1/√k.
        let k = 1.0 / square;
        let density = |z: f64| {
            let y = z / k.sqrt();
            (k * (y - y.exp_m1())).exp()
        };
        let total = line(density);
        let inverse = |z: f64| (-z / k.sqrt()).exp();
        let gamma_mean = line(|z| density(z) * inverse(z)) / total;
        let gamma_spread = line(|z| density(z) * (inverse(z) - gamma_mean).powi(2)) / total;
        let gamma = k * k / ((k - 1.0) * (k - 1.0) * (k - 2.0));
        let named = |what: &str, law: &str| format!("{what} of q̈, {law}, ±{percent:.0} %");
        let unit = "m²/s⁴";
        vec![
            Number::new(named("mean", "uniform"), "m/s²", mean, 1.0 + shift).stated(1.0, -shift),
            Number::new(named("variance", "uniform"), unit, variance, spread).stated(square, square - spread),
            Number::new(named("variance", "lognormal"), unit, (1.0 + square).powi(2) * square, log_spread)
                .stated(square, square - log_spread),
            Number::new(named("variance", "gamma"), unit, gamma, gamma_spread).stated(square, square - gamma_spread),
        ]
    }
}

/// The coefficient of δ² of the exact variance by nested dual numbers, and f′(1)² times the variance of a uniform number in ±1.
fn first_order() -> Number {
    let at_zero = Dual::new(Dual::new(0.0, 1.0), Dual::constant(1.0));
    let square = at_zero * at_zero;
    let one = Dual::<Dual<f64>>::one();
    // Up to δ²: the terms of higher order have no second derivative at zero.
    let (mean, moment) = (one + square / Dual::from_f64(3.0), one + square);
    let found = 0.5 * (moment - mean * mean).derivative.derivative;
    let slope = (Dual::constant(1.0) / Dual::new(1.0, 1.0)).derivative;
    let known = slope * slope * Rule::gauss(4).integral(-1.0, 1.0, |x| 0.5 * x * x);
    Number::new("coefficient of δ² of the variance, uniform", "m²/s⁴", found, known).stated(1.0 / 3.0, 0.0)
}

/// Problem 2.
pub(super) fn ratio() -> Claim {
    Claim {
        id: "ratio_variance",
        place: "§5, Problem 2",
        title: "Variance of an acceleration",
        says: "To first order the variance is (τ − b q̇)² σ²/m⁴, about the acceleration at the mean mass.",
        right: "To first order it is. At ±20 % it is 5.8 % below that of a uniform mass, and other laws of the same σ differ from both; the mean moves too.",
        holds: Holds::InPart,
        numbers: |_| Ok([vec![first_order()], Ratio { deviation: 0.2 }.numbers()].concat()),
    }
}

/// A normal mass.
pub(super) fn gaussian() -> Claim {
    Claim {
        id: "ratio_gaussian",
        place: "§5, Problem 2",
        title: "A normally distributed mass",
        says: "Mean and covariance of the parameters suffice; nothing is said of their distribution.",
        right: "Of a normal mass 1/m has no mean and no variance: masses between ε and 2ε add φ(0)/(2ε) to E[1/m²]. It must be refused or cut off.",
        holds: Holds::No,
        numbers: |_| {
            let (sigma, near) = (0.2, 1e-15);
            let density = |m: f64| normal((m - 1.0) / sigma) / sigma;
            // In x = m/ε: ε ∫ φ(m)/m² dm = ∫ φ(εx)/x² dx from 1 to 2.
            let share = Rule::gauss(20).integral(1.0, 2.0, |x| density(near * x) / (x * x));
            let known = 0.5 * density(0.0);
            Ok(vec![Number::new("ε times what masses in (ε, 2ε) add to E[1/m²], ε = 1e-15", "1", share, known).stated(0.0, -known)])
        },
    }
}

/// J_θ.
pub(super) fn sensitivity() -> Claim {
    Claim {
        id: "parameter_sensitivity",
        place: "§5",
        title: "Derivatives with respect to parameters",
        says: "J_θ is expensive; to compute it is an open problem.",
        right: "Without contact J_θ = −M⁻¹ Y(q, q̇, q̈) exactly: one regressor and one factorization.",
        holds: Holds::Silent,
        numbers: |_| sensitivities(&Arm::default()),
    }
}

fn sensitivities(arm: &Arm) -> Result<Vec<Number>, Failure> {
    let model = |masses: [f64; 2]| -> Result<Model<f64>, Failure> {
        Arm { masses, ..*arm }.model()?.ok_or_else(|| Failure::of("no body has the lesson's links; take rods or tip masses"))
    };
    let nominal = model(arm.masses)?;
    let (mut a, mut by_parameters) = ([0.0; 2], [0.0; 40]);
    let state = State { q: &arm.q, v: &arm.v, given: &arm.tau, wrenches: None };
    ParameterSensitivity::new(&nominal).run(&nominal, state, &mut a, &mut by_parameters)?;
    let mut numbers = Vec::new();
    for body in 0..2 {
        // Parameters are linear in the mass: their derivative is a difference over one kilogramme.
        let mut heavier = arm.masses;
        heavier[body] += 1.0;
        let (from, to) = (inertial_parameters::<f64, f64>(&nominal), inertial_parameters::<f64, f64>(&model(heavier)?));
        let direction: Vec<f64> = to.iter().zip(&from).map(|(to, from)| to - from).collect();
        let masses = [0, 1].map(|k| {
            let rate = if k == body { DoubleDouble::one() } else { DoubleDouble::zero() };
            Dual::new(DoubleDouble::from_f64(arm.masses[k]), rate)
        });
        let known = arm.accelerations(masses);
        for k in 0..2 {
            let found: f64 = by_parameters[20 * k..20 * (k + 1)].iter().zip(&direction).map(|(slope, rate)| slope * rate).sum();
            let name = format!("∂q̈{}/∂m{}", k + 1, body + 1);
            numbers.push(Number::new(name, "rad/(s²·kg)", found, known[k].derivative.to_f64()));
        }
    }
    Ok(numbers)
}

/// A rule of quadrature on the heights that have bounced.
type Integral<'a> = &'a dyn Fn(&dyn Fn(f64) -> f64) -> f64;

/// A ball whose height is normal, looked at about the time of its impact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drop {
    pub(crate) mean: f64,
    pub(crate) deviation: f64,
    pub(crate) restitution: f64,
    pub(crate) gravity: f64,
    pub(crate) time: f64,
}

impl Default for Drop {
    fn default() -> Self {
        Self { mean: 1.0, deviation: 0.05, restitution: 0.8, gravity: 9.81, time: 0.45 }
    }
}

impl Drop {
    pub(crate) fn numbers(&self) -> Vec<Number> {
        // It has bounced where its height was below g T²/2. Until then v = −g T, after that v = g ((1 + e) t₁ − T).
        let falling = -self.gravity * self.time;
        let limit = (0.5 * self.gravity * self.time * self.time - self.mean) / self.deviation;
        let jump = |z: f64| self.gravity * (1.0 + self.restitution) * (2.0 * (self.mean + self.deviation * z) / self.gravity).sqrt();
        // 12 deviations below the mean there are no heights: 1e-33 of them.
        let low = -12.0;
        let rule = Rule::gauss(20);
        let panels = |f: &dyn Fn(f64) -> f64| rule.on_panels(low, limit, 24, f);
        let other = |f: &dyn Fn(f64) -> f64| simpson(low, limit, 40_000, f);
        let moments = |integral: Integral| {
            let share = integral(&normal);
            let first = integral(&|z| normal(z) * jump(z));
            let second = integral(&|z| normal(z) * jump(z) * jump(z));
            [share, falling + first, (second - first * first).sqrt()]
        };
        let ([share, mean, spread], [share_2, mean_2, spread_2]) = (moments(&panels), moments(&other));
        // At the mean height: bounced or not.
        let bounced = limit > 0.0;
        let at_mean = if bounced { falling + jump(0.0) } else { falling };
        let certain = if bounced { 1.0 } else { 0.0 };
        let slope = if bounced { 0.5 * jump(0.0) / self.mean * self.deviation } else { 0.0 };
        vec![
            Number::new("P(bounced)", "1", share, share_2).stated(certain, certain - share_2),
            Number::new("mean velocity", "m/s", mean, mean_2).stated(at_mean, at_mean - mean_2),
            Number::new("deviation of the velocity", "m/s", spread, spread_2).stated(slope, slope - spread_2),
        ]
    }
}

/// Modes.
pub(super) fn modes() -> Claim {
    Claim {
        id: "random_modes",
        place: "§5",
        title: "Linearisation across an impact",
        says: "Σ ≈ J Σ_θ Jᵀ; it may break down at hybrid events.",
        right: "It does: a ball of random height has two modes. Linearised at the mean it falls for certain, with a deviation of 0.",
        holds: Holds::No,
        numbers: |_| Ok(Drop::default().numbers()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::Links;

    #[test]
    fn published_moments() {
        let values: Vec<f64> = Ratio { deviation: 0.2 }.numbers().iter().map(|number| number.corrected).collect();
        for (value, known) in values.iter().zip([1.01366277027041, 0.0141544548343827, 0.0136912592593, 0.0140713649599]) {
            assert!((value / known - 1.0).abs() < 1e-11, "{value} {known}");
        }
    }

    #[test]
    fn other_numbers_agree() {
        for deviation in [0.01, 0.05, 0.3] {
            for number in (Ratio { deviation }).numbers() {
                assert!(number.error() < 1e-10, "{number:?}");
            }
        }
        for time in [0.42, 0.45, 0.5] {
            for number in (Drop { time, ..Drop::default() }).numbers() {
                assert!(number.error() < 1e-10 && number.separation_error().unwrap() < 1e-10, "{number:?}");
            }
        }
        for number in sensitivities(&Arm::default().with(Links::TipMasses)).unwrap() {
            assert!(number.error() < 1e-12, "{number:?}");
        }
    }
}
