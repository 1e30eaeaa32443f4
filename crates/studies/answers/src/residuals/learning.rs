//! Three learned models of an arm: torques of motions that they have not seen, and the energy of 1000 s without forces.
//!
//! Each learns from the same motions, with and without noise on the torques. The motion without forces begins at rest, at angles within those that were
//! learned. Its energies are the true one, by the true model at the states of the learned motion, and the model's own.
//!
//! - `learning` is one draw of motions, whose energies are drawn.
//! - `learning_draws` are the worst numbers of further draws, of the models that a linear solution fits.

use super::{Case, Number, arm, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_learning::{BlackBox, Degrees, Dynamics, Lagrangian, Motion, Net, PortHamiltonian, Rollout, Sample, Truth, held_out};
use featherbench_model::Model;
use serde_json::json;

/// What is learned from. Another seed's stream of two trajectories is held out, without noise.
const MOTION: Motion = Motion { amplitude: 0.8, frequency: 0.8, harmonics: 5, trajectories: 4, samples: 150, noise: 0.0 };
const NET: Net = Net { hidden: 12, epsilon: 1e-3, seed: 1, patience: 3 };
/// Degree and λ of the ridge of M and V, without and with noise.
const STRUCTURED: [(usize, f64); 2] = [(6, 1e-13), (3, 1e-5)];
/// Total degree in six variables and λ of the black box, without and with noise.
const BLACK: [(usize, f64); 2] = [(4, 1e-13), (4, 1e-5)];
/// Draws of `learning_draws`: what is added to the suite's seed.
const DRAWS: [u64; 3] = [101, 102, 103];
/// Noise on torques over their root mean square.
const NOISE: [f64; 2] = [0.0, 1e-2];
/// Where the motion begins, at rest, rad.
const START: [f64; 2] = [0.4, 0.3];
/// The step of the motion, s: the rule's own error of the energy after 1000 s is in the rows of the true model.
const STEP: f64 = 0.01;
/// When energies are read, s. They are in the names of `DRIFTS`.
const TIMES: [f64; 7] = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0];
/// Metrics of the true energy's change at each time.
pub(super) const DRIFTS: [&str; 7] = ["drift_1s", "drift_3s", "drift_10s", "drift_30s", "drift_100s", "drift_300s", "drift_1000s"];

/// The models, by the names in rows.
const MODELS: [&str; 4] = ["truth", "lagrangian net", "port-hamiltonian", "black box"];

pub(super) fn cases() -> Vec<Case> {
    let of = |noise: usize| MODELS.into_iter().map(move |model| case(model, noise));
    (0..NOISE.len()).flat_map(of).chain((0..NOISE.len()).flat_map(draws)).collect()
}

/// Degree and λ of a model that a linear solution fits.
fn chosen(model: &str, noise: usize) -> (usize, f64) {
    if model == "black box" { BLACK[noise] } else { STRUCTURED[noise] }
}

fn truth() -> Result<Truth, NoAnswer> {
    Truth::new(Model::build(&arm(1.0).describe()).map_err(failed)?).map_err(failed)
}

/// The model that learned from motions with this noise.
fn learned(model: &str, noise: usize, seed: u64) -> Result<Box<dyn Dynamics>, NoAnswer> {
    let truth = truth()?;
    let samples = motions(noise, seed, "learn")?;
    Ok(match model {
        "truth" => Box::new(truth),
        "lagrangian net" => Box::new(Lagrangian::fit(&samples, NET).map_err(failed)?.0),
        _ => fitted(model, chosen(model, noise), &samples)?,
    })
}

/// Samples of a stream of motions with this noise.
fn motions(noise: usize, seed: u64, stream: &str) -> Result<Vec<Sample>, NoAnswer> {
    Motion { noise: NOISE[noise], ..MOTION }.samples(&truth()?, seed, stream).map_err(failed)
}

/// A model that a linear solution fits, of this degree and λ.
fn fitted(model: &str, (degree, lambda): (usize, f64), samples: &[Sample]) -> Result<Box<dyn Dynamics>, NoAnswer> {
    if model == "black box" {
        return Ok(Box::new(BlackBox::fit(samples, degree, lambda).map_err(failed)?));
    }
    let fitted = PortHamiltonian::fit(samples, Degrees { total: degree, damping: false }, lambda).map_err(failed)?;
    let smallest = fitted.smallest_mass(samples);
    if smallest.is_nan() || smallest <= 0.0 {
        return Err(NoAnswer::Failed(format!("the mass matrix has the eigenvalue {smallest:e} at a sample")));
    }
    Ok(Box::new(fitted))
}

/// How long a motion without forces stays in the robot's range, and the largest changes of the true and of the model's own energy.
fn rollout(truth: &Truth, model: &dyn Dynamics) -> Result<(f64, f64, f64), NoAnswer> {
    let rollout = Rollout { start: START.to_vec(), step: STEP, times: TIMES.to_vec(), bound: std::f64::consts::PI };
    let (changes, escape) = rollout.run(&truth.model().topology, model, truth).map_err(failed)?;
    let own = largest(changes.iter().map(|(_, _, own)| own.unwrap_or(0.0)));
    Ok((escape.map_or(1000.0, |escape| escape.time), largest(changes.iter().map(|(_, change, _)| change.abs())), own))
}

