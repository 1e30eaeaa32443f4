//! The import study fails an engine that computes with another robot than it reports: it is called unexplained, with the smallest sub-tree
//! that shows it. An engine that reports its edits correctly does not fail.

use crate::share::one_of;
use featherbench_bench::{
    Engine, Evaluation, FileBase, FileFormat, Identity, Import as Read, ImportNote, NoAnswer, Quantity, Robot, RobotFile,
};
use featherbench_comparison::Import;
use featherbench_doubles::{gates, robot, whole};
use featherbench_engines::Featherbench;
use featherbench_model::{Description, Model};
use featherbench_results::{EngineSource, Row, Verdict};
use featherbench_robots::{Random, StateBatch};
use serde_json::Value;
use std::collections::BTreeMap;

/// An engine with a parser: it reports one robot and computes with another of the same shape.
struct Parser {
    identity: Identity,
    featherbench: Featherbench,
    says: Result<Read, NoAnswer>,
    holds: Option<Robot>,
}

impl Parser {
    fn new(says: Description, holds: &Description, robot: &Robot) -> Self {
        let mut held = robot.clone();
        held.description = holds.canonical().unwrap();
        held.model = Model::build(&held.description).unwrap();
        let note = ImportNote { cause: "warning".into(), about: None, text: "something".into(), numbers: Vec::new() };
        Self {
            says: Ok(Read { description: says.canonical().unwrap(), notes: vec![note], keyframes: Vec::new(), written: None }),
            holds: Some(held),
            ..Self::refusing("")
        }
    }

    fn refusing(reason: &str) -> Self {
        let identity = Identity { name: "parser".into(), version: "1".into(), source: EngineSource::Own, build: BTreeMap::new() };
        Self { identity, featherbench: Featherbench::new(), says: Err(NoAnswer::Failed(reason.into())), holds: None }
    }
}

impl Engine for Parser {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        self.featherbench.methods(quantity)
    }

    fn read(&self, _: &RobotFile) -> Result<Read, NoAnswer> {
        self.says.clone()
    }

    fn prepare<'a>(
        &'a self,
        _: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        let holds = self.holds.as_ref().ok_or_else(|| NoAnswer::Failed("nothing was read".into()))?;
        self.featherbench.prepare(holds, quantity, method, states)
    }
}

/// A robot with a file.
fn filed(spec: &str) -> Robot {
    let file = RobotFile {
        path: "robot.urdf".into(),
        format: FileFormat::Urdf,
        base: FileBase::Fixed,
        hash: "0".into(),
        links: Vec::new(),
        features: Vec::new(),
    };
    robot(spec).from_file(file)
}

fn records(robot: &Robot, parser: Parser) -> Vec<Row> {
    whole(&Import, robot, &gates(""), &[Box::new(Featherbench::new()), Box::new(parser)])
}

fn row<'a>(records: &'a [Row], metric: &str, quantity: &str) -> &'a Row {
    records.iter().find(|row| row.metric == metric && row.quantity == quantity).unwrap_or_else(|| panic!("no {metric} of {quantity}"))
}

fn params(row: &Row) -> Value {
    serde_json::from_str(&row.params).unwrap()
}

#[test]
fn a_robot_read_as_it_is_has_no_differences_and_is_explained() {
    let robot = filed("humanoid");
    let records = records(&robot, Parser::new(robot.description.clone(), &robot.description, &robot));
    assert_eq!(row(&records, "differences", "import").value, Some(0.0));
    assert_eq!((row(&records, "unexplained", "import").value, row(&records, "unexplained", "import").verdict), (Some(0.0), Verdict::Pass));
    for (metric, quantity) in [("as_read", "id"), ("as_read", "mass_matrix"), ("replayed", "id"), ("replayed", "mass_matrix")] {
        assert_eq!(row(&records, metric, quantity).value, Some(0.0), "{metric} {quantity}");
    }
    assert!(records.iter().all(|row| row.metric != "difference"));
}

