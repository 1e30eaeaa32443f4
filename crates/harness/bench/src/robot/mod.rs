//! A robot with the states at which engines are asked.

pub(crate) mod class;
pub mod conventions;
pub mod drawing;
pub(crate) mod file;
pub(crate) mod import;
pub(crate) mod properties;
mod recognised;
pub(crate) mod relocation;
pub(crate) mod source;

use crate::{Import, RobotFile, RobotSource};
use featherbench_model::{Description, Malformed, Model};
use featherbench_results::ModelOrigin;
use featherbench_robots::{BadState, StateBatch};
use serde_json::Value;
use std::collections::BTreeMap;

/// The most configurations of a file that become states; a recorded motion may have thousands.
const KEYFRAMES: usize = 16;

/// How a robot gets into an engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Route {
    /// The description, through the engine's programming interface.
    #[default]
    Neutral,
    /// The file, through the engine's own parser.
    AsRead,
}

/// The text for content hashes: it contains everything that defines a robot except its name.
fn canonical_json(description: &Description) -> Result<String, Malformed> {
    featherbench_formats::neutral::to_line(&Description { name: String::new(), ..description.clone() })
}

/// A robot and its states.
#[derive(Clone, Debug)]
pub struct Robot {
    /// The robot's name.
    pub name: String,
    /// Its family: chain, tree, joints, robot, …
    pub family: String,
    /// Generated, or a real robot.
    pub origin: ModelOrigin,
    /// The canonical description.
    pub description: Description,
    /// The compiled model.
    pub model: Model<f64>,
    /// Content hash of the canonical description and the states' seed.
    pub hash: String,
    /// The states at which engines are compared.
    pub states: StateBatch,
    /// Depth of the tree of described bodies.
    pub depth: usize,
    /// The file of the robot, if engines can import it too.
    pub file: Option<RobotFile>,
    /// How the robot gets into an engine.
    pub route: Route,
    /// The studies that use it; all, when there is no list.
    pub studies: Option<Vec<String>>,
    /// The levels at which a suite drew it, by axis.
    pub axes: BTreeMap<String, Value>,
}

impl Robot {
    /// Compiles a robot and draws `count` agreement states.
    ///
    /// # Errors
    /// [`Malformed`] when the description is not a robot.
    pub fn new(description: &Description, family: &str, origin: ModelOrigin, count: usize, seed: u64) -> Result<Self, Malformed> {
        let model = Model::build(description)?;
        let description = description.canonical()?;
        let states = StateBatch::agreement(&model, count, seed);
        let hash = crate::hash::of_parts(&[canonical_json(&description)?.as_bytes(), &seed.to_le_bytes()]);
        let depth = description.depth();
        Ok(Self {
            name: description.name.clone(),
            family: family.to_owned(),
            origin,
            description,
            model,
            hash,
            states,
            depth,
            file: None,
            route: Route::Neutral,
            studies: None,
            axes: BTreeMap::new(),
        })
    }

    /// A robot of any size at one random state, known by its name alone: a content hash would need its whole text.
    ///
    /// The description must be canonical, as generated ones are.
    ///
    /// # Errors
    /// [`Malformed`] when the description is not a robot.
    pub fn at_one_state(name: &str, description: Description, seed: u64) -> Result<Self, Malformed> {
        let model = Model::build(&description)?;
        let states = StateBatch::random(&model, 1, seed);
        let hash = crate::hash::of_parts(&[name.as_bytes(), &seed.to_le_bytes()]);
        let family = name.split(':').next().unwrap_or(name).to_owned();
        let (name, depth) = (name.to_owned(), description.depth());
        let origin = ModelOrigin::Generated;
        let axes = BTreeMap::new();
        Ok(Self { name, family, origin, description, model, hash, states, depth, file: None, route: Route::Neutral, studies: None, axes })
    }

    /// The same robot, with its file.
    pub fn from_file(mut self, file: RobotFile) -> Self {
        self.hash = crate::hash::of_parts(&[self.hash.as_bytes(), file.hash.as_bytes(), file.format.name().as_bytes()]);
        self.file = Some(file);
        self
    }

