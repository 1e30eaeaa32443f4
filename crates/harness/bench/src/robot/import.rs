//! A robot's file, and the result of its import by an engine's own parser.

use crate::{HarnessError, hash};
use featherbench_formats::neutral;
use featherbench_model::Description;
use featherbench_results::Feature;
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A robot as its author wrote it: the file that every engine imports itself.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFile {
    /// The file, by its absolute path.
    pub path: PathBuf,
    /// Its format.
    pub format: FileFormat,
    /// The joint of the root link.
    pub base: FileBase,
    /// Hash of the file's content. Files that it includes are not in it.
    pub hash: String,
    /// The links of the file, if our own parser has read it.
    pub links: Vec<FileLink>,
    /// What the file holds that engines' parsers are known to refuse or to read otherwise.
    pub features: Vec<Feature>,
}

/// A link as its file has it, in its own frame and not yet merged with others.
#[derive(Clone, Debug, PartialEq)]
pub struct FileLink {
    /// Its name.
    pub name: String,
    /// Its inertial element.
    pub inertial: Option<FileInertial>,
    /// Mass, centre of mass and inertia of its collision geometry at [`WATER`], if that is boxes, spheres, cylinders and capsules.
    pub solids: Option<FileInertial>,
}

/// Density of water, kg/m³: engines use it for geometry without a density.
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

/// The format of a robot's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FileFormat {
    /// The Unified Robot Description Format.
    Urdf,
    /// MuJoCo's own format.
    Mjcf,
}

/// The joint of the root link of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileBase {
    /// Fixed to the world, or as the file says.
    Fixed,
    /// A free joint.
    Free,
}

/// The result of a file's import by an engine's own parser.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The engine's robot, canonical.
    pub description: Description,
    /// The parser's known edits.
    pub notes: Vec<ImportNote>,
    /// Configurations that the file names, in the description's coordinates; quaternions as the engine has them.
    pub keyframes: Vec<Vec<f64>>,
    /// The same robot with the file's own inertias, if the engine repaired them.
    pub written: Option<Description>,
}

/// An edit by a parser, or an element that it did not import.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImportNote {
    /// A word of `oracles/PROTOCOL.md`, such as `mass_edited`.
    pub cause: String,
    /// The link, joint or element that it is about.
    pub about: Option<String>,
    /// What was done, one sentence.
    pub text: String,
    /// The numbers that `oracles/PROTOCOL.md` defines for the cause; empty if the engine gives none.
    pub numbers: Vec<f64>,
}

/// An import as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    notes: Vec<ImportNote>,
    /// The text of the description.
    description: String,
    /// That of the robot with the file's own inertias.
    written: Option<String>,
    keyframes: Vec<Vec<f64>>,
}

impl Import {
    /// The import as JSON.
    ///
    /// # Errors
    /// A sentence, when its description is no robot.
    pub fn to_text(&self) -> Result<String, String> {
        let text = |description: &Description| neutral::to_string(description).map_err(|error| error.to_string());
        let written = self.written.as_ref().map(text).transpose()?;
        let (description, notes, keyframes) = (text(&self.description)?, self.notes.clone(), self.keyframes.clone());
        serde_json::to_string(&Written { notes, description, written, keyframes }).map_err(|error| error.to_string())
    }

    /// The import of a text by [`Import::to_text`].
    ///
    /// # Errors
    /// A sentence, when the text is no import.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let Written { notes, description, written, keyframes } = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let parse = |text: &str| neutral::parse(text, "an import").map_err(|error| error.to_string());
        let written = written.as_deref().map(parse).transpose()?;
        Ok(Self { description: parse(&description)?, notes, keyframes, written })
    }
}

impl RobotFile {
    /// The file at a path, with the hash of its content.
    ///
    /// # Errors
    /// [`HarnessError::Io`] when it cannot be found or read.
    pub fn open(path: &Path, format: FileFormat, base: FileBase) -> Result<Self, HarnessError> {
        let io = |source| HarnessError::io(path, source);
        let bytes = std::fs::read(path).map_err(io)?;
        let features = match format {
            FileFormat::Urdf => features_of_urdf(&String::from_utf8_lossy(&bytes)),
            FileFormat::Mjcf => features_of_mjcf(path),
        };
        Ok(Self { path: std::path::absolute(path).map_err(io)?, format, base, hash: hash::of(&bytes), links: Vec::new(), features })
    }
}

fn features_of_urdf(text: &str) -> Vec<Feature> {
    let mimics = featherbench_formats::urdf::mimics(text);
    let links = featherbench_formats::urdf::links(text, WATER);
    let mut inertias = links.iter().filter_map(|link| link.inertial).map(|inertial| inertial.inertia);
    let found = [
        (Feature::NegativeMoment, inertias.any(has_negative_moment)),
        (Feature::FixedMimic, mimics.iter().any(|mimic| mimic.is_fixed)),
        (Feature::UnknownMimic, mimics.iter().any(|mimic| !mimic.is_known)),
    ];
    found.into_iter().filter_map(|(feature, found)| found.then_some(feature)).collect()
}

fn features_of_mjcf(path: &Path) -> Vec<Feature> {
    let contents = featherbench_formats::mjcf::contents(path);
    let found = [
        (Feature::Unnamed, !contents.named),
        (Feature::WorldSite, contents.world_site),
        (Feature::HeightField, contents.height_field),
        (Feature::MeshWithoutInertial, contents.mesh_without_inertial),
        (Feature::MeshFormat, contents.mesh_formats.iter().any(|ending| !MESH_FORMATS.contains(&ending.as_str()))),
    ];
    found.into_iter().filter_map(|(feature, found)| found.then_some(feature)).collect()
}

/// The endings of OBJ, glTF, VTK and SDF files.
const MESH_FORMATS: [&str; 5] = ["obj", "gltf", "glb", "vtk", "sdf"];

/// Whether an inertia (ixx, ixy, ixz, iyy, iyz, izz) has a principal moment below zero by more than the rounding of six digits.
fn has_negative_moment([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> bool {
    let trace = xx + yy + zz;
    let moments = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz).symmetric_eigenvalues();
    trace > 0.0 && moments.min() < -1e-6 * trace
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
