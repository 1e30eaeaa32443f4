//! A random variable: quantile, distribution function, moments, and its polynomials.

use crate::quadrature::{Recurrence, Rule};
use featherbench_model::{Distribution, UncertainDefect};
use libm::erfc;
use statrs::function::erf::erfc_inv;
use statrs::function::gamma::{gamma_lr, gamma_ur, ln_gamma};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Points of the discrete measure that stands for a truncated normal variable: its density is entire, and 200 Gauss–Legendre points integrate it
/// over 20 deviations to rounding.
const DISCRETE: usize = 200;
/// Coefficients of the recurrences: orders up to one less.
pub(crate) const ORDERS: usize = 40;
/// Deviations beyond which a normal density is zero to double precision: e^(−z²/2) is 1e-315 there.
const FAR: f64 = 38.0;

/// Φ(z), the distribution function of the standard normal variable.
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * erfc(-z * FRAC_1_SQRT_2)
}

/// Φ⁻¹(p), for p in (0, 1).
pub fn normal_quantile(p: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * p)
}

/// A distribution made ready.
#[derive(Clone, Debug)]
pub struct Variable {
    distribution: Distribution,
    kind: Kind,
    mean: f64,
    variance: f64,
}

#[derive(Clone, Debug)]
enum Kind {
    Uniform {
        low: f64,
        width: f64,
    },
    Lognormal {
        location: f64,
        scale: f64,
    },
    Gamma {
        shape: f64,
        scale: f64,
        ln_gamma: f64,
    },
    Normal {
        mean: f64,
        deviation: f64,
    },
    /// Φ at the lower bound, and what is between the bounds. Reflected if most of it is above the mean: probabilities near one have few digits.
    Truncated {
        mean: f64,
        deviation: f64,
        low: f64,
        high: f64,
        below: f64,
        mass: f64,
        reflected: bool,
        polynomials: Recurrence,
    },
}

impl Variable {
    /// Makes a distribution ready.
    ///
    /// # Errors
    /// [`UncertainDefect`] when its numbers make no distribution.
    pub fn new(distribution: Distribution) -> Result<Self, UncertainDefect> {
        distribution.check()?;
        let (kind, mean, variance) = match distribution {
            Distribution::Uniform { low, high } => {
                let width = high - low;
                (Kind::Uniform { low, width }, low + 0.5 * width, width * width / 12.0)
            }
            Distribution::Lognormal { mean, deviation } => {
                // σ² = ln(1 + cv²), μ = ln mean − σ²/2
                let square = (deviation / mean).powi(2).ln_1p();
                (Kind::Lognormal { location: mean.ln() - 0.5 * square, scale: square.sqrt() }, mean, deviation * deviation)
            }
            Distribution::Gamma { mean, deviation } => {
                let shape = (mean / deviation).powi(2);
                (Kind::Gamma { shape, scale: mean / shape, ln_gamma: ln_gamma(shape) }, mean, deviation * deviation)
            }
            Distribution::Normal { mean, deviation } => (Kind::Normal { mean, deviation }, mean, deviation * deviation),
            Distribution::TruncatedNormal { mean, deviation, low, high } => {
                let polynomials = truncated(mean, deviation, low, high);
                let (centre, spread) = (polynomials.centre[0], polynomials.spread[0]);
                let (a, b) = ((low - mean) / deviation, (high - mean) / deviation);
                let reflected = a + b > 0.0;
                let (a, b) = if reflected { (-b, -a) } else { (a, b) };
                let below = normal_cdf(a);
                (Kind::Truncated { mean, deviation, low, high, below, mass: normal_cdf(b) - below, reflected, polynomials }, centre, spread)
            }
        };
        Ok(Self { distribution, kind, mean, variance })
    }

    /// What it was made of.
    pub fn distribution(&self) -> Distribution {
        self.distribution
    }

    /// Its mean.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Its variance.
    pub fn variance(&self) -> f64 {
        self.variance
    }

    /// Its support.
    pub fn support(&self) -> [f64; 2] {
        match self.kind {
            Kind::Uniform { low, width } => [low, low + width],
            Kind::Lognormal { .. } | Kind::Gamma { .. } => [0.0, f64::INFINITY],
            Kind::Normal { .. } => [f64::NEG_INFINITY, f64::INFINITY],
            Kind::Truncated { low, high, .. } => [low, high],
        }
    }

    /// The value that it stays below with probability p in (0, 1).
    pub fn quantile(&self, p: f64) -> f64 {
        match self.kind {
            Kind::Uniform { low, width } => p.mul_add(width, low),
            Kind::Lognormal { location, scale } => scale.mul_add(normal_quantile(p), location).exp(),
            Kind::Gamma { shape, scale, ln_gamma } => scale * gamma_quantile(shape, ln_gamma, p),
            Kind::Normal { mean, deviation } => deviation.mul_add(normal_quantile(p), mean),
            Kind::Truncated { mean, deviation, low, high, below, mass, reflected, .. } => {
                let z = if reflected { -normal_quantile((1.0 - p).mul_add(mass, below)) } else { normal_quantile(p.mul_add(mass, below)) };
                deviation.mul_add(z, mean).clamp(low, high)
            }
        }
    }

