//! Three learned models of an arm: torques of motions that they have not seen, and the energy of 1000 s without forces.
//!
//! Each learns from the same motions, with and without noise on the torques. The motion without forces begins at rest, at angles within those that were
//! learned. Its energies are the true one, by the true model at the states of the learned motion, and the model's own.

use super::{Case, Number, arm, count, error, failed, largest, told};
use featherbench_bench::NoAnswer;
use featherbench_learning::{BlackBox, Degrees, Dynamics, Lagrangian, Motion, Net, PortHamiltonian, Rollout, Truth, held_out};
use featherbench_model::Model;
use serde_json::json;

/// What is learned from. Another seed's stream of two trajectories is held out, without noise.
const MOTION: Motion = Motion { amplitude: 0.8, frequency: 0.8, harmonics: 5, trajectories: 4, samples: 150, noise: 0.0 };
const NET: Net = Net { hidden: 12, epsilon: 1e-3, seed: 1, patience: 3 };
/// The degree of M and V without and with noise: fewer coefficients average over more of it.
const DEGREES: [usize; 2] = [6, 3];
/// The total degree of the black box, in six variables.
const BLACK: usize = 4;
/// λ of ridge regressions, without and with noise.
const RIDGE: [f64; 2] = [1e-13, 1e-5];
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
    (0..NOISE.len()).flat_map(of).collect()
}

fn truth() -> Result<Truth, NoAnswer> {
    Truth::new(Model::build(&arm(1.0).describe()).map_err(failed)?).map_err(failed)
}

/// The model that learned from motions with this noise.
fn learned(model: &str, noise: usize, seed: u64) -> Result<Box<dyn Dynamics>, NoAnswer> {
    let truth = truth()?;
    let samples = Motion { noise: NOISE[noise], ..MOTION }.samples(&truth, seed, "learn").map_err(failed)?;
    Ok(match model {
        "truth" => Box::new(truth),
        "lagrangian net" => Box::new(Lagrangian::fit(&samples, NET).map_err(failed)?.0),
        "port-hamiltonian" => {
            let fitted = PortHamiltonian::fit(&samples, Degrees { total: DEGREES[noise], damping: false }, RIDGE[noise]).map_err(failed)?;
            let smallest = fitted.smallest_mass(&samples);
            if smallest.is_nan() || smallest <= 0.0 {
                return Err(NoAnswer::Failed(format!("the mass matrix has the eigenvalue {smallest:e} at a sample")));
            }
            Box::new(fitted)
        }
        _ => Box::new(BlackBox::fit(&samples, BLACK, RIDGE[noise]).map_err(failed)?),
    })
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
    // M ≻ 0 is by form in the net alone: with noise the polynomials may lose it, and then there is no acceleration.
    let positive = structured && (model, noise) != ("port-hamiltonian", 1);
    let stays = if positive { count("seconds", 1000.0, "theory") } else { told("seconds", "s") };
    let drift = |metric: &'static str| Number { reference: "truth", ..told(metric, "1") };
    Case {
        name: if noise == 0 { "arm, no noise".into() } else { format!("arm, noise {}", NOISE[noise]) },
        quantity: "learning",
        method: model.into(),
        params: json!({
            "noise": NOISE[noise], "ridge": RIDGE[noise], "amplitude": MOTION.amplitude, "frequency": MOTION.frequency,
            "harmonics": MOTION.harmonics, "trajectories": MOTION.trajectories, "samples": MOTION.samples, "hidden": NET.hidden,
            "degree": DEGREES[noise], "black_degree": BLACK, "start": START, "step": STEP,
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