#[test]
fn an_edited_robot_that_is_told_is_a_difference_and_explained() {
    let robot = filed("humanoid");
    let mut edited = robot.description.clone();
    let body = edited.bodies.len() - 1;
    edited.bodies[body].mass *= 2.0;
    let records = records(&robot, Parser::new(edited.clone(), &edited, &robot));
    let difference = row(&records, "difference", "mass");
    assert_eq!(difference.body, edited.bodies[body].name);
    assert_eq!(difference.value, Some(0.5), "half of the larger mass");
    assert_eq!(row(&records, "differences", "import").value, Some(1.0));
    assert_eq!(row(&records, "unexplained", "import").verdict, Verdict::Pass);
    // The only difference causes the whole error.
    let as_read = row(&records, "as_read", "mass_matrix").value.unwrap();
    let alone = params(difference)["mass_matrix"].as_f64().unwrap();
    assert!(as_read > 1e-6 && (as_read - alone).abs() < 1e-12 * as_read, "{as_read} {alone}");
}

#[test]
fn an_engine_that_lies_about_what_it_read_is_unexplained_from_the_body_on() {
    for spec in ["humanoid", "quadruped", "tree:n=20,joints=all,base=fixed"] {
        let robot = filed(spec);
        let bodies = &robot.description.bodies;
        for body in (0..bodies.len()).step_by(3) {
            let mut held = robot.description.clone();
            held.bodies[body].mass += 1.0;
            held.bodies[body].inertia = held.bodies[body].inertia.map(|x| 2.0 * x);
            let records = records(&robot, Parser::new(robot.description.clone(), &held, &robot));
            assert_eq!(row(&records, "differences", "import").value, Some(0.0), "it says that it read the same");
            let left = row(&records, "unexplained", "import");
            assert_eq!(left.verdict, Verdict::Fail, "{spec}: {}", bodies[body].name);
            let trees = params(left)["unexplained"].as_array().unwrap().clone();
            let roots: Vec<&str> = trees.iter().map(|tree| tree["bodies"][0].as_str().unwrap()).collect();
            assert_eq!(roots, [bodies[body].name.as_str()], "{spec}");
        }
    }
}

#[test]
fn gravity_that_is_not_told_is_unexplained_by_torques_alone() {
    let robot = filed("humanoid");
    let mut held = robot.description.clone();
    held.gravity = [0.0, 0.0, -1.0];
    let records = records(&robot, Parser::new(robot.description.clone(), &held, &robot));
    let left = row(&records, "unexplained", "import");
    assert_eq!(left.verdict, Verdict::Fail);
    assert!(params(left)["unexplained"].as_array().unwrap().iter().all(|tree| tree["quantity"] == "id"));
    assert!(row(&records, "replayed", "mass_matrix").value.unwrap() == 0.0);
}

#[test]
fn a_body_less_is_compared_on_what_is_left() {
    let robot = filed("quadruped");
    let mut fewer = robot.description.clone();
    let leaf = fewer.bodies.len() - 1;
    let joint = &mut fewer.bodies[leaf].joint;
    *joint = featherbench_model::JointDescription { name: joint.name.clone(), placement: joint.placement, ..Default::default() };
    let fewer = fewer.canonical().unwrap();
    let mut parser = Parser::new(fewer.clone(), &fewer, &robot);
    // Its states are those of the smaller robot.
    parser.holds.as_mut().unwrap().depth = fewer.depth();
    let records = records(&robot, parser);
    let difference = row(&records, "difference", "body");
    assert_eq!(params(difference)["cause"], "merged");
    assert_eq!(row(&records, "unexplained", "import").verdict, Verdict::Pass);
    let error = row(&records, "as_read", "mass_matrix").value.unwrap();
    assert!(error < 1e-12, "the joint stands still on both sides: {error}");
}

