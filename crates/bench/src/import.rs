//! A robot's file, and what an engine's own parser makes of it.

use crate::{HarnessError, hash};
use featherbench_model::Description;
use std::path::{Path, PathBuf};

/// A robot as its author wrote it: the file that every engine reads for itself.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFile {
    /// The file, by its absolute path.
    pub path: PathBuf,
    /// How it is written.
    pub format: FileFormat,
    /// What the root link stands on.
    pub base: FileBase,
    /// Hash of the file's content. Files that it includes are not in it.
    pub hash: String,
    /// What the file says of its links, where a reader of ours has looked.
    pub links: Vec<FileLink>,
}

/// A link as its file has it, in its own frame and not yet merged with others.
#[derive(Clone, Debug, PartialEq)]
pub struct FileLink {
    /// Its name.
    pub name: String,
    /// Its inertial element.
    pub inertial: Option<FileInertial>,
    /// Mass, centre of mass and inertia of its collision geometry at [`WATER`], where that is boxes, spheres, cylinders and capsules.
    pub solids: Option<FileInertial>,
}

/// Density of water, kg/m³: what engines give to geometry that has none.
pub const WATER: f64 = 1000.0;

/// Mass properties with axes of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FileInertial {
    /// kg.
    pub mass: f64,
    /// The centre of mass in the link's frame, m.
    pub com: [f64; 3],
    /// The rotation of the inertial's axes in the link's frame, row-major.
    pub rotation: [f64; 9],
    /// Inertia about the centre of mass in the inertial's axes: ixx, ixy, ixz, iyy, iyz, izz, kg·m².
    pub inertia: [f64; 6],
}

/// How a robot's file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// The Unified Robot Description Format.
    Urdf,
    /// MuJoCo's own format.
    Mjcf,
}

/// What the root link of a file stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileBase {
    /// The world, or what the file itself says.
    Fixed,
    /// A free joint.
    Free,
}

/// What an engine holds after its own parser has read a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The robot that it holds, canonical.
    pub description: Description,
    /// What the parser is known to have done on the way.
    pub notes: Vec<ImportNote>,
    /// Configurations in which the file has the robot stand, in the description's coordinates; quaternions as the engine holds them.
    pub keyframes: Vec<Vec<f64>>,
    /// The same robot with the file's own inertias, where the engine refuses those and holds repaired ones.
    pub written: Option<Description>,
}

/// Something that a parser did beyond reading, or left unread.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportNote {
    /// A word of `oracles/PROTOCOL.md`, such as `mass_edited`.
    pub cause: String,
    /// The link, joint or element that it is about.
    pub about: Option<String>,
    /// What was done, one sentence.
    pub text: String,
    /// The numbers that `oracles/PROTOCOL.md` gives the cause; empty where the engine tells none.
    pub numbers: Vec<f64>,
}

impl RobotFile {
    /// The file at a path, with the hash of its content.
    ///
    /// # Errors
    /// [`HarnessError::Io`] when it cannot be found or read.
    pub fn open(path: &Path, format: FileFormat, base: FileBase) -> Result<Self, HarnessError> {
        let io = |source| HarnessError::io(path, source);
        let bytes = std::fs::read(path).map_err(io)?;
        Ok(Self { path: std::path::absolute(path).map_err(io)?, format, base, hash: hash::of(&bytes), links: Vec::new() })
    }
}

impl FileFormat {
    /// The word for it in the oracle protocol.
    pub fn name(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Mjcf => "mjcf",
        }
    }
}

impl FileBase {
    /// The base named by a word.
    pub fn parse(word: &str) -> Option<Self> {
        [Self::Fixed, Self::Free].into_iter().find(|base| base.name() == word)
    }

    /// The word for it in the oracle protocol.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Free => "free",
        }
    }
}
