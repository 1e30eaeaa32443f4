//! What a cell asks, and how the answer is judged.

use super::drive::Driven;
use super::ours::Ours;
use super::systems::{ACCELERATED, NEAR, PLANS, Plan, System, errors, scalar};
use featherbench_bench::{LoopMotion, LoopSolver, LoopSteps, NoAnswer};
use featherbench_constrained::{Mechanism, Rows};
use featherbench_dynamics::energy;
use featherbench_model::difference;
use featherbench_spatial::smaller;
use featherbench_study::known::{failed, largest};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::sync::OnceLock;

/// Rounds over the states of which the time is told.
const REPEATS: usize = 5;
/// The step of a row's closed form, s: its own error is some 10⁻¹³.
const FINE: f64 = 1e-4;

/// A question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Question {
    /// Accelerations at states on the loops.
    Accelerations(System),
    /// Accelerations beside the flat parallelogram.
    Singular,
    /// A motion by steps of a length: its index in [`PLANS`], and that of the length.
    Motion(usize, usize),
}

/// Positions at the ends of the motions, once they were asked for.
#[derive(Default)]
pub(super) struct Truths([OnceLock<Result<Vec<f64>, NoAnswer>>; PLANS.len()]);

/// An answer, judged. JSON knows no NaN: a number that is none is absent.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Judged {
    /// Of accelerations the largest, of those beside a singularity one for each angle, of a motion that at its end.
    pub errors: Vec<Option<f64>>,
    /// Of a motion: the largest change of the energy, J.
    #[serde(default)]
    pub energy_drift: Option<f64>,
    /// Of a motion: the largest |φ|, m or rad.
    #[serde(default)]
    pub open: Option<f64>,
    /// Of our motion of a row: how far it is from the same steps of the closed form, rad.
    #[serde(default)]
    pub of_steps: Option<f64>,
    /// Of our motion of a row: the largest difference of its energy from that of the same steps of the closed form, J.
    #[serde(default)]
    pub energy_of_steps: Option<f64>,
    /// Of one state or step, ns.
    pub nanoseconds: f64,
    /// What the engine told.
    pub settings: Value,
}

/// The parameters of a question, in a cell and in its rows.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Params {
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dt: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub powers: Option<Vec<i32>>,
    /// Of a row: what the engine told.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settings: Option<Value>,
    /// Of a row: the angle beside the flat parallelogram.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beside: Option<f64>,
}

/// The parameters of a cell.
#[derive(Serialize, Deserialize)]
pub(super) struct OfCell {
    pub asked: Params,
    pub seed: u64,
}

impl Question {
    /// All questions, in the order of the report.
    pub fn all() -> Vec<Self> {
        let accelerations = ACCELERATED.into_iter().map(Self::Accelerations);
        let motions = PLANS.iter().enumerate().flat_map(|(plan, of)| (0..of.steps.len()).map(move |step| Self::Motion(plan, step)));
        accelerations.chain([Self::Singular]).chain(motions).collect()
    }

    /// Whether it is about a motion.
    pub fn moves(&self) -> bool {
        matches!(self, Self::Motion(..))
    }

    /// Its robot.
    pub fn system(&self) -> System {
        match self {
            Self::Accelerations(system) => *system,
            Self::Singular => System::Windows(1),
            Self::Motion(plan, _) => PLANS[*plan].system,
        }
    }

    /// How many parallelograms its robot has; zero of another robot.
    pub fn windows(&self) -> usize {
        if let System::Windows(windows) = self.system() { windows } else { 0 }
    }

    /// The name of what is asked about.
    pub fn name(&self) -> String {
        match self {
            Self::Accelerations(system) => system.name(),
            Self::Singular => "four-bar beside its singularity".into(),
            Self::Motion(plan, _) => PLANS[*plan].name.into(),
        }
    }

    /// The name of a cell: with the length of a step, which differs between cells of a motion.
    pub fn label(&self) -> String {
        match self {
            Self::Motion(plan, step) => format!("{} at {} s", self.name(), PLANS[*plan].steps[*step]),
            _ => self.name(),
        }
    }

    /// The quantity of its rows.
    pub fn quantity(&self) -> &'static str {
        match self {
            Self::Accelerations(_) => "loop_acceleration",
            Self::Singular => "loop_singular",
            Self::Motion(..) => "loop_motion",
        }
    }

    /// As parameters.
    pub fn params(&self) -> Params {
        let params = Params { name: self.name(), ..Params::default() };
        match self {
            Self::Motion(plan, step) => {
                let Plan { seconds, start, steps, .. } = PLANS[*plan];
                let (angle, rate, dt) = (Some(start.0), Some(start.1), Some(steps[*step]));
                Params { seconds: Some(seconds), angle, rate, dt, ..params }
            }
            Self::Singular => Params { powers: Some(NEAR.collect()), ..params },
            Self::Accelerations(_) => params,
        }
    }

    /// Asks an engine, and judges its answer. The result is the JSON of a [`Judged`].
    pub fn answer(&self, truths: &Truths, solver: &dyn LoopSolver, method: &str, seed: u64) -> Result<String, NoAnswer> {
        let (description, mechanism) = (self.system().description()?, self.system().mechanism()?);
        let judged = match *self {
            Self::Motion(plan, step) => {
                let (q, v) = PLANS[plan].begin(&mechanism, seed)?;
                let steps = PLANS[plan].of(PLANS[plan].steps[step]);
                let motion = solver.loop_motion(&description, self.system().drive().as_ref(), method, (&q, &v), steps)?;
                let due = truths.of(plan, &mechanism, seed)?;
                judge(&PLANS[plan], &mechanism, (&q, &v), steps, &motion, &due)?
            }
            Self::Accelerations(_) | Self::Singular => {
                let singular = *self == Self::Singular;
                let states = if singular { System::nearby() } else { self.system().states(&mechanism, seed)? };
                let due = self.system().due(&mechanism, &states)?;
                let found = solver.loop_accelerations(&description, method, &states, REPEATS)?;
                let errors = errors(&states, &found.acceleration, &due);
                let errors = if singular { errors } else { vec![largest(errors)] };
                let calls = (REPEATS * states.count) as f64;
                let nanoseconds = found.time.as_nanos() as f64 / calls;
                Judged { errors: errors.into_iter().map(finite).collect(), nanoseconds, settings: found.settings, ..Judged::default() }
            }
        };
        serde_json::to_string(&judged).map_err(failed)
    }
}

