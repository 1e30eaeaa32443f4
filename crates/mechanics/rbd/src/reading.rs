//! Where robots come from: files, texts, descriptions and families.

use crate::{Error, Robot, pinocchio};
use featherbench_formats::urdf::{self, Base, Options};
use featherbench_formats::{mjcf, neutral};
use featherbench_model::Description;
use featherbench_robots::Family;
use std::path::Path;

impl Robot {
    /// Reads a URDF file. The root link is fixed to the world.
    ///
    /// A link that is fixed to another is merged with it and stays as a frame. Siblings keep the order of the file. What was left out or
    /// altered is told by [`Robot::notes`].
    ///
    /// # Errors
    /// [`Error::Urdf`], naming file, line, column and the link or joint.
    ///
    /// ```
    /// use featherbench_rbd::{Error, Robot};
    /// let missing = Robot::from_urdf("no_such_robot.urdf").unwrap_err();
    /// assert!(matches!(missing, Error::Urdf(_)) && missing.to_string().starts_with("no_such_robot.urdf"));
    /// ```
    pub fn from_urdf(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::of_urdf(&urdf::content(&path)?, &path.as_ref().display().to_string(), Base::Fixed)
    }

    /// The same with a free joint, `root_joint`, between the world and the root link.
    ///
    /// # Errors
    /// [`Error::Urdf`].
    ///
    /// ```
    /// assert!(featherbench_rbd::Robot::from_urdf_floating("no_such_robot.urdf").is_err());
    /// ```
    pub fn from_urdf_floating(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::of_urdf(&urdf::content(&path)?, &path.as_ref().display().to_string(), Base::Floating)
    }

    /// Reads URDF from a text; `name` stands for the file in errors.
    ///
    /// # Errors
    /// [`Error::Urdf`].
    ///
    /// ```
    /// use featherbench_rbd::Robot;
    /// let text = r#"<robot name="pendulum"><link name="world"/><link name="bob"><inertial><origin xyz="0 0 -0.5"/><mass value="1"/>
    ///     <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
    ///     <joint name="swing" type="continuous"><parent link="world"/><child link="bob"/><axis xyz="0 1 0"/></joint></robot>"#;
    /// let robot = Robot::from_urdf_text(text, "pendulum.urdf", false)?;
    /// let tau = robot.inverse_dynamics(&[std::f64::consts::FRAC_PI_2], &[0.0], &[0.0])?;
    /// assert!((tau[0] - 9.81 * 0.5).abs() < 1e-12, "m g l");
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn from_urdf_text(text: &str, name: &str, floating: bool) -> Result<Self, Error> {
        Self::of_urdf(text, name, if floating { Base::Floating } else { Base::Fixed })
    }

    fn of_urdf(text: &str, file: &str, base: Base) -> Result<Self, Error> {
        let parsed = urdf::Parsed::of(text.as_bytes(), file)?;
        let (description, notes) = parsed.import(&Options { base, ..Options::default() })?;
        Self::read(&description, &notes, |joints| pinocchio::otherwise(joints, &parsed.sorted_joints()))
    }

    /// Reads a neutral description file (`datasets/models/FORMAT.md`), which `featherbench gen` writes from URDF and MJCF.
    ///
    /// # Errors
    /// [`Error::Neutral`], naming file, line, column and field.
    ///
    /// ```
    /// assert!(featherbench_rbd::Robot::from_json("no_such_robot.json").is_err());
    /// ```
    pub fn from_json(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::from_description(&neutral::read(path)?)
    }

    /// Reads an MJCF file, as far as that needs no compiler of MuJoCo; see [`mjcf`] for what is read.
    ///
    /// Coordinates are neutral, not MuJoCo's: [`Robot::from_mujoco`] converts them. A body with several joints becomes several bodies.
    /// What was left out is told by [`Robot::notes`].
    ///
    /// # Errors
    /// [`Error::Mjcf`], naming file, line, column and the body. What MuJoCo's compiler alone can read is an error with its name.
    ///
    /// ```
    /// use featherbench_rbd::{Error, Robot};
    /// let missing = Robot::from_mjcf("no_such_robot.xml").unwrap_err();
    /// assert!(matches!(missing, Error::Mjcf(_)) && missing.to_string().starts_with("no_such_robot.xml"));
    /// ```
    pub fn from_mjcf(path: impl AsRef<Path>) -> Result<Self, Error> {
        let (description, notes) = mjcf::read(path)?;
        Self::noted(&description, &notes)
    }

    /// Reads MJCF from a text; `name` stands for the file in errors.
    ///
    /// # Errors
    /// [`Error::Mjcf`].
    ///
    /// ```
    /// use featherbench_rbd::Robot;
    /// let text = r#"<mujoco><worldbody><body name="bob"><joint name="swing" axis="0 1 0"/>
    ///     <inertial pos="0 0 -0.5" mass="1" diaginertia="0.01 0.01 0.01"/></body></worldbody></mujoco>"#;
    /// let robot = Robot::from_mjcf_text(text, "pendulum.xml")?;
    /// let tau = robot.inverse_dynamics(&[std::f64::consts::FRAC_PI_2], &[0.0], &[0.0])?;
    /// assert!((tau[0] - 9.81 * 0.5).abs() < 1e-12, "m g l");
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn from_mjcf_text(text: &str, name: &str) -> Result<Self, Error> {
        let (description, notes) = mjcf::import(text, name)?;
        Self::noted(&description, &notes)
    }

    /// Reads a file by the ending of its name: `.urdf` (fixed to the world), `.xml` or `.mjcf`, or `.json`.
    ///
    /// # Errors
    /// That of the reader, or [`Error::UnknownEnding`].
    ///
    /// ```
    /// use featherbench_rbd::{Error, Robot};
    /// assert!(matches!(Robot::from_file("scene.xml"), Err(Error::Mjcf(_))), "there is no such file");
    /// assert!(matches!(Robot::from_file("hand.stl"), Err(Error::UnknownEnding { .. })));
    /// ```
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        match ending.as_str() {
            "urdf" => Self::from_urdf(path),
            "xml" | "mjcf" => Self::from_mjcf(path),
            "json" => Self::from_json(path),
            _ => Err(Error::UnknownEnding { path: path.display().to_string() }),
        }
    }

    /// The robot of a description, which need not be canonical.
    ///
    /// # Errors
    /// [`Error::Malformed`], naming the body and field.
    ///
    /// ```
    /// use featherbench_rbd::Robot;
    /// use featherbench_rbd::model::Description;
    /// assert!(Robot::from_description(&Description::default()).is_err(), "a robot has at least one body that moves");
    /// ```
    pub fn from_description(description: &Description) -> Result<Self, Error> {
        Self::noted(description, &[] as &[String])
    }

    /// A generated robot, such as `chain:n=36,layout=spatial`, `humanoid`, `quadruped` or `tree:n=100`.
    ///
    /// # Errors
    /// [`Error::Family`], naming what is not known.
    ///
    /// ```
    /// let robot = featherbench_rbd::Robot::generated("chain:n=36,layout=spatial")?;
    /// assert_eq!(robot.nv(), 36);
    /// # Ok::<(), featherbench_rbd::Error>(())
    /// ```
    pub fn generated(family: &str) -> Result<Self, Error> {
        Self::from_description(&Family::parse(family)?.generate()?)
    }
}
