//! USD that we write, and what OpenUSD and Newton read from it.

use super::alone;
use crate::Outcome;
use featherbench_bench::{Engine, FileBase, FileContent, FileFormat, RobotFile};
use featherbench_comparison::import::{Comparison, Difference, Field, Precision};
use featherbench_engines::Oracle;
use featherbench_formats::{OnLoss, usd};
use featherbench_model::{Description, JointType};
use featherbench_robots::Family;

/// Robots of the joints that USD has, of many shapes and seeds.
fn robots() -> Vec<Description> {
    let joints = ["revolute", "prismatic", "spherical", "mixed"].map(|kind| format!("joints:kind={kind},base=fixed,armature=false"));
    let trees = (1..6).map(|seed| format!("tree:n=9,seed={seed},spread=0.4"));
    let others =
        ["chain:n=7,layout=spatial", "humanoid", "quadruped", "hand", "joints:kind=revolute,base=free,armature=false"].map(String::from);
    let words: Vec<String> = joints.into_iter().chain(trees).chain(others).collect();
    let robots = words.iter().filter_map(|words| Family::parse(words).ok()?.generate().ok());
    let held = |robot: &Description| robot.bodies.iter().all(|body| has(body.joint.kind));
    robots.filter(held).collect()
}

fn has(kind: JointType) -> bool {
    matches!(kind, JointType::Revolute { .. } | JointType::Prismatic { .. } | JointType::Spherical | JointType::Free)
}

/// The file, and what was left out, as it is told. The same path is written again and again.
fn written(robot: &Description, folder: &std::path::Path) -> (RobotFile, String) {
    let path = folder.join("robot.usda");
    let losses = usd::write(robot, &path, OnLoss::LeaveOut).unwrap();
    let told: Vec<String> = losses.iter().map(ToString::to_string).collect();
    (FileContent::read(&path, FileFormat::Usd).unwrap().file(FileBase::Fixed).unwrap(), told.join("\n"))
}

/// What is read back is the robot, in single precision.
pub fn read_back() -> Outcome {
    alone::with("openusd", |engine: &Oracle| {
        let folder = tempfile::tempdir().unwrap();
        let robots = robots();
        assert!(robots.len() >= 8, "{}", robots.len());
        for robot in robots {
            let ours = robot.canonical().unwrap();
            let (file, told) = written(&robot, folder.path());
            let read = engine.read(&file).unwrap();
            let found = Comparison::rounded(&ours, &read.description, &[], &read.notes, Precision::Single);
            // Of a ball whose three numbers differ the writer says that it keeps the first, and that a free joint has no placement.
            let untold = |difference: &&Difference| match difference.field {
                Field::Damping => !told.contains("damping"),
                Field::Friction => !told.contains("friction"),
                Field::Placement => !told.contains("a free joint whose coordinates are not") || difference.body != ours.bodies[0].name,
                _ => true,
            };
            let differences: Vec<_> = found.differences().filter(untold).collect();
            assert!(differences.is_empty(), "{}: {differences:#?}", robot.name);
        }
    })
}

/// Newton reads its joints from a USD with the same answers as it has through its interface: those of the robot, in single precision.
pub fn newton_reads_it() -> Outcome {
    alone::with("newton", |engine: &Oracle| {
        let folder = tempfile::tempdir().unwrap();
        for words in ["joints:kind=revolute,base=fixed,armature=false", "chain:n=7,layout=spatial", "tree:n=9,seed=3,spread=0.4"] {
            let robot = Family::parse(words).unwrap().generate().unwrap();
            let ours = robot.canonical().unwrap();
            let read = engine.read(&written(&robot, folder.path()).0).unwrap();
            let found = Comparison::rounded(&ours, &read.description, &[], &read.notes, Precision::Single);
            let felt: Vec<_> = found
                .differences()
                .filter(|difference| difference.field.weight() == featherbench_comparison::import::Weight::Dynamics)
                .collect();
            assert!(felt.is_empty(), "{words}: {felt:#?}");
        }
    })
}
