//! Estimators on scenarios whose true parameters are known.

use super::{Case, Number, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_identification::{
    Arm, Base, IdentificationError, Identified, Information, LinearModel, Method, Request, Scatter, Scenario, Stacking, Terms, disturbed,
    fit, held_out_deviation, identify, ordinary, scatter, total, weighted,
};
use serde_json::json;
use std::sync::{Arc, OnceLock};

/// The noise of the torques, N·m.
const NOISE: f64 = 0.2;
/// Draws of the noise.
const REPEATS: usize = 4000;
/// Sets of draws, each judged by itself: what is added to the suite's seed.
const SETS: [u64; 4] = [0, 1, 2, 3];
const FRICTION: Terms = Terms { viscous: true, coulomb: true, armature: false, offset: false };

/// A scenario that cases share: it is made when the first of them is evaluated.
#[derive(Clone)]
struct Shared {
    arm: Arm,
    terms: Terms,
    samples: usize,
    made: Arc<OnceLock<Result<Scenario, IdentificationError>>>,
}

impl Shared {
    fn new(arm: Arm, terms: Terms, samples: usize) -> Self {
        Self { arm, terms, samples, made: Arc::default() }
    }

    fn get(&self) -> Result<&Scenario, NoAnswer> {
        self.made.get_or_init(|| Scenario::of(&self.arm, self.terms, self.samples)).as_ref().map_err(failed)
    }

    fn params(&self) -> serde_json::Value {
        let Terms { armature, viscous, coulomb, offset } = self.terms;
        let terms = json!({"armature": armature, "viscous": viscous, "coulomb": coulomb, "offset": offset});
        json!({"joints": self.arm.joints, "terms": terms, "samples": self.samples})
    }
}

pub(super) fn cases() -> Vec<Case> {
    let general = Shared::new(Arm::general(3, 4), Terms::ALL, 150);
    let puma = Shared::new(Arm::puma560(), FRICTION, 150);
    let panda = Shared::new(Arm::panda(), Terms::NONE, 120);
    let small = Shared::new(Arm::general(2, 4), FRICTION, 40);
    let exact = [&general, &puma, &panda]
        .into_iter()
        .flat_map(|shared| ["ordinary", "weighted", "total"].map(|method| without_noise(shared, method)));
    let held = [&general, &puma].into_iter().flat_map(|shared| {
        [Method::Ordinary, Method::Weighted, Method::Total, Method::LogCholesky].map(|method| with_noise(shared, method))
    });
    exact.chain(held).chain(SETS.map(|set| repeats(&small, set))).chain(intervals(&general)).collect()
}

/// The largest error of base parameters over the largest of them.
fn distance(found: &[f64], due: &[f64]) -> f64 {
    largest(found.iter().zip(due).map(|(a, b)| a - b)) / largest(due.iter().copied())
}

fn without_noise(shared: &Shared, method: &'static str) -> Case {
    let own = shared.clone();
    Case {
        name: shared.arm.name.clone(),
        quantity: "without_noise",
        method: method.into(),
        params: shared.params(),
        numbers: vec![error("error", "truth"), told("condition", "1")],
        evaluate: Box::new(move |_| {
            let scenario = own.get()?;
            let estimator = match method {
                "ordinary" => ordinary,
                "weighted" => weighted,
                _ => total,
            };
            let found = estimator(&scenario.linear, &scenario.fitted).map_err(failed)?;
            Ok(vec![distance(&found.beta, &found.base.values(&scenario.truth)), found.base.condition()])
        }),
    }
}

/// One draw of noise: held-out error, and bodies that can exist.
fn with_noise(shared: &Shared, method: Method) -> Case {
    let own = shared.clone();
    let consistent = method == Method::LogCholesky;
    // Least squares without constraints may give bodies that cannot exist: that informs.
    let bodies = if consistent { count("impossible_bodies", 0.0, "physics") } else { told("impossible_bodies", "1") };
    let smallest = Number { reference: "physics", ..told("smallest_eigenvalue", "1") };
    Case {
        name: shared.arm.name.clone(),
        quantity: "with_noise",
        method: method.name().into(),
        params: shared.params(),
        numbers: vec![
            error("held_out_deviation", "theory"),
            bodies,
            smallest,
            told("held_out_over_noise", "1"),
            told("before_over_noise", "1"),
            told("error", "1"),
        ],
        evaluate: Box::new(move |seed| {
            let scenario = own.get()?;
            let linear = &scenario.linear;
            let request = Request { method, held_out: 0.0, solver: None };
            let found: Identified = identify(linear, &scenario.noisy(NOISE, seed), &request).map_err(failed)?;
            let other = disturbed(&scenario.held_out, NOISE, seed.wrapping_add(1));
            let size = |theta: &[f64]| -> Result<f64, NoAnswer> {
                let rms = fit(linear, &other, theta).map_err(failed)?.rms;
                Ok((rms.iter().map(|rms| rms * rms).sum::<f64>() / rms.len() as f64).sqrt() / NOISE)
            };
            let impossible = found.bodies.iter().filter(|body| !body.is_consistent()).count();
            let smallest =
                found.bodies.iter().map(|body| body.smallest / body.largest).reduce(|a, b| if a.is_nan() || a < b { a } else { b });
            let due = found.estimate.base.values(&scenario.truth);
            let held_out = size(&found.theta)?;
            Ok(vec![
                held_out_deviation(scenario, held_out * held_out).map_err(failed)?,
                impossible as f64,
                smallest.unwrap_or(f64::NAN),
                held_out,
                size(&linear.nominal())?,
                distance(&found.beta, &due),
            ])
        }),
    }
}

/// The spread of thousands of estimates against σ²(YᵀY)⁻¹.
fn repeats(shared: &Shared, set: u64) -> Case {
    let own = shared.clone();
    let mut params = shared.params();
    params["noise"] = NOISE.into();
    params["repeats"] = REPEATS.into();
    params["set"] = set.into();
    Case {
        name: format!("{}, set {set}", shared.arm.name),
        quantity: "scatter",
        method: "ordinary".into(),
        params,
        numbers: vec![
            error("variance_error", "theory"),
            error("beyond_edges", "theory"),
            error("coverage_error", "theory"),
            error("bias", "theory"),
            told("least_variance", "1"),
            told("largest_variance", "1"),
        ],
        evaluate: Box::new(move |seed| {
            let Scatter { variance, extremes, edges, bias, coverage } =
                scatter(own.get()?, NOISE, REPEATS, seed.wrapping_add(set)).map_err(failed)?;
            // How far the extremes are outside of where they are expected, on each side.
            let below = (edges[0] - extremes[0]).max(0.0);
            let above = if extremes[1].is_nan() { f64::NAN } else { (extremes[1] - edges[1]).max(0.0) };
            Ok(vec![(variance - 1.0).abs(), largest([below, above]), (coverage - 0.95).abs(), bias, extremes[0], extremes[1]])
        }),
    }
}

/// Each base parameter of one draw, with its interval.
fn intervals(shared: &Shared) -> Vec<Case> {
    let described = LinearModel::new(&shared.arm.describe(featherbench_identification::Gravity::Parallel, 1), shared.terms);
    let base = described.and_then(|linear| Ok((Base::of_robot(&linear, 1)?.names(&linear), linear)));
    let Ok((names, _)) = base else { return Vec::new() };
    let of = |(i, name): (usize, String)| {
        let own = shared.clone();
        let mut params = shared.params();
        params["index"] = i.into();
        Case {
            name,
            quantity: "interval",
            method: "ordinary".into(),
            params,
            numbers: vec![error("deviations", "truth"), told("estimate", "SI"), told("truth", "SI"), told("half_width", "SI")],
            evaluate: Box::new(move |seed| {
                let scenario = own.get()?;
                let linear = &scenario.linear;
                let samples = scenario.noisy(NOISE, seed);
                let found = ordinary(linear, &samples).map_err(failed)?;
                let due = Base::of(&Information::of(linear, &samples, &Stacking::plain(linear)).map_err(failed)?).map_err(failed)?;
                let truth = due.values(&scenario.truth);
                let none = || NoAnswer::Failed("there is no such base parameter".into());
                let (&estimate, &truth) = (found.beta.get(i).ok_or_else(none)?, truth.get(i).ok_or_else(none)?);
                let (deviation, half) = (found.deviation(i).ok_or_else(none)?, found.half_width(i).ok_or_else(none)?);
                Ok(vec![(estimate - truth).abs() / deviation, estimate, truth, half])
            }),
        }
    };
    names.into_iter().enumerate().map(of).collect()
}
