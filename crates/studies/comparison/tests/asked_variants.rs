//! Variants of a file are asked for if an engine differs in what enters the dynamics, and only then.

use featherbench_bench::{
    Engine, Evaluation, FileBase, FileFormat, Identity, Import as Read, ImportVariant, NoAnswer, Quantity, Robot, RobotFile,
};
use featherbench_comparison::Import;
use featherbench_doubles::{gates, robot, whole};
use featherbench_model::Description;
use featherbench_results::EngineSource;
use featherbench_robots::{Random, StateBatch};
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const CAUSE: &str = "gravity_ignored";

/// An engine that reads files and computes nothing.
struct Reader {
    identity: Identity,
    reads: Description,
    variants: Vec<ImportVariant>,
    asked: Arc<AtomicUsize>,
}

impl Reader {
    fn boxed(name: &str, reads: &Description, variants: Vec<ImportVariant>, asked: &Arc<AtomicUsize>) -> Box<dyn Engine> {
        let identity = Identity { name: name.into(), version: "1".into(), source: EngineSource::Own, build: BTreeMap::new() };
        Box::new(Self { identity, reads: reads.clone(), variants, asked: Arc::clone(asked) })
    }
}

impl Engine for Reader {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, _: Quantity) -> Vec<String> {
        Vec::new()
    }

    fn read(&self, _: &RobotFile) -> Result<Read, NoAnswer> {
        Ok(Read { description: self.reads.clone(), notes: Vec::new(), keyframes: Vec::new(), written: None })
    }

    fn variants(&self, _: &RobotFile) -> Result<Vec<ImportVariant>, NoAnswer> {
        self.asked.fetch_add(1, Ordering::Relaxed);
        Ok(self.variants.clone())
    }

    fn prepare<'a>(&'a self, _: &'a Robot, _: Quantity, _: &str, _: &'a StateBatch) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        Err(NoAnswer::NotOffered("it reads files".into()))
    }
}

/// 200 robots of two engines: one reads them as they are, with other damping, or with other gravity. The last alone enters the dynamics.
#[test]
fn variants_are_asked_for_if_the_dynamics_differ() {
    let file = RobotFile {
        path: "robot.xml".into(),
        format: FileFormat::Mjcf,
        base: FileBase::Fixed,
        hash: "0".into(),
        links: Vec::new(),
        features: Vec::new(),
    };
    let robot = robot("quadruped").from_file(file);
    let mut random = Random::named(44, "asked variants");
    let mut seen = [0; 3];
    for k in 0..200 {
        let (mut other, case) = (robot.description.clone(), random.below(3));
        seen[case] += 1;
        match case {
            1 => {
                let moving = other.bodies.iter_mut().filter(|body| body.joint.kind.nv() == 1);
                moving.for_each(|body| body.joint.damping = vec![random.uniform(1.0, 2.0)]);
            }
            2 => other.gravity = [random.uniform(0.1, 1.0), 0.0, -9.81],
            _ => {}
        }
        let variant = ImportVariant { cause: CAUSE.into(), text: "the gravity is another".into(), edits: 1, description: other.clone() };
        let asked = Arc::new(AtomicUsize::new(0));
        let none = Arc::new(AtomicUsize::new(0));
        let engines =
            [Reader::boxed("parser", &other, Vec::new(), &none), Reader::boxed("mujoco", &robot.description, vec![variant], &asked)];
        let rows = whole(&Import, &robot, &gates(""), &engines);
        assert_eq!(asked.load(Ordering::Relaxed), usize::from(case == 2), "{k}: case {case}");
        assert_eq!(none.load(Ordering::Relaxed), 0, "{k}: only the reference is asked");
        let named = rows.iter().filter(|row| row.metric == "difference" && row.engine == "parser").any(|row| {
            let params: Value = serde_json::from_str(&row.params).unwrap();
            params["cause"] == CAUSE
        });
        assert_eq!(named, case == 2, "{k}: case {case}");
    }
    assert!(seen.iter().all(|&count| count > 20), "{seen:?}");
}
