//! The rows of one robot: each engine's import, its differences, their effect, and whether they explain the engine's answers.

use super::replay::{Answers, Reference, Replay, carried, replay};
use super::subtree::{SubTree, unexplained};
use super::{Class, Comparison, Effect, LARGEST, Precision, READING, SingleDifference, VARIANTS, Weight, armature, as_read, bound, remedy};
use featherbench_bench::measure::worst;
use featherbench_bench::{Cell, Context, Finished, Import, ImportVariant, NoAnswer, OWN, Outcome, Quantity, Robot};
use featherbench_results::{Row, Verdict, canonical_json};
use featherbench_study::{row, unanswered};
use serde_json::{Value, json};
use std::collections::HashMap;

/// The rows of a robot, engine by engine.
pub(super) fn rows(context: &Context, robot: &Robot, finished: &[Finished]) -> Vec<Row> {
    let imports: Vec<(&Cell, Result<Import, NoAnswer>)> =
        finished.iter().filter(|(cell, _)| cell.quantity == READING).map(|(cell, outcome)| (cell, imported(outcome))).collect();
    let variants = finished.iter().find(|(cell, _)| cell.quantity == VARIANTS).map_or_else(Vec::new, |(_, outcome)| hypotheses(outcome));
    let mut rows = Vec::new();
    for (cell, import) in &imports {
        let of_engine: Vec<&Finished> =
            finished.iter().filter(|(other, _)| other.engine == cell.engine && ![READING, VARIANTS].contains(&&*other.quantity)).collect();
        let engine = OfEngine { context, robot, cell, of_engine, compiler: compiler(robot, &imports), variants: &variants };
        match import {
            Ok(import) => rows.extend(engine.read(import)),
            Err(no_answer) => rows.push(engine.refused(cell, no_answer)),
        }
    }
    rows
}

/// The import that an outcome holds.
fn imported(outcome: &Outcome) -> Result<Import, NoAnswer> {
    match outcome {
        Outcome::Text(text) => Import::from_text(text).map_err(NoAnswer::Failed),
        Outcome::NoAnswer(no_answer) => Err(no_answer.clone()),
        Outcome::Values(_) => Err(NoAnswer::Failed("the outcome is numbers, and a robot is due".into())),
    }
}

/// The variants that an outcome holds. Without them, differences have other causes or none.
fn hypotheses(outcome: &Outcome) -> Vec<ImportVariant> {
    match outcome {
        Outcome::Text(text) => ImportVariant::from_text(text).unwrap_or_default(),
        Outcome::NoAnswer(_) | Outcome::Values(_) => Vec::new(),
    }
}

/// The causes of notes about an engine that holds what no description can.
const UNSOUND: [&str; 2] = ["not_a_rotation", "not_a_mass"];

/// The number of mass-matrix entries computed for the effects of single differences: some ten seconds. A robot of a hundred dofs and six
/// states has the effect of each of 60 000 differences, one of a thousand dofs that of the first 600. The others have none.
const WORK: usize = 4_000_000_000;
/// The number of differences with an effect, however large the robot is.
const LEAST_ALONE: usize = 8;

/// The import of the reference, if that is an engine's.
fn compiler<'a>(robot: &Robot, imports: &'a [(&Cell, Result<Import, NoAnswer>)]) -> Option<&'a Import> {
    let file = robot.file.as_ref()?;
    let (_, import) = imports.iter().find(|(cell, _)| cell.engine == file.format.reference())?;
    import.as_ref().ok()
}

struct OfEngine<'a> {
    context: &'a Context<'a>,
    robot: &'a Robot,
    /// The cell of its import.
    cell: &'a Cell,
    /// Its answers about the imported robot.
    of_engine: Vec<&'a Finished>,
    compiler: Option<&'a Import>,
    variants: &'a [ImportVariant],
}

