//! Files that we write, imported by the engines' own parsers.

use crate::support::project;
use crate::{Outcome, Unpassed};
use featherbench_bench::measure::worst;
use featherbench_formats::{ExportError, OnLoss, mjcf, neutral, urdf};
use featherbench_model::{Description, JointType};
use featherbench_protocol::{Block, Limits, Message, Process};
use serde_json::{Value, json};
use std::path::Path;

/// An oracle to which the test writes messages itself.
struct Oracle(Process);

impl Oracle {
    fn start(python: &Path, engine: &str) -> Self {
        Self(Process::start(&crate::oracle_command(python, engine), Limits::default()).unwrap())
    }

    /// The answer, or the reason why there is none.
    fn ask(&mut self, question: Value, blocks: Vec<Block>) -> Result<Message, String> {
        let answer = self.0.ask(&Message::new(question, blocks)).unwrap();
        if answer.text("status") == "ok" { Ok(answer) } else { Err(answer.text("reason").to_owned()) }
    }

    /// The import result of a file.
    fn read(&mut self, path: &Path, format: &str) -> Result<Description, String> {
        let answer = self.ask(json!({"op": "import", "file": path, "format": format, "base": "fixed"}), Vec::new())?;
        let read = neutral::parse(&answer.header["model"].to_string(), "as read").unwrap_or_else(|error| panic!("{error}"));
        Ok(read.canonical().unwrap_or_else(|error| panic!("{error}")))
    }

    /// The mass matrix and the inverse dynamics at a state of the oracle's robot. Each dof's numbers depend on its name alone.
    fn dynamics(&mut self, robot: &Description) -> [Vec<f64>; 2] {
        let (nq, nv, bodies) = (robot.nq(), robot.nv(), robot.bodies.len());
        let mut blocks = vec![Block::new("q", &[1, nq], &coordinates(robot))];
        for (k, name) in ["v", "a", "tau"].into_iter().enumerate() {
            blocks.push(Block::new(name, &[1, nv], &rates(robot, k as f64)));
        }
        blocks.push(Block::new("wrench", &[1, bodies, 6], &vec![0.0; 6 * bodies]));
        blocks.push(Block::new("probe", &[4, nv], &vec![0.0; 4 * nv]));
        self.ask(json!({"op": "states", "count": 1}), blocks).unwrap_or_else(|reason| panic!("{}: {reason}", robot.name));
        let hello = self.ask(json!({"op": "hello"}), Vec::new()).unwrap();
        ["mass_matrix", "id"].map(|quantity| {
            let method = &hello.header["methods"][quantity][0];
            let question = json!({"op": "evaluate", "quantity": quantity, "method": method, "first": 0, "count": 1});
            let answer = self.ask(question, Vec::new()).unwrap_or_else(|reason| panic!("{}: {quantity}: {reason}", robot.name));
            answer.block("value").unwrap().data.clone()
        })
    }
}

/// A number in (−1, 1) that depends on a name.
fn drawn(name: &str, salt: f64) -> f64 {
    let sum = name.bytes().fold(salt, |sum, byte| (sum * 31.0 + f64::from(byte)) % 1009.0);
    (sum * 12.9898).sin()
}

fn coordinates(robot: &Description) -> Vec<f64> {
    let of = |joint: &featherbench_model::JointDescription| match joint.kind {
        JointType::Free => vec![0.1, -0.2, 0.3, 0.5, -0.5, 0.5, 0.5],
        _ => vec![drawn(&joint.name, 0.5); joint.kind.nq()],
    };
    robot.bodies.iter().flat_map(|body| of(&body.joint)).collect()
}

fn rates(robot: &Description, salt: f64) -> Vec<f64> {
    let of = |joint: &featherbench_model::JointDescription| {
        let name = if joint.kind == JointType::Free { "free" } else { &joint.name };
        (0..joint.kind.nv()).map(|k| drawn(name, salt + 0.1 * k as f64)).collect::<Vec<_>>()
    };
    robot.bodies.iter().flat_map(|body| of(&body.joint)).collect()
}

/// The committed robots.
fn robots() -> Vec<Description> {
    let files = std::fs::read_dir(project().join("datasets/models")).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = files.filter(|path| path.extension().is_some_and(|ending| ending == "json")).collect();
    files.sort();
    files.iter().map(|path| neutral::read(path).unwrap_or_else(|error| panic!("{error}"))).collect()
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, worst)
}

/// Neutral → MJCF → MuJoCo's import: scalars and vectors to the bit, rotations and inertias within 8ε; a second round trip changes nothing.
pub fn mjcf_round_trip(python: &Path) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("robot.xml");
    let mut mujoco = Oracle::start(python, "mujoco");
    let mut trip = |robot: &Description| -> Result<Description, String> {
        mjcf::write(robot, &path, OnLoss::LeaveOut).map_err(|error: ExportError| error.to_string())?;
        mujoco.read(&path, "mjcf")
    };
    let (mut met, mut refused) = (0, Vec::new());
    for robot in robots() {
        let once = match trip(&robot) {
            Ok(once) => once,
            Err(reason) => {
                refused.push(format!("{}: {reason}", robot.name));
                continue;
            }
        };
        assert_same_robot(&robot, &once);
        assert_eq!(trip(&once).as_ref(), Ok(&once), "{}: a second trip", robot.name);
        met += 1;
    }
    let unexpected = refused.iter().find(|reason| !reason.contains("helical joint"));
    if let Some(reason) = unexpected {
        return Err(Unpassed::Failed(reason.clone()));
    }
    assert!(met >= 55, "{met} robots made the trip");
    Ok(())
}