    /// The value whose probability is Φ(z).
    pub fn of_normal(&self, z: f64) -> f64 {
        match self.kind {
            Kind::Lognormal { location, scale } => scale.mul_add(z, location).exp(),
            Kind::Normal { mean, deviation } => deviation.mul_add(z, mean),
            // At 8 deviations 1 − Φ is 6e-16: what is beyond has no weight in double precision.
            _ => self.quantile(normal_cdf(z.clamp(-8.0, 8.0))),
        }
    }

    /// The probability that it is below a value.
    pub fn cdf(&self, x: f64) -> f64 {
        match self.kind {
            Kind::Uniform { low, width } => ((x - low) / width).clamp(0.0, 1.0),
            Kind::Lognormal { location, scale } => {
                if x > 0.0 {
                    normal_cdf((x.ln() - location) / scale)
                } else {
                    0.0
                }
            }
            Kind::Gamma { shape, scale, .. } => {
                if x > 0.0 {
                    gamma_lr(shape, x / scale)
                } else {
                    0.0
                }
            }
            Kind::Normal { mean, deviation } => normal_cdf((x - mean) / deviation),
            Kind::Truncated { mean, deviation, below, mass, reflected, .. } => {
                let z = (x - mean) / deviation;
                let part = if reflected { 1.0 - (normal_cdf(-z) - below) / mass } else { (normal_cdf(z) - below) / mass };
                part.clamp(0.0, 1.0)
            }
        }
    }

    /// The polynomials that are orthonormal for its germ t, of which [`Variable::of_germ`] makes the value.
    ///
    /// | distribution | germ | polynomials |
    /// |---|---|---|
    /// | uniform | uniform on (−1, 1) | Legendre |
    /// | normal, lognormal | standard normal | Hermite |
    /// | gamma | x / scale | generalised Laguerre |
    /// | truncated normal | x | of its density, by Stieltjes' procedure |
    pub fn polynomials(&self) -> Recurrence {
        match &self.kind {
            Kind::Uniform { .. } => Recurrence::legendre(ORDERS),
            Kind::Lognormal { .. } | Kind::Normal { .. } => Recurrence::hermite(ORDERS),
            Kind::Gamma { shape, .. } => Recurrence::laguerre(ORDERS, *shape),
            Kind::Truncated { polynomials, .. } => polynomials.clone(),
        }
    }

    /// The value of a germ.
    pub fn of_germ(&self, t: f64) -> f64 {
        match self.kind {
            Kind::Uniform { low, width } => (0.5 * (t + 1.0)).mul_add(width, low),
            Kind::Lognormal { .. } | Kind::Normal { .. } => self.of_normal(t),
            Kind::Gamma { scale, .. } => scale * t,
            Kind::Truncated { .. } => t,
        }
    }
}

/// The recurrence of a normal density between two bounds.
fn truncated(mean: f64, deviation: f64, low: f64, high: f64) -> Recurrence {
    let (low, high) = (low.max(mean - FAR * deviation), high.min(mean + FAR * deviation));
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let Rule { nodes, weights } = Recurrence::legendre(DISCRETE).rule(DISCRETE);
    let nodes: Vec<f64> = nodes.into_iter().map(|t| half.mul_add(t, middle)).collect();
    let weights = nodes.iter().zip(weights).map(|(x, w)| w * (-0.5 * ((x - mean) / deviation).powi(2)).exp()).collect();
    Recurrence::of_points(ORDERS, &Rule { nodes, weights })
}

/// t with P(shape, t) = p: Wilson and Hilferty's cube of a normal quantile, then Halley's steps on P − p, or on Q − (1 − p) in the upper half.
fn gamma_quantile(shape: f64, ln_gamma: f64, p: f64) -> f64 {
    let ninth = 1.0 / (9.0 * shape);
    let cube = ninth.sqrt().mul_add(normal_quantile(p), 1.0 - ninth);
    // Near zero P ≈ t^shape / Γ(shape + 1).
    let small = ((p * shape).ln() + ln_gamma) / shape;
    let mut t = if cube > 0.1 { shape * cube.powi(3) } else { small.exp() };
    for _ in 0..12 {
        let missed = if p < 0.5 { gamma_lr(shape, t) - p } else { (1.0 - p) - gamma_ur(shape, t) };
        let density = ((shape - 1.0) * t.ln() - t - ln_gamma).exp();
        let newton = missed / density;
        let bent = 0.5 * newton * ((shape - 1.0) / t - 1.0);
        let step = newton / (1.0 - bent.clamp(-0.5, 0.5));
        let next = (t - step).max(0.1 * t);
        if !next.is_finite() {
            break;
        }
        let moved = (next - t).abs();
        t = next;
        if moved <= 1e-15 * t {
            break;
        }
    }
    t
}