    /// The result of an engine's import of this robot's file as a robot, at the states that `states` draws for it.
    ///
    /// # Errors
    /// [`Malformed`] when the import result is not a robot.
    pub fn as_read(&self, reading: &Import, states: impl FnOnce(&Model<f64>) -> StateBatch) -> Result<Self, Malformed> {
        let description = reading.description.canonical()?;
        let model = Model::build(&description)?;
        let states = states(&model);
        let hash = crate::hash::of_parts(&[self.hash.as_bytes(), b"imported", canonical_json(&description)?.as_bytes()]);
        let (depth, route) = (description.depth(), Route::AsRead);
        Ok(Self { description, model, states, hash, depth, route, ..self.clone() })
    }

    /// The same robot at other states, with the states' own hash.
    pub fn at(mut self, states: StateBatch) -> Self {
        let bytes: Vec<u8> = [&states.q, &states.v, &states.tau].into_iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        self.hash = crate::hash::of_parts(&[self.hash.as_bytes(), &bytes]);
        self.states = states;
        self
    }

    /// The same robot with what its source says besides the description: warnings of the model, states at its keyframes (at most the first
    /// 16), its file.
    ///
    /// # Errors
    /// [`BadState`] of a keyframe that is not this robot's.
    pub fn with_source(mut self, source: &RobotSource, seed: u64) -> Result<Self, BadState> {
        self.model.warnings.splice(0..0, source.warnings.iter().cloned());
        let keyframes = &source.keyframes[..source.keyframes.len().min(KEYFRAMES)];
        if !keyframes.is_empty() {
            let states = self.states.clone().with_keyframes(&self.model, keyframes, seed)?;
            self = self.at(states);
        }
        Ok(match &source.file {
            Some(file) => self.from_file(file.clone()),
            None => self,
        })
    }

    /// The body whose Jacobian is evaluated: the first of the deepest ones.
    pub fn deepest_body(&self) -> usize {
        let mut depth = Vec::with_capacity(self.description.bodies.len());
        for body in &self.description.bodies {
            depth.push(1 + body.parent.map_or(0, |parent: usize| depth[parent]));
        }
        (0..depth.len()).find(|&body| depth[body] == self.depth).unwrap_or(0)
    }

    /// Four fixed vectors for [`Quantity::MassMatrixProbe`](crate::Quantity::MassMatrixProbe), row after row, uniform in (−1, 1).
    pub fn probe(&self) -> Vec<f64> {
        let mut random = featherbench_robots::Random::named(0, "mass matrix probe");
        (0..4 * self.model.topology.nv()).map(|_| random.uniform(-1.0, 1.0)).collect()
    }

    /// Whether a study uses this robot.
    pub fn takes(&self, study: &str) -> bool {
        self.studies.as_ref().is_none_or(|studies| studies.iter().any(|name| name == study))
    }

    /// `free` when the first body floats, else `fixed`.
    pub fn base(&self) -> &'static str {
        let floats = self.description.bodies.first().is_some_and(|body| body.joint.kind == featherbench_model::JointType::Free);
        if floats { "free" } else { "fixed" }
    }

    /// The read-back of an exact engine, in the layout of [`Quantity::Readback`](crate::Quantity::Readback).
    pub fn readback(&self) -> Vec<f64> {
        let mut numbers = Vec::with_capacity(22 * self.description.bodies.len());
        for body in &self.description.bodies {
            numbers.push(body.mass);
            numbers.extend(body.com);
            numbers.extend(body.inertia);
            numbers.extend(body.joint.placement.rotation);
            numbers.extend(body.joint.placement.translation);
        }
        numbers
    }

    /// The kinds of joints in it, sorted.
    pub fn joint_kinds(&self) -> Vec<&'static str> {
        let mut kinds: Vec<_> = self.description.bodies.iter().map(|body| body.joint.kind.name()).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    }
}