/// Asserts that an import result is the robot, where a joint in several parts is a chain of massless bodies.
fn assert_same_robot(robot: &Description, read: &Description) {
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    assert_eq!((robot.nv(), robot.gravity), (read.nv(), read.gravity), "{}", robot.name);
    for body in &robot.bodies {
        let what = format!("{}, {}", robot.name, body.name);
        let found = read.bodies.iter().find(|found| found.name == body.name).unwrap_or_else(|| panic!("{what} is missing"));
        assert_eq!((body.mass, body.com), (found.mass, found.com), "{what}");
        let size = body.inertia.iter().map(|x| x.abs()).fold(0.0, worst);
        assert!(far(&body.inertia, &found.inertia) <= ROUNDING * size, "{what}: {:?} {:?}", body.inertia, found.inertia);
        let mut row = vec![found];
        while row.iter().map(|body| body.joint.kind.nv()).sum::<usize>() < body.joint.kind.nv() {
            row.insert(0, &read.bodies[row[0].parent.unwrap()]);
        }
        let (first, joint) = (&row[0].joint, &body.joint);
        if joint.kind != JointType::Free {
            assert_eq!(joint.placement.translation, first.placement.translation, "{what}");
            assert!(far(&joint.placement.rotation, &first.placement.rotation) <= ROUNDING, "{what}");
        }
        if joint.kind.nv() == 1 {
            assert_eq!((&joint.name, joint.kind), (&first.name, first.kind), "{what}");
            let limits = [(&joint.lower, &first.lower), (&joint.upper, &first.upper), (&joint.effort, &first.effort)];
            assert!(limits.iter().all(|(given, read)| given == read || given.contains(&0.0)), "{what}: {limits:?}");
            let numbers = [(&joint.armature, &first.armature), (&joint.damping, &first.damping), (&joint.friction, &first.friction)];
            let value = |list: &[f64]| list.first().copied().unwrap_or(0.0);
            assert!(numbers.iter().all(|(given, read)| value(given) == value(read)), "{what}: {numbers:?}");
        }
    }
}

/// The robots that Pinocchio, MuJoCo and Drake import from our URDF move like those that they build from the description.
pub fn urdf_read_alike(python: &Path) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("robot.urdf");
    for engine in ["pinocchio", "mujoco", "drake"] {
        let mut oracle = Oracle::start(python, engine);
        let mut compared = 0;
        for robot in robots().into_iter().filter(|robot| robot.provenance.is_some()) {
            let (text, _) = urdf::to_string(&robot, OnLoss::Refuse).unwrap_or_else(|error| panic!("{error}"));
            std::fs::write(&path, &text).unwrap();
            let (ours, _) = urdf::import(&text, "written", &urdf::Options::default()).unwrap_or_else(|error| panic!("{error}"));
            let model: Value = serde_json::from_str(&neutral::to_line(&ours).unwrap()).unwrap();
            // MuJoCo refuses some inertias in both ways.
            if oracle.ask(json!({"op": "prepare", "model": model}), Vec::new()).is_err() {
                continue;
            }
            let built = oracle.dynamics(&ours);
            let theirs = oracle.read(&path, "urdf").unwrap_or_else(|reason| panic!("{engine}, {}: {reason}", robot.name));
            let read = oracle.dynamics(&theirs);
            let order = dofs(&theirs, &ours);
            let n = ours.nv();
            assert_eq!((order.len(), theirs.nv()), (n, n), "{engine}, {}", robot.name);
            let mass: Vec<f64> = order.iter().flat_map(|&i| order.iter().map(move |&j| (i, j))).map(|(i, j)| read[0][i * n + j]).collect();
            let torques: Vec<f64> = order.iter().map(|&i| read[1][i]).collect();
            for (quantity, read, built) in [("M", &mass, &built[0]), ("ID", &torques, &built[1])] {
                // Rotations imported from angles differ by an ulp or two on each of up to twenty joints.
                let error = far(read, built) / built.iter().map(|x| x.abs()).fold(0.0, worst);
                assert!(error <= 1e-13, "{engine}, {}: {quantity} differs by {error:e}", robot.name);
            }
            compared += 1;
        }
        assert!(compared >= 10, "{engine} compared {compared} robots");
    }
    Ok(())
}

/// For each dof of `ours`, its place in `theirs`: joints by their names. The free joint is an exception, as engines name it differently.
fn dofs(theirs: &Description, ours: &Description) -> Vec<usize> {
    let named =
        |joint: &featherbench_model::JointDescription| if joint.kind == JointType::Free { "free".to_owned() } else { joint.name.clone() };
    let mut starts = std::collections::HashMap::new();
    let mut next = 0;
    for body in &theirs.bodies {
        starts.insert(named(&body.joint), next);
        next += body.joint.kind.nv();
    }
    let start = |joint| *starts.get(&named(joint)).unwrap_or_else(|| panic!("{}: no joint '{}' was read", ours.name, joint.name));
    ours.bodies.iter().flat_map(|body| (0..body.joint.kind.nv()).map(|k| start(&body.joint) + k).collect::<Vec<_>>()).collect()
}
