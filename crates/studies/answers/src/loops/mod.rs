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

use ask::{OfCell, Question, Truths};
use featherbench_bench::{Asked, Cell, Context, Engine, Finished, LoopSolver, NoAnswer, OWN, Outcome, Study};
use featherbench_results::Row;
use featherbench_study::Entry;
use serde::Deserialize;

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
pub const ENTRY: Entry = Entry {
    name: "loops",
    make: |setup| setup.made(STUDY, |settings| Loops { settings, truths: Truths::default() }),
    sections: section::sections,
    words: words::WORDS,
};

impl Loops {
    /// What is asked of every engine.
    fn questions(&self) -> impl Iterator<Item = Question> {
        Question::all().into_iter().filter(|question| question.windows() <= self.settings.windows)
    }

    /// The engines that hold loops, ours first, with a method of each for such a question.
    fn candidates<'a>(&'a self, context: &'a Context, question: &Question) -> Vec<(&'a dyn Engine, String)> {
        let own =
            context.engine(OWN).into_iter().flat_map(|own| ours::methods(question).iter().map(move |method| (own, (*method).to_owned())));
        let named = self.settings.engines.iter().filter_map(|name| context.engine(name));
        let others = named.filter_map(|engine| Some((engine, engine.loop_solver()?))).flat_map(|(engine, solver)| {
            let methods = if question.moves() { solver.motion_methods() } else { solver.acceleration_methods() };
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
        for question in self.questions() {
            for (engine, method) in self.candidates(context, &question) {
                let identity = engine.identity();
                let params = OfCell { asked: question.params(), seed: context.seed };
                let engine = (identity.name.as_str(), identity.version.as_str());
                cells.push(Cell::of_case(STUDY, &question.label(), engine, question.quantity(), method, params));
            }
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        let cell = asked.cell;
        let question = Question::all().into_iter().find(|question| question.label() == cell.robot && question.quantity() == cell.quantity);
        let answer = question.ok_or_else(|| NoAnswer::Failed("there is no question of this cell".into())).and_then(|question| {
            let solver: &dyn LoopSolver = if cell.engine == OWN { &ours::Ours } else { asked.offered(|engine| engine.loop_solver())? };
            question.answer(&self.truths, solver, &cell.method, asked.context.seed)
        });
        answer.into()
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        finished.iter().flat_map(|(cell, outcome)| rows::rows(context.gates, cell, outcome)).collect()
    }
}
