//! The robots that a suite names.

use crate::FileBase;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// A robot of a suite: a committed model, a generator's text, or a file of the robots' package, which only live runs have.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotEntry {
    /// Name of a file in `datasets/models`, without its extension.
    pub model: Option<String>,
    /// Arguments of `featherbench gen`.
    pub generate: Option<String>,
    /// A URDF file below the package folder of example-robot-data.
    pub urdf: Option<String>,
    /// An MJCF file below the folder of packages; MuJoCo's compiler determines the robot.
    pub mjcf: Option<String>,
    /// Whether the URDF's base floats.
    #[serde(default)]
    pub floating: bool,
    /// The bases of a file's robot, `fixed` and `free`. Each is a separate robot; `-free` is appended to the name of the free one.
    pub bases: Option<Vec<String>>,
    /// The family in rows.
    pub family: String,
    /// The number of states, if it is not the suite's.
    pub states: Option<usize>,
    /// If given, all states are random, with the angles of revolute joints in (−reach, reach).
    pub reach: Option<f64>,
    /// If given, all states are random, with velocities this many times larger.
    pub speed: Option<f64>,
    /// The name in rows, if the model's own name would occur twice.
    pub name: Option<String>,
    /// The studies that use it; all by default.
    pub studies: Option<Vec<String>>,
    /// Whether runs that are not live leave it out. Otherwise a file's robot makes them an error.
    #[serde(default)]
    pub only_live: bool,
    /// The levels at which it was drawn, by axis.
    #[serde(skip)]
    pub axes: BTreeMap<String, Value>,
}

impl RobotEntry {
    /// The bases of a file's robot, and whether each needs a name of its own.
    pub fn bases(&self) -> Vec<(FileBase, bool)> {
        match &self.bases {
            None => vec![(if self.floating { FileBase::Free } else { FileBase::Fixed }, false)],
            Some(bases) => bases.iter().filter_map(|base| FileBase::parse(base)).map(|base| (base, base == FileBase::Free)).collect(),
        }
    }

    /// What is wrong with it beyond its keys.
    pub(super) fn complaint(&self) -> Option<String> {
        if [&self.model, &self.generate, &self.urdf, &self.mjcf].into_iter().flatten().count() != 1 {
            return Some(format!("a [[robot]] of family '{}' must have exactly one of model, generate, urdf and mjcf", self.family));
        }
        let of_file = self.urdf.is_some() || self.mjcf.is_some();
        let known = |bases: &Vec<String>| of_file && !self.floating && bases.iter().all(|base| FileBase::parse(base).is_some());
        let bases = "bases is a list of fixed and free, for urdf and mjcf, without floating";
        (!self.bases.as_ref().is_none_or(known)).then(|| format!("a [[robot]] of family '{}': {bases}", self.family))
    }
}