/// A robot that stands elsewhere has the same M and τ, and is not the same robot.
#[test]
fn a_displaced_robot_is_never_called_rounding() {
    let robots = ["humanoid", "quadruped"].map(filed);
    let mut random = Random::new(44, 3);
    for decade in (0..16 / one_of(16)).flat_map(|_| 0..=12) {
        let robot = &robots[random.below(robots.len())];
        let root = robot.description.bodies.iter().position(|body| body.parent.is_none()).unwrap();
        let mut moved = robot.description.clone();
        let by = 10.0_f64.powi(-decade) * random.uniform(1.0, 3.0);
        let direction: [f64; 3] = random.direction();
        let translation = &mut moved.bodies[root].joint.placement.translation;
        *translation = std::array::from_fn(|k| translation[k] + by * direction[k]);
        let records = records(robot, Parser::new(moved.clone(), &moved, robot));
        let difference = row(&records, "difference", "placement");
        assert_eq!(params(difference)["class"], "pose", "{by} m: {difference:?}");
        assert_eq!(params(row(&records, "differences", "import"))["pose"], 1);
    }
}

/// Advice is given only if the robot with it has the reference's M and τ.
#[test]
fn advice_that_does_not_help_is_not_given() {
    let robot = filed("quadruped");
    let mut random = Random::new(44, 4);
    for _ in (0..200).step_by(one_of(25)) {
        let mut edited = robot.description.clone();
        let bodies = edited.bodies.len();
        let mut names = Vec::new();
        for _ in 0..1 + random.below(3) {
            let body = &mut edited.bodies[random.below(bodies)];
            body.mass *= random.uniform(1.1, 2.0);
            names.push(body.name.clone());
        }
        let records_of = records(&robot, Parser::new(edited.clone(), &edited, &robot));
        let remedy = params(row(&records_of, "differences", "import"))["remedy"].as_str().unwrap().to_owned();
        assert!(names.iter().all(|name| remedy.contains(&format!("'{name}'"))), "{names:?}: {remedy}");
        // Where a body is lost, nothing that can be set helps.
        let leaf = bodies - 1;
        let joint = &mut edited.bodies[leaf].joint;
        *joint = featherbench_model::JointDescription { name: joint.name.clone(), placement: joint.placement, ..Default::default() };
        let fewer = edited.canonical().unwrap();
        let mut parser = Parser::new(fewer.clone(), &fewer, &robot);
        parser.holds.as_mut().unwrap().depth = fewer.depth();
        let records = records(&robot, parser);
        assert!(params(row(&records, "differences", "import"))["remedy"].is_null());
    }
}

/// An engine that holds no joint has read the file: all bodies are lost in it, and it is asked nothing more.
#[test]
fn an_engine_that_loads_an_empty_robot_does_not_refuse() {
    let robot = filed("quadruped");
    let mut parser = Parser::refusing("");
    let empty = Description { bodies: Vec::new(), frames: Vec::new(), ..robot.description.clone() };
    parser.says = Ok(Read { description: empty, notes: Vec::new(), keyframes: Vec::new(), written: None });
    let records = records(&robot, parser);
    let read = row(&records, "differences", "import");
    assert_eq!(read.value, Some(robot.description.bodies.len() as f64));
    let bodies = records.iter().filter(|row| row.metric == "difference" && row.quantity == "body");
    assert!(bodies.clone().count() == robot.description.bodies.len() && bodies.into_iter().all(|row| params(row)["cause"] == "dropped"));
    assert!(records.iter().all(|row| row.verdict != Verdict::Error), "{records:#?}");
}

#[test]
fn a_refusal_is_a_row_with_its_reason() {
    let robot = filed("hand");
    let records = records(&robot, Parser::refusing("line 3: no"));
    assert_eq!(records.len(), 1);
    assert_eq!((records[0].verdict, records[0].reason.as_str()), (Verdict::Error, "line 3: no"));
}

#[test]
fn a_robot_without_a_file_is_not_asked_about() {
    let robot = robot("hand");
    let parser = Parser::new(robot.description.clone(), &robot.description, &robot);
    assert!(records(&robot, parser).is_empty());
}