/// The worst numbers of further draws, of both models that a linear solution fits.
///
/// | metric | of the draws |
/// |---|---|
/// | `torque_error` | the largest error of torques that were not seen |
/// | `own_energy_drift` | the largest change of the structured model's own energy |
/// | `left` | how many of its motions left the robot's range before 1000 s |
/// | `black_torque_error`, `black_left` | the same of the black box |
/// | `black_holds_better` | in how many draws the black box's true energy changes less, or its motion stays longer |
fn draws(noise: usize) -> [Case; 1] {
    let torque = if noise == 0 { error("torque_error", "truth") } else { Number { reference: "truth", ..told("torque_error", "1") } };
    [Case {
        name: if noise == 0 { "arm, no noise, further draws".into() } else { format!("arm, noise {}, further draws", NOISE[noise]) },
        quantity: "learning_draws",
        method: "port-hamiltonian".into(),
        params: json!({
            "noise": NOISE[noise], "draws": DRAWS, "structured": STRUCTURED[noise], "black": BLACK[noise], "amplitude": MOTION.amplitude,
            "trajectories": MOTION.trajectories, "samples": MOTION.samples, "start": START, "step": STEP,
        }),
        numbers: vec![
            torque,
            error("own_energy_drift", "conservation"),
            count("left", 0.0, "theory"),
            Number { reference: "truth", ..told("black_torque_error", "1") },
            told("black_left", "1"),
            count("black_holds_better", 0.0, "structure"),
        ],
        evaluate: Box::new(move |seed| {
            let truth = truth()?;
            let (mut torques, mut owns, mut tally) = ([Vec::new(), Vec::new()], Vec::new(), [0.0; 3]);
            for draw in DRAWS {
                let seed = seed.wrapping_add(draw);
                let samples = motions(noise, seed, "learn")?;
                let unseen = Motion { trajectories: 2, ..MOTION }.samples(&truth, seed, "held out").map_err(failed)?;
                let mut ends = Vec::new();
                for (place, model) in ["port-hamiltonian", "black box"].into_iter().enumerate() {
                    let fitted = fitted(model, chosen(model, noise), &samples)?;
                    torques[place].push(held_out(fitted.as_ref(), &unseen).map_err(failed)?);
                    let (seconds, change, own) = rollout(&truth, fitted.as_ref())?;
                    tally[place] += f64::from(u8::from(seconds < 1000.0));
                    if place == 0 {
                        owns.push(own);
                    }
                    ends.push((seconds, change));
                }
                let better = ends[1].0 > ends[0].0 || (ends[1].0 == ends[0].0 && ends[1].1 < ends[0].1);
                tally[2] += f64::from(u8::from(better));
            }
            let [structured, black] = torques.map(largest);
            Ok(vec![structured, largest(owns), tally[0], black, tally[1], tally[2]])
        }),
    }]
}

/// Numbers of a model: held-out torque, own energy, how long it stays, and the true energy at each time it reaches.
fn case(model: &'static str, noise: usize) -> Case {
    let structured = model != "black box";
    // The polynomials hold the arm's M and V to rounding of their fit; the net and the black box are as good as they are.
    let torque = match (model, noise) {
        ("truth", _) => error("truth_torque_error", "itself"),
        ("port-hamiltonian", 0) => error("torque_error", "truth"),
        _ => Number { reference: "truth", ..told("torque_error", "1") },
    };
    // A black box has no energy of its own to conserve.
    let own = structured.then(|| error("own_energy_drift", "conservation"));
    let stays = if structured { count("seconds", 1000.0, "theory") } else { told("seconds", "s") };
    let drift = |metric: &'static str| Number { reference: "truth", ..told(metric, "1") };
    Case {
        name: if noise == 0 { "arm, no noise".into() } else { format!("arm, noise {}", NOISE[noise]) },
        quantity: "learning",
        method: model.into(),
        params: json!({
            "noise": NOISE[noise], "ridge": chosen(model, noise).1, "amplitude": MOTION.amplitude, "frequency": MOTION.frequency,
            "harmonics": MOTION.harmonics, "trajectories": MOTION.trajectories, "samples": MOTION.samples, "hidden": NET.hidden,
            "degree": chosen(model, noise).0, "start": START, "step": STEP,
        }),
        numbers: [torque].into_iter().chain(own).chain([stays]).chain(DRIFTS.map(drift)).collect(),
        evaluate: Box::new(move |seed| {
            let truth = truth()?;
            let fitted = learned(model, noise, seed)?;
            let unseen = Motion { trajectories: 2, ..MOTION }.samples(&truth, seed, "held out").map_err(failed)?;
            let torque = held_out(fitted.as_ref(), &unseen).map_err(failed)?;
            let rollout = Rollout { start: START.to_vec(), step: STEP, times: TIMES.to_vec(), bound: std::f64::consts::PI };
            let (changes, escape) = rollout.run(&truth.model().topology, fitted.as_ref(), &truth).map_err(failed)?;
            let own = structured.then(|| largest(changes.iter().map(|(_, _, own)| own.unwrap_or(f64::NAN))));
            let seconds = escape.map_or(1000.0, |escape| escape.time);
            Ok([torque].into_iter().chain(own).chain([seconds]).chain(changes.iter().map(|(_, change, _)| change.abs())).collect())
        }),
    }
}
