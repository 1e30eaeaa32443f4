//! Loops: how right are engines' accelerations and motions of robots with loops, and what do they cost?
//!
//! Every engine gets the same descriptions with `loops`, and holds them by its own means:
//!
//! - Pinocchio: rigid constraints with a proximal solver,
//! - MuJoCo: soft equality constraints,
//! - Drake: almost rigid ones,
//! - DART: impulses of a step.
//!
//! The settings that an answer depends on are in its rows. The states that come back are judged here alone:
//!
//! | quantity | metric | against |
//! |---|---|---|
//! | `loop_acceleration` | `error`: the largest of 20 states, over \|a*\| + \|v\|² | the closed form, or double-double arithmetic |
//! | `loop_singular` | `error` at angles beside the flat parallelogram | the closed form |
//! | `loop_motion` | `error`: of the positions at the end | the closed form, or the limit of our steps |
//! | | `energy_drift`, `open`: the largest over the motion | zero |
//! | | `of_steps`, `energy_of_steps`: to the same steps of the closed form alone (ours) | zero |
//! | all | `ns_per_state`, `ns_per_step`: the engine's own clock | – |
//!
//! - `systems.rs`: robots, states, motions and what is known of them;
//! - `ours.rs`: our methods; `drive.rs`: springs and constant forces;
//! - `ask.rs`: what a cell asks, and how the answer is judged;
//! - `rows.rs`, `section.rs`: rows and report.

mod ask;
mod drive;
mod ours;
mod rows;
pub(crate) mod section;
mod systems;
#[cfg(test)]
mod tests;
pub(crate) mod words;

use ask::{Asked, Truths};
use featherbench_bench::{Cell, Context, Engine, Finished, NoAnswer, OWN, Outcome, Study, hash};
use featherbench_results::{Row, canonical_json};
use featherbench_study::{Entry, Made, Setup};
use serde::Deserialize;
use serde_json::json;

/// The study's name in rows.
const STUDY: &str = "loops";

/// The table `[loops]` of a suite.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Settings {
    /// The engines that are asked beside ours if they are installed.
    #[serde(default)]
    engines: Vec<String>,
    /// The longest row of parallelograms.
    #[serde(default = "longest")]
    windows: usize,
}

fn longest() -> usize {
    40
}

/// The study.
struct Loops {
    settings: Settings,
    truths: Truths,
}

/// The study in the registry.
pub const ENTRY: Entry = Entry { name: "loops", make: of_suite, sections: section::sections, words: words::WORDS };

/// The study, if the suite asks for it.
fn of_suite(setup: &Setup) -> Made {
    let settings = setup.suite.settings::<Settings>(STUDY)?;
    Ok(settings.map(|settings| Box::new(Loops { settings, truths: Truths::default() }) as _))
}

impl Loops {
    /// What is asked of every engine.
    fn asked(&self) -> impl Iterator<Item = Asked> {
        Asked::all().into_iter().filter(|asked| asked.windows() <= self.settings.windows)
    }

    /// The engines that hold loops, ours first, with a method of each for such a question.
    fn candidates<'a>(&'a self, context: &'a Context, asked: &Asked) -> Vec<(&'a dyn Engine, String)> {
        let own =
            context.engine(OWN).into_iter().flat_map(|own| ours::methods(asked).iter().map(move |method| (own, (*method).to_owned())));
        let named = self.settings.engines.iter().filter_map(|name| context.engine(name));
        let others = named.filter_map(|engine| Some((engine, engine.loop_solver()?))).flat_map(|(engine, solver)| {
            let methods = if asked.moves() { solver.motion_methods() } else { solver.acceleration_methods() };
            methods.into_iter().map(move |method| (engine, method))
        });
        own.chain(others).collect()
    }
}

impl Study for Loops {
    fn name(&self) -> &'static str {
        STUDY
    }

    /// Its rows have times.
    fn exclusive(&self) -> bool {
        true
    }

    fn engines(&self) -> &[String] {
        &self.settings.engines
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        for asked in self.asked() {
            for (engine, method) in self.candidates(context, &asked) {
                let identity = engine.identity();
                let params = json!({"asked": asked.params(), "seed": context.seed});
                cells.push(Cell {
                    study: STUDY.into(),
                    robot: asked.label(),
                    robot_hash: hash::of(canonical_json(&params).as_bytes()),
                    params,
                    engine: identity.name.clone(),
                    version: identity.version.clone(),
                    method,
                    quantity: asked.quantity().into(),
                    scalar: "f64".into(),
                });
            }
        }
        cells
    }

    fn evaluate(&self, context: &Context, cell: &Cell) -> Outcome {
        let lost = || NoAnswer::Failed("there is no question or engine of this cell".into());
        let asked = Asked::all().into_iter().find(|asked| asked.label() == cell.robot && asked.quantity() == cell.quantity);
        let answer = asked.ok_or_else(lost).and_then(|asked| {
            if cell.engine == OWN {
                return asked.answer(&self.truths, &ours::Ours, &cell.method, context.seed);
            }
            let solver = context.engine(&cell.engine).and_then(|engine| engine.loop_solver()).ok_or_else(lost)?;
            asked.answer(&self.truths, solver, &cell.method, context.seed)
        });
        match answer {
            Ok(answer) => Outcome::Text(answer),
            Err(no_answer) => Outcome::NoAnswer(no_answer),
        }
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        finished.iter().flat_map(|(cell, outcome)| rows::rows(context.gates, cell, outcome)).collect()
    }
}
