//! Reading: do the engines read one file alike, and if not, where and why?
//!
//! Every engine reads the file with its own parser and says what it holds then ([`featherbench_bench::Subject::read`]). That description is compared,
//! body by body and whatever frames it is written in, with the reference reading: ours of URDF, that of MuJoCo's compiler of MJCF
//! ([`Comparison`]). Whether the differences found are all there are is then tested by replay: the engine computes with the robot it read,
//! our kernels with the robot it says to have read. Where both agree the description explains the engine's answers completely. Where they do
//! not, the row `unexplained` counts the smallest sub-trees that show it.

mod account;
mod align;
mod armature;
mod cause;
mod comparison;
mod context;
mod difference;
mod fields;
mod pairs;
mod replay;
mod rows;
mod subtree;

pub use comparison::{Comparison, Finding};
pub use difference::{Cause, Class, Difference, Field, Weight};
pub use replay::Effect;
pub use subtree::{SubTree, bound};

use featherbench_bench::{Cell, Context, FileFormat, Finished, Outcome, Problem, Quantity, Reading as Read, Refusal, Study, Subject};
use featherbench_results::Record;
use serde_json::{Value, json};

/// The reading study.
pub struct Reading;

/// The cells of an engine: what it reads, and what it then computes.
const READING: &str = "reading";
/// The method of a reading.
const PARSER: &str = "parser";
/// What is computed with the robot as read.
const COMPUTED: [Quantity; 2] = [Quantity::InverseDynamics, Quantity::MassMatrix];
/// Robots with more degrees of freedom are compared by what engines hold alone: whole mass matrices at all states would take gigabytes, several
/// times over (8 n² bytes a state; 18 MB here).
pub const LARGEST: usize = 1500;

impl Study for Reading {
    fn name(&self) -> &'static str {
        "reading"
    }

    fn plan(&self, context: &Context) -> Vec<Cell> {
        let mut cells = Vec::new();
        for problem in context.problems.iter().filter(|problem| problem.takes(self.name())) {
            let Some(params) = params(problem) else { continue };
            // Our own reading is the problem itself.
            for subject in context.subjects.iter().filter(|subject| subject.identity().name != "native") {
                let cell = |quantity: &str, method: String| Cell {
                    study: self.name().into(),
                    problem: problem.name.clone(),
                    problem_hash: problem.hash.clone(),
                    params: params.clone(),
                    subject: subject.identity().name.clone(),
                    version: subject.identity().version.clone(),
                    method,
                    quantity: quantity.into(),
                    scalar: "f64".into(),
                };
                cells.push(cell(READING, PARSER.into()));
                let usual = |quantity: Quantity| Some((quantity.name(), subject.methods(quantity).into_iter().next()?));
                let computed = COMPUTED.into_iter().filter(|_| problem.states.nv <= LARGEST);
                cells.extend(computed.filter_map(usual).map(|(quantity, method)| cell(quantity, method)));
            }
        }
        cells
    }

    fn evaluate(&self, context: &Context, cell: &Cell) -> Outcome {
        let lost = |what: &str| Outcome::Refused(Refusal::Failed(format!("there is no {what} of this cell")));
        let Some(problem) = context.problem(&cell.problem) else { return lost("problem") };
        let Some(subject) = context.subject(&cell.subject) else { return lost("subject") };
        let Some(file) = &problem.file else { return lost("file") };
        match (subject.read(file), Quantity::parse(&cell.quantity)) {
            (Err(refusal), _) => Outcome::Refused(refusal),
            (Ok(reading), None) => Outcome::Reading(Box::new(reading)),
            (Ok(reading), Some(quantity)) => computed(problem, &reading, subject, quantity, &cell.method).into(),
        }
    }

    fn compare(&self, context: &Context, problem: &Problem, finished: &[Finished]) -> Vec<Record> {
        rows::rows(context, problem, finished)
    }
}

/// What defines the work besides problem and subject.
fn params(problem: &Problem) -> Option<Value> {
    let file = problem.file.as_ref()?;
    Some(json!({"base": file.base.name(), "format": file.format.name(), "states": problem.states.count()}))
}

/// Whose reading is the reference of a file.
fn reference(format: FileFormat) -> &'static str {
    match format {
        FileFormat::Urdf => "native",
        FileFormat::Mjcf => "mujoco",
    }
}

/// The robot as an engine read it, at the states of our reading.
fn as_read(problem: &Problem, reading: &Read) -> Result<Problem, Refusal> {
    let states =
        |model: &featherbench_model::Model<f64>| replay::carried(&problem.description, &problem.states, &reading.description, model);
    problem.as_read(reading, states).map_err(|error| Refusal::Failed(error.to_string()))
}

fn computed(problem: &Problem, reading: &Read, subject: &dyn Subject, quantity: Quantity, method: &str) -> Result<Vec<f64>, Refusal> {
    let problem = as_read(problem, reading)?;
    let count = problem.states.count();
    let mut prepared = subject.prepare(&problem, quantity, method, &problem.states)?;
    prepared.run(0..count)?;
    let (values, due) = (prepared.read().to_vec(), count * quantity.size(&problem));
    if values.len() == due { Ok(values) } else { Err(Refusal::Failed(format!("{} numbers came, {due} are due", values.len()))) }
}
