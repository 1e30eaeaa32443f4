//! A robot's file: what it is, and what it says before anyone makes a robot of it. Its bytes are read once.

use crate::{HarnessError, OWN, hash};
use featherbench_formats::mjcf::{self, Contents};
use featherbench_formats::urdf::{FileLink, Mimic, Note, Options, Parsed};
use featherbench_model::Description;
use featherbench_results::Feature;
use nalgebra::Matrix3;
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
    /// The links of a URDF.
    pub links: Vec<FileLink>,
    /// What the file holds that engines' parsers are known to refuse or to read otherwise.
    pub features: Vec<Feature>,
}

/// Density of water, kg/m³: engines use it for geometry without a density.
pub const WATER: f64 = 1000.0;

/// The format of a robot's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FileFormat {
    /// The Unified Robot Description Format.
    Urdf,
    /// MuJoCo's own format.
    Mjcf,
    /// The Simulation Description Format, of Gazebo.
    Sdf,
    /// Universal Scene Description, with its physics schemas.
    Usd,
}

/// The joint of the root link of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileBase {
    /// Fixed to the world, or as the file says.
    Fixed,
    /// A free joint.
    Free,
}

/// The bytes of a robot's file, and their format.
pub struct FileContent {
    /// The file as it was named.
    pub path: PathBuf,
    /// Its format.
    pub format: FileFormat,
    pub(super) bytes: Vec<u8>,
}

impl FileContent {
    /// Reads a file of a known format.
    ///
    /// # Errors
    /// [`HarnessError::Io`] when it cannot be found or read.
    pub fn read(path: &Path, format: FileFormat) -> Result<Self, HarnessError> {
        let bytes = std::fs::read(path).map_err(|source| HarnessError::io(path, source))?;
        Ok(Self { path: path.to_owned(), format, bytes })
    }

    /// The file with what it says, for engines that import it.
    ///
    /// # Errors
    /// [`HarnessError`] when a URDF is no XML.
    pub fn file(&self, base: FileBase) -> Result<RobotFile, HarnessError> {
        match self.format {
            FileFormat::Urdf => self.file_of_urdf(&Parsed::of(&self.bytes, &self.path.display().to_string())?, base),
            FileFormat::Mjcf => {
                let contents = mjcf::contents(&self.path, std::str::from_utf8(&self.bytes).unwrap_or_default());
                self.file_with(base, Vec::new(), features_of_mjcf(&contents))
            }
            FileFormat::Sdf | FileFormat::Usd => self.file_with(base, Vec::new(), Vec::new()),
        }
    }

    pub(super) fn file_of_urdf(&self, parsed: &Parsed, base: FileBase) -> Result<RobotFile, HarnessError> {
        let links = parsed.links(WATER);
        let features = features_of_urdf(&links, &parsed.mimics());
        self.file_with(base, links, features)
    }

    fn file_with(&self, base: FileBase, links: Vec<FileLink>, features: Vec<Feature>) -> Result<RobotFile, HarnessError> {
        let path = std::path::absolute(&self.path).map_err(|source| HarnessError::io(&self.path, source))?;
        Ok(RobotFile { path, format: self.format, base, hash: hash::of(&self.bytes), links, features })
    }

    /// Our reading of a URDF, with notes on what was left out.
    ///
    /// # Errors
    /// [`HarnessError::Urdf`], naming file, line and column.
    pub fn urdf(&self, options: &Options) -> Result<(Description, Vec<Note>), HarnessError> {
        Ok(Parsed::of(&self.bytes, &self.path.display().to_string())?.import(options)?)
    }
}

fn features_of_urdf(links: &[FileLink], mimics: &[Mimic]) -> Vec<Feature> {
    let mut inertias = links.iter().filter_map(|link| link.inertial).map(|inertial| inertial.inertia);
    let found = [
        (Feature::NegativeMoment, inertias.any(has_negative_moment)),
        (Feature::FixedMimic, mimics.iter().any(|mimic| mimic.is_fixed)),
        (Feature::UnknownMimic, mimics.iter().any(|mimic| !mimic.is_known)),
    ];
    found.into_iter().filter_map(|(feature, found)| found.then_some(feature)).collect()
}

fn features_of_mjcf(contents: &Contents) -> Vec<Feature> {
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
            Self::Sdf => "sdf",
            Self::Usd => "usd",
        }
    }

    /// The engine whose import of it is the reference; our own of a URDF.
    pub fn reference(self) -> &'static str {
        match self {
            Self::Urdf => OWN,
            Self::Mjcf => "mujoco",
            Self::Sdf => "drake",
            Self::Usd => "openusd",
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