impl OfEngine<'_> {
    fn reference(&self) -> &'static str {
        self.robot.file.as_ref().map_or(OWN, |file| file.format.reference())
    }

    fn precision(&self) -> Precision {
        Precision::of(&self.cell.scalar)
    }

    fn row(&self, cell: &Cell, metric: &str) -> Row {
        Row { states: "all".into(), metric: metric.into(), unit: "1".into(), reference: self.reference().into(), ..row(cell, self.robot) }
    }

    /// The cell's parameters, with more that a reader of the row needs.
    fn params(&self, more: Value) -> String {
        let mut params = self.cell.params.clone();
        if let (Value::Object(params), Value::Object(more)) = (&mut params, more) {
            params.extend(more);
        }
        canonical_json(&params)
    }

    fn refused(&self, cell: &Cell, no_answer: &NoAnswer) -> Row {
        self.context.gates.explain(unanswered(self.row(cell, "differences"), no_answer, Verdict::Skip))
    }

    fn read(&self, reading: &Import) -> Vec<Row> {
        let links = self.robot.file.as_ref().map_or(&[][..], |file| &file.links);
        let (ours, theirs) = (&self.robot.description, &reading.description);
        let comparison = Comparison::rounded(ours, theirs, links, &reading.notes, self.precision());
        // The variants are those of the file as MuJoCo accepts it, so they are no hypotheses about itself.
        let asked = comparison.is_of_dynamics() && self.compiler.is_some_and(|import| import != reading);
        let mut comparison = comparison.explained_by(ours, theirs, if asked { self.variants } else { &[] }, &reading.notes);
        let beside = |import: &Import| armature::beside_descriptions(&import.notes, &reading.notes);
        comparison.findings.extend(self.compiler.into_iter().flat_map(beside));
        let own = alterable(&comparison, self.robot);
        let states = &self.robot.states;
        let afforded = (WORK / (states.count() * states.nv * states.nv).max(1)).max(LEAST_ALONE);
        let alone = |(k, finding): (usize, &SingleDifference)| {
            let alone = finding.alone.as_ref().filter(|_| k < afforded);
            alone.zip(own.as_ref()).and_then(|(alone, own)| own.effect_of(&alone.of(&comparison.ours)))
        };
        let effects: Vec<Option<Effect>> = comparison.findings.iter().enumerate().map(alone).collect();
        let classes: Vec<Class> =
            comparison.findings.iter().zip(&effects).map(|(finding, effect)| self.class(finding, effect.as_ref())).collect();
        let remedy = remedy::tried(ours, theirs, &comparison, &classes, self.robot);
        let mut rows = vec![self.count(&comparison, &classes, remedy, reading)];
        let joints: HashMap<&str, &str> =
            comparison.ours.bodies.iter().map(|body| (body.name.as_str(), body.joint.name.as_str())).collect();
        rows.extend(
            comparison
                .findings
                .iter()
                .zip(&effects)
                .map(|(finding, effect)| self.difference(finding, joints.get(finding.difference.body.as_str()).copied(), effect.as_ref())),
        );
        let answers: Vec<(&Cell, Result<&[f64], &NoAnswer>)> =
            self.of_engine.iter().map(|(cell, outcome)| (cell, values(outcome))).collect();
        for (cell, answer) in &answers {
            if let Err(no_answer) = answer {
                rows.push(self.refused(cell, no_answer));
            }
        }
        let find = |quantity: Quantity| {
            let cell = answers.iter().find(|(cell, _)| cell.quantity == quantity.name());
            cell.and_then(|(cell, answer)| Some((*cell, answer.ok()?.to_vec())))
        };
        if let (Some((id_cell, id)), Some((mass_cell, mass_matrix))) = (find(Quantity::InverseDynamics), find(Quantity::MassMatrix)) {
            rows.extend(self.computed(reading, [id_cell, mass_cell], &Answers { id, mass_matrix }));
        }
        rows
    }

    fn class(&self, finding: &SingleDifference, effect: Option<&Effect>) -> Class {
        let largest = effect.map(|effect| worst(effect.id, effect.mass_matrix));
        Class::of(finding.difference.field, finding.difference.size, largest, self.robot.depth, self.precision())
    }

    /// The number of differences that affect a simulation, and the number of each class.
    fn count(&self, comparison: &Comparison, classes: &[Class], remedy: Option<String>, reading: &Import) -> Row {
        let of = |weight: Weight| comparison.differences().filter(|difference| difference.field.weight() == weight).count();
        let notes: Vec<Value> = reading
            .notes
            .iter()
            .map(|note| json!({"cause": note.cause, "about": note.about, "text": note.text, "numbers": note.numbers}))
            .collect();
        let class = |class: Class| classes.iter().filter(|found| **found == class).count();
        let (felt, told) = (of(Weight::Dynamics) + of(Weight::Carried), of(Weight::Information));
        let more = json!({
            "dynamics": of(Weight::Dynamics), "carried": of(Weight::Carried), "information": told, "notes": notes,
            "refuted": comparison.refuted, "remedy": remedy,
            "physics": class(Class::Physics), "pose": class(Class::Pose), "unfelt": class(Class::Unfelt), "rounding": class(Class::Rounding), "not_read": class(Class::NotRead),
        });
        Row { params: self.params(more), ..self.row(self.cell, "differences") }.informed(felt as f64)
    }

    /// A difference at a body, with the joint that moves it.
    fn difference(&self, finding: &SingleDifference, joint: Option<&str>, alone: Option<&Effect>) -> Row {
        let difference = &finding.difference;
        let number = |of: fn(&Effect) -> f64| alone.map(of).filter(|error| error.is_finite());
        let more = json!({
            "cause": difference.cause.name(),
            "class": self.class(finding, alone).name(),
            "joint": joint,
            "ours": difference.ours,
            "theirs": difference.theirs,
            "weight": difference.field.weight().name(),
            "account": difference.account,
            "note": difference.note,
            "id": number(|effect| effect.id),
            "mass_matrix": number(|effect| effect.mass_matrix),
        });
        let row = Row {
            body: difference.body.clone(),
            states: String::new(),
            quantity: difference.field.name().into(),
            params: self.params(more),
            ..self.row(self.cell, "difference")
        };
        row.informed(difference.size)
    }

    /// The engine's answers against the reference and against the replay, and the part that the replay does not explain.
    fn computed(&self, reading: &Import, [id, mass]: [&Cell; 2], engine: &Answers) -> Vec<Row> {
        let error = |reason: &str| vec![self.row(self.cell, "unexplained").without_value(Verdict::Error, reason)];
        let robot = match as_read(self.robot, reading) {
            Ok(robot) => robot,
            Err(no_answer) => return error(&no_answer.to_string()),
        };
        // Joints that only they have are at rest on their side; so they must be on ours.
        let states = carried(&robot.description, &robot.states, &self.robot.description, &self.robot.model);
        let Some(reference) = Reference::new(&self.robot.description, states) else {
            return error("our kernels have no answer on the reference reading");
        };
        let Some(replayed) = replay(&robot, engine) else {
            return error("the engine's answers have another shape than the robot it read");
        };
        let read = reference.effect(&robot.description, robot.states.nv, engine);
        let mut rows = Vec::new();
        for (metric, effect) in [("as_read", read), ("replayed", replayed.effect)] {
            rows.push(self.row(id, metric).informed(effect.id));
            rows.push(self.row(mass, metric).informed(effect.mass_matrix));
        }
        // Our kernels cannot compute with a matrix that is no rotation: nothing is replayed.
        if !reading.notes.iter().any(|note| UNSOUND.contains(&note.cause.as_str())) {
            rows.push(self.unexplained(&robot, &replayed));
        }
        rows
    }

    fn unexplained(&self, robot: &Robot, replayed: &Replay) -> Row {
        let trees = unexplained(&robot.description, replayed, self.precision());
        let tree = |tree: &SubTree| {
            let bodies: Vec<&str> = tree.robot.bodies.iter().map(|body| body.name.as_str()).collect();
            let error = if tree.error.is_finite() { json!(tree.error) } else { json!(tree.error.to_string()) };
            json!({"quantity": tree.quantity, "error": error, "bodies": bodies})
        };
        let trees: Vec<Value> = trees.iter().map(tree).collect();
        let count = trees.len() as f64;
        let row = Row {
            params: self.params(json!({"unexplained": trees, "gate": bound(robot.depth, self.precision())})),
            ..self.row(self.cell, "unexplained")
        };
        self.context.gates.judge(row, count, 1.0)
    }
}

fn values(outcome: &Outcome) -> Result<&[f64], &NoAnswer> {
    match outcome {
        Outcome::Values(values) => Ok(values),
        Outcome::NoAnswer(no_answer) => Err(no_answer),
        Outcome::Text(_) => Ok(&[]),
    }
}

/// Our robot without the bodies that theirs lacks, with its answers.
fn alterable(comparison: &Comparison, robot: &Robot) -> Option<Reference> {
    if robot.states.nv > LARGEST {
        return None;
    }
    let model = featherbench_model::Model::build(&comparison.ours).ok()?;
    let states = carried(&robot.description, &robot.states, &comparison.ours, &model);
    Reference::new(&comparison.ours, states)
}
