//! Scenes: what do engines make of bodies in contact whose motion is known?
//!
//! The scenes are those of `featherbench_scenes::systems`. Each engine moves them by each of its variants, a contact model with a solver, at
//! several steps. Of each number of a motion there is its error against rigid mechanics at each step, and the bias: what a line through the
//! values at all steps leaves at dt = 0. Errors of other engines inform. A *law* is what an engine's own contact model should do where that
//! is known (friction pyramids, creep); it is judged.
//!
//! - `movers.rs`: who moves scenes: our step with our solvers, our step with an engine's solver of contact problems, an engine;
//! - `bounce.rs`: derivatives of a bounce by each engine against the exact one;
//! - `rows.rs`: rows;
//! - `drawing.rs`: a side view of a scene with its cones and forces.

mod bounce;
pub(crate) mod drawing;
mod movers;
mod rows;
pub(crate) mod section;
#[cfg(test)]
mod tests;
pub(crate) mod words;

use featherbench_bench::{Asked, Cell, Context, Engine, Finished, Identity, NoAnswer, Outcome, Study};
use featherbench_results::Row;
use featherbench_scenes::{Question, systems};
use featherbench_study::Entry;
use movers::Mover;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// The study's name in rows.
const STUDY: &str = "scenes";
/// The quantities of its cells: motions, and the derivative of a bounce.
const MOTION: &str = "scene_motion";
const BOUNCE: &str = "bounce_derivative";
/// The method and the scene of the one cell of an engine that is not there.
const NONE: &str = "none";
const EVERY: &str = "all scenes";

/// The study of scenes.
pub(crate) struct Scenes {
    settings: Settings,
    questions: Vec<Question>,
}

/// The table `[scenes]` of a suite.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Settings {
    /// The engines that are asked beside ours if they are installed.
    #[serde(default)]
    engines: Vec<String>,
}

/// The study in the registry.
pub const ENTRY: Entry = Entry {
    name: "scenes",
    make: |setup| setup.made(STUDY, |settings| Scenes { settings, questions: systems::all() }),
    sections: section::sections,
    words: words::WORDS,
};

impl Scenes {
    fn question(&self, cell: &Cell) -> Option<&Question> {
        self.questions.iter().find(|question| question.scene.name == cell.robot)
    }

    /// Every measure of the motion at each step.
    fn moved(&self, asked: &Asked) -> Result<Vec<f64>, NoAnswer> {
        let lost = || NoAnswer::Failed("there is no scene of this cell".into());
        let (question, engine) = (self.question(asked.cell).ok_or_else(lost)?, asked.engine()?);
        let Moved { mover, .. } = asked.cell.params()?;
        let mut values = Vec::new();
        for &dt in &question.dts {
            let motion = mover.simulate(engine, question, &asked.cell.method, dt)?;
            values.extend(question.measures.iter().map(|measure| measure.of(&motion)));
        }
        Ok(values)
    }
}

/// The parameters of a motion.
#[derive(Serialize, Deserialize)]
struct Moved {
    scene: Value,
    settings: Map<String, Value>,
    steps: Vec<f64>,
    mover: Mover,
}

/// An engine's name and version.
fn of_engine(identity: &Identity) -> (&str, &str) {
    (&identity.name, &identity.version)
}

/// A cell that belongs to no robot.
fn cell(scene: &str, engine: (&str, &str), method: &str, quantity: &str, params: Value) -> Cell {
    Cell::of_case(STUDY, scene, engine, quantity, method, params)
}

impl Study for Scenes {
    fn name(&self) -> &'static str {
        STUDY
    }

    fn engines(&self) -> &[String] {
        &self.settings.engines
    }

    fn asks(&self, _: &dyn Engine) -> bool {
        true
    }

    /// One cell for each engine that is asked and is not there, or moves no scenes: so a row says so.
    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        for name in &self.settings.engines {
            let engine = context.engine(name);
            if engine.is_none_or(|engine| movers::of(engine).is_empty()) {
                let version = engine.map(|engine| engine.identity().version.clone()).unwrap_or_default();
                cells.push(cell(EVERY, (name, &version), NONE, MOTION, json!({"settings": {}})));
            }
        }
        for engine in context.engines {
            let identity = engine.identity();
            for (mover, variant) in movers::of(engine.as_ref()) {
                for question in &self.questions {
                    let scene = json!({"parameters": question.params, "duration": question.duration, "scene": question.scene});
                    let params = Moved { scene, settings: variant.settings.clone(), steps: question.dts.to_vec(), mover };
                    cells.push(cell(&question.scene.name, of_engine(identity), &variant.name, MOTION, json!(params)));
                }
            }
        }
        cells.extend(bounce::plan(context));
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        let cell = asked.cell;
        if cell.quantity == BOUNCE {
            return bounce::evaluate(asked).into();
        }
        if cell.method == NONE {
            let hint = format!("{0} is not installed, or moves no scenes: `featherbench oracles install {0}`", cell.engine);
            return Outcome::NoAnswer(NoAnswer::NotOffered(hint));
        }
        self.moved(asked).into()
    }

    fn compare_all(&self, context: &Context, finished: &[Finished]) -> Vec<Row> {
        let of = |(cell, outcome): &Finished| match self.question(cell) {
            Some(question) if cell.quantity == MOTION => rows::of_motion(context.gates, question, cell, outcome),
            _ if cell.method == NONE => rows::of_absent(cell, outcome),
            _ => bounce::rows(context.gates, cell, outcome),
        };
        finished.iter().flat_map(of).collect()
    }
}
