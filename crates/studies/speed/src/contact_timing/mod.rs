//! Contact timing: how long do solvers take for the contacts of standing robots, at the same residual?
//!
//! The problems are those of `contact/standing.rs`: a robot lands and stands, and all its contacts are closed. All candidates are timed in
//! the paired experiment of the study `timing`, from impulses of zero, problem after problem. Each has the loosest tolerance, by powers of
//! ten, with which all its answers have a natural-map residual within [`TARGET`]. The residual is ours, whatever the solver's own measure is.
//!
//! An engine whose solver takes no G gets the robot, its points and the states. It answers by its own model of contact, so no tolerance makes
//! its residual small. Its tolerance is the loosest with which the velocities are within [`TARGET`] of the limit of its own model. Its rows say
//! so, and its ratios have a name of their own.
//!
//! | candidate | what its time includes |
//! |---|---|
//! | `block_gauss_seidel` | the sweeps; rows, blocks and their inverses were made before |
//! | `block_gauss_seidel_whole` | those too, from M and J |
//! | `newton` | everything from G and b, and the residuals of the answer |
//! | an engine's method | its call, by its own clock; G, b and memory were there before |
//! | … with its own model | its stage of contact forces: what it says itself |

mod candidates;
mod rows;
pub(crate) mod section;

use crate::timing::CORE;
use crate::timing::machine::Pinned;
use crate::timing::protocol::{Budget, Ready, experiment};
use crate::timing::samples::Samples;
use candidates::{Candidate, Landed, SOLVERS, Told};
use featherbench_answers::contact::standing::Stand;
use featherbench_bench::statistics::PROCESSES;
use featherbench_bench::{Asked, Cell, Context, Finished, NoAnswer, OWN, Outcome, Study};
use featherbench_results::Row;
use featherbench_robots::Random;
use featherbench_study::Entry;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::time::Instant;

/// The study of solution times.
pub struct ContactTiming {
    settings: Settings,
}

/// The table `[contact_timing]` of a suite.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Settings {
    /// Seconds for each candidate in each experiment, of all its processes together.
    seconds: f64,
    /// The engines that are timed beside ours if they are installed.
    #[serde(default)]
    engines: Vec<String>,
}

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "contact_timing",
    make: |setup| setup.made("contact_timing", |settings| ContactTiming { settings }),
    sections: section::sections,
    words: words::WORDS,
};

/// The study's name in rows.
const STUDY: &str = "contact_timing";
/// The quantity of its rows.
const QUANTITY: &str = "contact_impulses";
/// The largest natural-map residual of an answer that counts.
const TARGET: f64 = 1e-8;
/// The most contacts for Newton's method: it factorizes dense matrices, and needs a tenth of a second where there are four times as many.
const MOST_OF_NEWTON: usize = 16;
/// The cap on iterations of every solver.
const CAP: usize = 20_000;

impl ContactTiming {
    /// Our methods, the first twice, and those of the engines.
    fn candidates(&self, context: &Context, stand: Stand) -> Vec<Candidate> {
        let own = SOLVERS
            .iter()
            .filter(|method| **method != "newton" || stand.contacts() <= MOST_OF_NEWTON)
            .map(|method| Candidate::new(OWN, method, false));
        let control = Candidate::new(OWN, SOLVERS[0], true);
        let engines = self.settings.engines.iter().filter_map(|name| Some((name, context.engine(name)?.contact_solver()?)));
        let others = engines.flat_map(|(name, solver)| Candidate::all_of(name, solver));
        let version = |name: &str| context.engine(name).map(|engine| engine.identity().version.clone()).unwrap_or_default();
        own.chain([control]).chain(others).map(|candidate| Candidate { version: version(&candidate.engine), ..candidate }).collect()
    }