fn finite(number: f64) -> Option<f64> {
    Some(number).filter(|number| number.is_finite())
}

impl Truths {
    /// Where a motion ends.
    fn of(&self, plan: usize, mechanism: &Mechanism, seed: u64) -> Result<Vec<f64>, NoAnswer> {
        self.0[plan].get_or_init(|| end(&PLANS[plan], mechanism, seed)).clone()
    }
}

/// Where a motion ends: the closed form by fine steps, or Richardson's limit of two of ours, both shorter than those that are asked for.
fn end(plan: &Plan, mechanism: &Mechanism, seed: u64) -> Result<Vec<f64>, NoAnswer> {
    if let Some(ladder) = plan.system.ladder() {
        let (angle, _) = scalar(&ladder, plan.start, FINE, (plan.seconds / FINE).round() as usize);
        return Ok(ladder.spread(angle));
    }
    let shortest = plan.steps.iter().copied().fold(f64::INFINITY, smaller);
    let (q, v) = plan.begin(mechanism, seed)?;
    let description = plan.system.description()?;
    let run = |dt: f64| -> Result<Vec<f64>, NoAnswer> {
        let steps = (plan.seconds / dt).round() as usize;
        let (drive, steps) = (plan.system.drive(), LoopSteps { dt, steps, every: steps });
        Ok(Ours.loop_motion(&description, drive.as_ref(), "rk4_kkt_projection", (&q, &v), steps)?.q)
    };
    let (coarse, fine) = (run(shortest / 2.0)?, run(shortest / 4.0)?);
    // The error of order four falls to a sixteenth.
    let step = difference(&mechanism.model.topology, &coarse, &fine).map_err(failed)?;
    let share: Vec<f64> = step.iter().map(|x| x / 15.0).collect();
    featherbench_model::integrate(&mechanism.model.topology, &fine, &share).map_err(failed)
}

/// The errors of a motion, from its states alone.
fn judge(
    plan: &Plan,
    mechanism: &Mechanism,
    (q, v): (&[f64], &[f64]),
    steps: LoopSteps,
    motion: &LoopMotion,
    due: &[f64],
) -> Result<Judged, NoAnswer> {
    let (model, constraints) = (&mechanism.model, &mechanism.constraints);
    let nanoseconds = motion.time.as_nanos() as f64 / steps.steps as f64;
    let mut judged = Judged { errors: vec![None], nanoseconds, settings: motion.settings.clone(), ..Judged::default() };
    if motion.q.iter().chain(&motion.v).any(|number| !number.is_finite()) {
        // It has left all bounds: there is nothing to measure.
        return Ok(judged);
    }
    let drive = plan.system.drive();
    let driven = drive.as_ref().map(|drive| Driven { drive, model });
    let total = |q: &[f64], v: &[f64]| -> Result<f64, NoAnswer> {
        let energies = energy(model, q, v).map_err(failed)?;
        let stored = driven.as_ref().map_or(Ok(0.0), |driven| driven.potential(q))?;
        Ok(energies.kinetic + energies.potential + stored)
    };
    let first = total(q, v)?;
    let (mut drift, mut open, mut rows) = (0.0, 0.0, Rows::<f64>::new(constraints));
    for (q, v) in motion.q.chunks_exact(q.len()).zip(motion.v.chunks_exact(v.len())) {
        drift = largest([drift, total(q, v)? - first]);
        rows.run(model, constraints, q, v).map_err(failed)?;
        open = largest([open, largest(rows.residuals())]);
    }
    let end = motion.q.chunks_exact(q.len()).next_back().unwrap_or(q);
    let apart =
        |a: &[f64], b: &[f64]| -> Result<Option<f64>, NoAnswer> { Ok(finite(largest(difference(&model.topology, a, b).map_err(failed)?))) };
    judged.errors = vec![apart(due, end)?];
    (judged.energy_drift, judged.open) = (finite(drift), finite(open));
    if let Some(ladder) = plan.system.ladder() {
        let mut state = plan.start;
        let mut missed = 0.0;
        for (q, v) in motion.q.chunks_exact(q.len()).zip(motion.v.chunks_exact(v.len())) {
            state = scalar(&ladder, state, steps.dt, steps.every);
            missed =
                largest([missed, (total(q, v)? - first) - (ladder.energy(state.0, state.1) - ladder.energy(plan.start.0, plan.start.1))]);
        }
        judged.of_steps = apart(&ladder.spread(state.0), end)?;
        judged.energy_of_steps = finite(missed);
    }
    Ok(judged)
}
