//! Import: do the engines import one file alike, and if not, where and why do they differ?
//!
//! Every engine imports the file by its own parser and returns its robot ([`featherbench_bench::Engine::read`]). That description is
//! compared body by body with the reference import, whatever frames it is written in ([`Comparison`]). The reference is our import of URDF,
//! and that of [`FileFormat::reference`](featherbench_bench::FileFormat::reference) of other formats.
//!
//! A replay then tests whether all differences were found. The engine computes with the robot that it has imported, our kernels with the
//! robot that it reports. If both agree, the description explains the engine's answers completely. If not, the row `unexplained` counts the
//! smallest sub-trees that show the difference.

mod account;
mod align;
mod answers;
mod armature;
mod cause;
mod comparison;
mod context;
mod difference;
mod fields;
mod opening;
mod overflow;
mod pairs;
mod remedy;
mod replay;
mod rows;
pub(crate) mod section;
mod singular;
mod subtree;
mod variants;
pub(crate) mod words;

pub use answers::{Answer, Largest, Loads, answers, repairs};
pub use comparison::{Alone, Comparison, SingleDifference};
pub use difference::{Cause, Class, Difference, Field, Weight};
pub use fields::Precision;
pub use overflow::overflow;
pub use replay::Effect;
pub use singular::singular;
pub use subtree::{SubTree, bound};

use featherbench_bench::{
    Asked, Cell, Context, Engine, FileFormat, Finished, Import as Read, ImportVariant, NoAnswer, NoSettings, OWN, Outcome, Quantity, Robot,
    Study,
};
use featherbench_results::Row;
use featherbench_study::{Entry, Made, Setup, answer};
use serde_json::{Value, json};

/// The import study.
pub struct Import;

/// The study in the registry.
pub const ENTRY: Entry = Entry { name: "import", make: of_suite, sections: section::sections, words: words::WORDS };

/// The study, if the suite asks for it and the engines themselves are asked: what they read from files is not recorded.
fn of_suite(setup: &Setup) -> Made {
    Ok(setup.suite.settings::<NoSettings>("import")?.filter(|_| setup.live).map(|_| Box::new(Import) as _))
}

/// The cells of an engine: its import, and its answers afterwards.
const READING: &str = "import";
/// The cell of the engine that is the reference: what the file would be if one thing were read otherwise.
const VARIANTS: &str = "variants";
/// The method of an import.
const PARSER: &str = "parser";
/// Why an engine that holds no joint has no answer about the robot.
const NO_JOINT: &str = "it holds no joint: there is no M and no torque";
/// The quantities of an imported robot.
const COMPUTED: [Quantity; 2] = [Quantity::InverseDynamics, Quantity::MassMatrix];
/// Robots with more degrees of freedom are compared by their descriptions alone. Whole mass matrices at all states would take gigabytes,
/// several times over (8 n² bytes a state; 18 MB here).
pub const LARGEST: usize = 1500;

impl Study for Import {
    fn name(&self) -> &'static str {
        "import"
    }

    fn compares_all(&self) -> bool {
        false
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        for robot in context.robots.iter().filter(|robot| robot.takes(self.name())) {
            let (Some(params), Some(file)) = (params(robot), &robot.file) else { continue };
            // Our own import is the robot itself.
            let cell = |engine: &dyn Engine, quantity: &str, method: String| {
                Cell::new(self.name(), robot, engine.identity(), quantity, method, params.clone())
            };
            for engine in context.engines.iter().map(AsRef::as_ref).filter(|engine| engine.identity().name != OWN) {
                cells.push(cell(engine, READING, PARSER.into()));
                let usual = |quantity: Quantity| Some((quantity.name(), engine.methods(quantity).into_iter().next()?));
                let computed = COMPUTED.into_iter().filter(|_| robot.states.nv <= LARGEST);
                cells.extend(computed.filter_map(usual).map(|(quantity, method)| cell(engine, quantity, method)));
            }
            // The last one, as it asks whether the others differ.
            let compiler = context.engine(file.format.reference()).filter(|_| file.format == FileFormat::Mjcf);
            cells.extend(compiler.map(|engine| cell(engine, VARIANTS, PARSER.into())));
        }
        cells
    }

    fn evaluate(&self, asked: &Asked) -> Outcome {
        let answer = if asked.cell.quantity == VARIANTS { hypotheses(asked) } else { imported(asked) };
        answer.unwrap_or_else(Outcome::NoAnswer)
    }

    fn compare(&self, context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
        rows::rows(context, robot, finished)
    }
}

/// The other parameters of the work, besides robot and engine.
fn params(robot: &Robot) -> Option<Value> {
    let file = robot.file.as_ref()?;
    Some(json!({"base": file.base.name(), "format": file.format.name(), "states": robot.states.count()}))
}

/// The robot as an engine imported it, at the states of our import.
fn as_read(robot: &Robot, reading: &Read) -> Result<Robot, NoAnswer> {
    let states = |model: &featherbench_model::Model<f64>| replay::carried(&robot.description, &robot.states, &reading.description, model);
    robot.as_read(reading, states).map_err(|error| NoAnswer::Failed(error.to_string()))
}

/// The variants of the file as a text, if there is a difference that they may explain. They take longer than all imports.
fn hypotheses(asked: &Asked) -> Result<Outcome, NoAnswer> {
    let (robot, engine) = (asked.robot()?, asked.engine()?);
    let file = robot.file.as_ref().ok_or_else(|| NoAnswer::Failed("there is no file of this cell".into()))?;
    let open = |other: &dyn Engine| {
        let compared = |import: Read| Comparison::of(&robot.description, &import.description, &file.links, &import.notes);
        other.read(file).is_ok_and(|import| compared(import).is_of_dynamics())
    };
    let mut others = asked.context.engines.iter().filter(|other| other.identity().name != asked.cell.engine);
    let variants = if others.any(|other| open(other.as_ref())) { engine.variants(file)? } else { Vec::new() };
    ImportVariant::to_text(&variants).map(Outcome::Text).map_err(NoAnswer::Failed)
}

/// The engine's import as a text, or what it computes with it.
fn imported(asked: &Asked) -> Result<Outcome, NoAnswer> {
    let (robot, engine) = (asked.robot()?, asked.engine()?);
    let file = robot.file.as_ref().ok_or_else(|| NoAnswer::Failed("there is no file of this cell".into()))?;
    let reading = engine.read(file)?;
    match asked.quantity() {
        Ok(_) if reading.description.bodies.is_empty() => Err(NoAnswer::NotOffered(NO_JOINT.into())),
        Err(_) => reading.to_text().map(Outcome::Text).map_err(NoAnswer::Failed),
        Ok(quantity) => answer(engine, &as_read(robot, &reading)?, quantity, &asked.cell.method).map(Outcome::Values),
    }
}