    /// The cells of an experiment: one for each of its processes.
    fn cells(&self, context: &Context, stand: Stand) -> Vec<Cell> {
        let Some(own) = context.engine(OWN) else { return Vec::new() };
        let identity = own.identity();
        let Settings { seconds, .. } = self.settings;
        let of_robot = OfRobot { contacts: stand.contacts(), rank: stand.rank(), seconds, own_model: None, drift: None };
        let candidates = self.candidates(context, stand);
        let of_process = |process| {
            let params = Params { of_robot: of_robot.clone(), seed: context.seed, target: TARGET, process, candidates: candidates.clone() };
            Cell::of_case(STUDY, &stand.name(), (&identity.name, &identity.version), QUANTITY, SOLVERS[0], params)
        };
        (0..PROCESSES).map(of_process).collect()
    }

    fn measured(&self, &Asked { context, cell, .. }: &Asked) -> Result<Measured, NoAnswer> {
        let lost = || NoAnswer::Failed("there is no robot of this cell".into());
        let stand = Stand::ALL.into_iter().find(|stand| stand.name() == cell.robot).ok_or_else(lost)?;
        let landed = Landed::of(stand, context.seed)?;
        let Params { candidates, .. } = cell.params()?;
        let chosen: Vec<_> = candidates.iter().map(|candidate| candidate.at_target(context, &landed)).collect();
        let _pinned = Pinned::to_one_core();
        let prepare = |which: usize| -> Ready { candidates[which].prepare(context, &landed, chosen[which].clone()?.tolerance) };
        let mut random = Random::named(context.seed, &cell.id());
        let start = Instant::now();
        let clock = || start.elapsed();
        let budget = Budget::of(self.settings.seconds / PROCESSES as f64);
        let samples = experiment(&prepare, candidates.len(), landed.problems.len(), budget, &clock, &CORE, &mut random);
        let told = chosen.into_iter().map(|chosen| chosen.unwrap_or(Told::NONE)).collect();
        Ok(Measured { problems: landed.problems.len() as f64, told, samples })
    }
}

/// The parameters of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Params {
    #[serde(flatten)]
    of_robot: OfRobot,
    seed: u64,
    target: f64,
    /// Which of the processes this is.
    process: usize,
    /// In the order of the samples.
    candidates: Vec<Candidate>,
}

/// Those of them that its rows have, and the settings of a method that answers by the engine's own model of contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct OfRobot {
    contacts: usize,
    rank: usize,
    seconds: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    own_model: Option<Value>,
    /// Of a time: the deviation by which the whole machine moves from run to run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    drift: Option<f64>,
}

/// The outcome of a cell.
struct Measured {
    /// How many problems there are.
    problems: f64,
    /// What is told of each candidate.
    told: Vec<Told>,
    samples: Samples,
}

impl Measured {
    fn to_values(&self) -> Vec<f64> {
        let told = self.told.iter().flat_map(|told| told.to_values());
        std::iter::once(self.problems).chain(told).chain(self.samples.to_values()).collect()
    }

    fn from_values(values: &[f64], candidates: usize) -> Option<Self> {
        let (&problems, rest) = values.split_first()?;
        let (told, samples) = rest.split_at_checked(3 * candidates)?;
        let told = told.chunks_exact(3).map(Told::from_values).collect();
        let samples = Samples::from_values(samples).filter(|samples| samples.calls.len() == candidates)?;
        Some(Self { problems, told, samples })
    }
}

impl Study for ContactTiming {
    fn name(&self) -> &'static str {
        STUDY
    }

    fn exclusive(&self) -> bool {
        true
    }

    fn measures_time(&self) -> bool {
        true
    }

    fn engines(&self) -> &[String] {
        &self.settings.engines
    }

    /// Contact problems are timed by the clocks of their solvers.
    fn needs_clocks(&self) -> bool {
        false
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        Stand::ALL.into_iter().flat_map(|stand| self.cells(context, stand)).collect()
    }

    fn process(&self, cell: &Cell) -> Option<usize> {
        cell.params::<Params>().ok().map(|params| params.process)
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        self.measured(asked).map(|measured| measured.to_values()).into()
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        finished.chunk_by(|(a, _), (b, _)| a.robot == b.robot).flat_map(|processes| rows::rows(context.gates, processes)).collect()
    }
}

#[cfg(test)]
mod tests;
pub(crate) mod words;
