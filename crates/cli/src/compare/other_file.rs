//! Another file of the same robot, in the place of an engine: does it hold the robot of the first?
//!
//! What its reference reads from it is compared with what that of the first file reads, in the words by which engines differ. Both are computed
//! with by our own kernels.

use featherbench_bench::{Engine, Evaluation, Identity, Import, NoAnswer, Quantity, Robot, RobotFile};
use featherbench_engines::Featherbench;
use featherbench_model::Description;
use featherbench_results::EngineSource;
use featherbench_robots::StateBatch;
use std::collections::{BTreeMap, BTreeSet};

/// A file, and the robot that it is compared with.
pub struct OtherFile {
    identity: Identity,
    /// The name of the robot in the first file.
    pub of: String,
    import: Import,
    kernels: Featherbench,
}

impl OtherFile {
    /// The file of `other`, if both robots have a file.
    pub fn new(first: &Robot, other: &Robot) -> Option<Self> {
        let name = other.file.as_ref()?.path.file_name()?.to_string_lossy().into_owned();
        Self::of_writer(&name, first, other)
    }

    /// What a writer made of the first robot's file, as it is read again.
    pub fn of_writer(name: &str, first: &Robot, other: &Robot) -> Option<Self> {
        let file = other.file.as_ref().filter(|_| first.file.is_some())?;
        let identity = Identity {
            name: name.to_owned(),
            version: file.hash.chars().take(8).collect(),
            source: EngineSource::Live,
            build: BTreeMap::from([("format".into(), file.format.name().into())]),
        };
        let import = Import { description: other.description.clone(), notes: Vec::new(), keyframes: Vec::new(), written: None };
        Some(Self { identity, of: first.name.clone(), import, kernels: Featherbench::new() })
    }
}

/// Whether two robots are meant to be one: half of the joints of the smaller one are in the other by name, or both have the same joints in the
/// same tree.
pub fn are_one(a: &Description, b: &Description) -> bool {
    let names = |robot: &Description| -> BTreeSet<String> { robot.bodies.iter().map(|body| body.joint.name.clone()).collect() };
    let (x, y) = (names(a), names(b));
    let shape = |robot: &Description| -> Vec<(Option<usize>, &'static str)> {
        robot.bodies.iter().map(|body| (body.parent, body.joint.kind.name())).collect()
    };
    2 * x.intersection(&y).count() >= x.len().min(y.len()) || shape(a) == shape(b)
}

impl Engine for OtherFile {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn methods(&self, quantity: Quantity) -> Vec<String> {
        let usual = self.kernels.methods(quantity).into_iter().take(1);
        if [Quantity::InverseDynamics, Quantity::MassMatrix].contains(&quantity) { usual.collect() } else { Vec::new() }
    }

    fn read(&self, _: &RobotFile) -> Result<Import, NoAnswer> {
        Ok(self.import.clone())
    }

    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
        self.kernels.prepare(robot, quantity, method, states)
    }
}
