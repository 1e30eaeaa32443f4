//! A drop from an uncertain height, looked at after a time at which it may or may not have met the ground: a mixture of two contact modes.
//!
//! With s = √(2 g x₀): before the impact v = −gT; after it, v = (1 + e) s − gT. It has met the ground if x₀ < gT²/2. All drops without an impact
//! have the same velocity, an atom of the distribution. The line through the mean height knows of that mode alone.

use super::{Case, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_hybrid::systems::BouncingBall;
use featherbench_hybrid::{Settings, Start, simulate};
use featherbench_model::Distribution;
use featherbench_uncertainty::{Recurrence, Sampling, Space, Variable, mixture, normal_cdf};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

const GRAVITY: f64 = 9.81;
const RESTITUTION: f64 = 0.8;
const TIME: f64 = 0.45;
/// The height, m: normal.
const HEIGHT: [f64; 2] = [1.0, 0.05];
const SAMPLES: u64 = 1 << 18;
/// Bins of the density, between these velocities.
const BINS: u32 = 24;
const RANGE: [f64; 2] = [2.1, 3.6];

/// The height below which there is an impact.
fn critical() -> f64 {
    0.5 * GRAVITY * TIME * TIME
}

/// How many impacts there were, and the velocity.
fn drop(height: f64) -> Option<(u64, f64)> {
    if height <= 0.0 {
        return None;
    }
    let free = -GRAVITY * TIME;
    let speed = (2.0 * GRAVITY * height).sqrt();
    let impact = height < critical();
    Some((u64::from(impact), if impact { (1.0 + RESTITUTION) * speed + free } else { free }))
}

fn space() -> Result<Space, NoAnswer> {
    Space::independent(&[Distribution::Normal { mean: HEIGHT[0], deviation: HEIGHT[1] }]).map_err(failed)
}

fn params() -> Value {
    json!({"gravity": GRAVITY, "restitution": RESTITUTION, "time": TIME, "height": HEIGHT})
}

/// Of drops with an impact: the probability, and the mean and variance of v. By composite Gauss–Legendre rules over the density of the height.
fn exact() -> (f64, f64, f64) {
    let rule = Recurrence::legendre(20).rule(20);
    let (low, high) = (HEIGHT[0] - 9.0 * HEIGHT[1], critical());
    let pieces = 16;
    let (mut sums, half) = ([0.0; 3], 0.5 * (high - low) / f64::from(pieces));
    for piece in 0..pieces {
        let middle = low + half * f64::from(2 * piece + 1);
        for (t, weight) in rule.nodes.iter().zip(&rule.weights) {
            let x = middle + half * t;
            let z = (x - HEIGHT[0]) / HEIGHT[1];
            let density = (-0.5 * z * z).exp() / (std::f64::consts::TAU.sqrt() * HEIGHT[1]);
            let v = (1.0 + RESTITUTION) * (2.0 * GRAVITY * x).sqrt() - GRAVITY * TIME;
            let part = 2.0 * half * weight * density;
            sums = [sums[0] + part, sums[1] + part * v, sums[2] + part * v * v];
        }
    }
    let mean = sums[1] / sums[0];
    (sums[0], mean, sums[2] / sums[0] - mean * mean)
}

/// Mean and variance of both modes together.
fn together((weight, mean, variance): (f64, f64, f64)) -> (f64, f64) {
    let free = -GRAVITY * TIME;
    let all = weight * mean + (1.0 - weight) * free;
    (all, weight * (variance + (mean - all).powi(2)) + (1.0 - weight) * (free - all).powi(2))
}

pub(super) fn cases() -> Vec<Case> {
    let bins = (0..BINS).map(density);
    [closed(), sampled(), simulated(), linearised()].into_iter().chain(bins).collect()
}

/// The composite rules against others: Φ, and the Gauss rule of the truncated normal height.
fn closed() -> Case {
    Case {
        name: "drop".into(),
        quantity: "drop",
        method: "quadrature".into(),
        params: params(),
        numbers: vec![
            error("weight_error", "closed form"),
            error("mean_error", "second route"),
            error("variance_error", "second route"),
            told("weight", "1"),
            told("mean", "m/s"),
            told("deviation", "m/s"),
        ],
        evaluate: Box::new(|_| {
            let found = exact();
            let weight = normal_cdf((critical() - HEIGHT[0]) / HEIGHT[1]);
            let low = HEIGHT[0] - 12.0 * HEIGHT[1];
            let height = Distribution::TruncatedNormal { mean: HEIGHT[0], deviation: HEIGHT[1], low, high: critical() };
            let height = Variable::new(height).map_err(failed)?;
            let rule = height.polynomials().rule(30);
            let velocity = |x: f64| (1.0 + RESTITUTION) * (2.0 * GRAVITY * x).sqrt() - GRAVITY * TIME;
            let mean: f64 = rule.nodes.iter().zip(&rule.weights).map(|(x, w)| w * velocity(*x)).sum();
            let variance: f64 = rule.nodes.iter().zip(&rule.weights).map(|(x, w)| w * (velocity(*x) - mean).powi(2)).sum();
            let relative = |a: f64, b: f64| (a / b - 1.0).abs();
            let (all, square) = together(found);
            Ok(vec![relative(found.0, weight), relative(found.1, mean), relative(found.2, variance), found.0, all, square.sqrt()])
        }),
    }
}

/// How far the share of the samples that something happens to is from its probability: √(2 N D) with the divergence D of both. It is beyond z with
/// the probability 2 exp(−z²/2) at most, for any number of samples and any probability (H. Chernoff, 1952).
fn share_deviation(share: f64, probability: f64) -> f64 {
    let part = |share: f64, probability: f64| if share > 0.0 { share * (share / probability).ln() } else { 0.0 };
    let divergence = part(share, probability) + part(1.0 - share, 1.0 - probability);
    // Of equal numbers it rounds to either side of zero.
    (2.0 * SAMPLES as f64 * divergence).max(0.0).sqrt()
}

fn sampled() -> Case {
    Case {
        name: "drop".into(),
        quantity: "drop",
        method: "monte_carlo".into(),
        params: params(),
        numbers: vec![
            count("modes", 2.0, "theory"),
            error("weight_deviation", "quadrature"),
            error("mean_deviation", "quadrature"),
            error("variance_deviation", "quadrature"),
            error("mode_mean_deviation", "quadrature"),
            error("mode_variance_deviation", "quadrature"),
        ],
        evaluate: Box::new(|seed| {
            let found = mixture(&space()?, &Sampling { samples: SAMPLES, seed, ..Sampling::default() }, |x| drop(x[0])).map_err(failed)?;
            let known = exact();
            let (mean, variance) = together(known);
            let Some(impact) = found.modes.iter().find(|mode| mode.mode == 1) else {
                return Err(NoAnswer::Failed("no sample has an impact".into()));
            };
            let own = &impact.moments;
            Ok(vec![
                found.modes.len() as f64,
                share_deviation(impact.weight.value, known.0),
                found.all.mean_estimate().deviations(mean),
                found.all.variance_estimate().deviations(variance),
                own.mean_estimate().deviations(known.1),
                own.variance_estimate().deviations(known.2),
            ])
        }),
    }
}

/// The hybrid system's run against the closed form, at quantiles of the height: modes are counts of impacts.
fn simulated() -> Case {
    Case {
        name: "drop".into(),
        quantity: "drop",
        method: "hybrid_system".into(),
        params: params(),
        numbers: vec![count("other_modes", 0.0, "closed form"), error("velocity_error", "closed form")],
        evaluate: Box::new(|_| {
            let height = Variable::new(Distribution::Normal { mean: HEIGHT[0], deviation: HEIGHT[1] }).map_err(failed)?;
            let (mut others, mut worst) = (0, 0.0);
            for k in 0..200 {
                let x = height.quantile((f64::from(k) + 0.5) / 200.0);
                let start = Start { mode: 0, time: 0.0, state: vec![x, 0.0, 0.0] };
                let run = simulate(&BouncingBall, &[GRAVITY, RESTITUTION], &start, TIME, &Settings::default()).map_err(failed)?;
                let impacts = run.events.iter().filter(|event| event.mode == 0).count() as u64;
                let (mode, v) = drop(x).ok_or_else(|| NoAnswer::Failed("a height is not positive".into()))?;
                others += u32::from(impacts != mode);
                worst = largest([worst, (run.state[1] - v) / v]);
            }
            Ok(vec![f64::from(others), worst])
        }),
    }
}

/// About the mean height there is no impact, and v does not depend on the height.
fn linearised() -> Case {
    Case {
        name: "drop".into(),
        quantity: "drop",
        method: "first_order".into(),
        params: params(),
        numbers: vec![told("mean", "m/s"), count("deviation", 0.0, "closed form")],
        evaluate: Box::new(|_| {
            let step = 1e-6;
            let velocity = |x: f64| drop(x).map(|(_, v)| v).ok_or_else(|| NoAnswer::Failed("a height is not positive".into()));
            let slope = (velocity(HEIGHT[0] + step)? - velocity(HEIGHT[0] - step)?) / (2.0 * step);
            Ok(vec![velocity(HEIGHT[0])?, slope.abs() * HEIGHT[1]])
        }),
    }
}

/// A bin of v: its middle and its width, m/s.
#[derive(Serialize, Deserialize)]
pub(super) struct Bin {
    pub(super) velocity: f64,
    width: f64,
}

/// The density of v after an impact, in a bin: counts against the probability of the bin.
fn density(bin: u32) -> Case {
    let width = (RANGE[1] - RANGE[0]) / f64::from(BINS);
    let ends = [0.0, 1.0].map(|k| RANGE[0] + width * (f64::from(bin) + k));
    Case {
        name: format!("drop, {:.4} m/s", 0.5 * (ends[0] + ends[1])),
        quantity: "drop_density",
        method: "monte_carlo".into(),
        params: json!(Bin { velocity: 0.5 * (ends[0] + ends[1]), width }),
        numbers: vec![error("count_deviation", "closed form"), told("density", "s/m"), told("known_density", "s/m")],
        evaluate: Box::new(move |seed| {
            let inside = |v: f64| v >= ends[0] && v < ends[1];
            let answer = |x: &[f64]| drop(x[0]).map(|(impact, v)| (u64::from(impact == 1 && inside(v)), v));
            let found = mixture(&space()?, &Sampling { samples: SAMPLES, seed, ..Sampling::default() }, answer).map_err(failed)?;
            let part = found.modes.iter().find(|mode| mode.mode == 1).map_or(0.0, |mode| mode.weight.value);
            // v rises with the height: the ends of the bin are heights.
            let height = |v: f64| ((v + GRAVITY * TIME) / (1.0 + RESTITUTION)).powi(2) / (2.0 * GRAVITY);
            let below = |v: f64| normal_cdf((height(v).min(critical()) - HEIGHT[0]) / HEIGHT[1]);
            let known = below(ends[1]) - below(ends[0]);
            Ok(vec![share_deviation(part, known), part / width, known / width])
        }),
    }
}
