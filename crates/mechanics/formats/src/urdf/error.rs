//! What can be wrong with a URDF file.

use crate::{FileError, TextError};
use featherbench_model::{Malformed, Warning};
use thiserror::Error;

/// A URDF file that cannot be imported: the place, and why.
pub type UrdfError = FileError<UrdfProblem>;

/// What is wrong with a URDF file.
#[derive(Debug, Error)]
pub enum UrdfProblem {
    /// The file is not text.
    #[error("the file {0}")]
    Text(#[from] TextError),
    /// The text is not XML.
    #[error("this is not well-formed XML: {message}")]
    Xml {
        /// What the parser found.
        message: String,
        /// Line and column.
        position: (usize, usize),
    },
    /// A document type declaration, which no URDF needs.
    #[error("the file declares a document type; entities are not expanded, remove the <!DOCTYPE …>")]
    DocumentType,
    /// A file of another kind.
    #[error("this is {kind}, not URDF; give the <robot> file")]
    AnotherKind {
        /// What it is.
        kind: &'static str,
    },
    /// The file must be expanded by xacro first.
    #[error("this is a xacro file ({found}); expand it first: xacro robot.urdf.xacro > robot.urdf")]
    Xacro {
        /// What shows it.
        found: String,
    },
    /// The root element has another name.
    #[error("the root element is <{found}>, not <robot>; is this a URDF file?")]
    NotARobot {
        /// The element found.
        found: String,
    },
    /// An element lacks an attribute.
    #[error("<{element}> of {owner} has no attribute '{attribute}'")]
    MissingAttribute {
        /// The element.
        element: String,
        /// The link or joint.
        owner: String,
        /// The attribute.
        attribute: &'static str,
    },
    /// An element lacks a child.
    #[error("{owner} has no <{element}>")]
    MissingElement {
        /// The link or joint.
        owner: String,
        /// The element.
        element: &'static str,
    },
    /// An element occurs twice where only one is allowed.
    #[error("{owner} has more than one <{element}>; keep one")]
    RepeatedElement {
        /// The link or joint.
        owner: String,
        /// The element.
        element: &'static str,
    },
    /// An attribute is not the numbers that are expected.
    #[error("{attribute}=\"{value}\" of {owner} is not {expected}{}", if value.contains(',') { " (decimals have a point, and spaces between them)" } else { "" })]
    NotNumbers {
        /// The link or joint.
        owner: String,
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        value: String,
        /// What is expected.
        expected: &'static str,
    },
    /// A number is NaN or infinite.
    #[error("{attribute}=\"{value}\" of {owner} is not finite")]
    NotFinite {
        /// The link or joint.
        owner: String,
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        value: String,
    },
    /// The version is none that is known.
    #[error("the version '{version}' of <robot> is not known; the known ones are 1.0, 1.1 and 1.2, and a file without one has 1.0")]
    Version {
        /// As the file has it.
        version: String,
    },
    /// A quaternion of zeros.
    #[error("quat_xyzw of {owner} is 0 0 0 0, which is no orientation; write quat_xyzw=\"0 0 0 1\" for none")]
    ZeroQuaternion {
        /// The link or joint.
        owner: String,
    },
    /// Two orientations in one `<origin>`.
    #[error("<origin> of {owner} has both rpy and quat_xyzw; keep one")]
    TwoOrientations {
        /// The link or joint.
        owner: String,
    },
    /// A mass is negative.
    #[error("link '{link}' has the mass {mass} kg; a mass cannot be negative")]
    NegativeMass {
        /// The link.
        link: String,
        /// Its mass.
        mass: f64,
    },
    /// A body moves and has no mass.
    #[error(
        "link '{link}' moves (joint '{joint}') but {}; give it mass, or fix it to its neighbour{}",
        if *has_inertial { "has no mass, nor has anything fixed to it" } else { "has no <inertial>, nor has anything fixed to it mass" },
        if joint == super::tree::ROOT_JOINT { " (or import it with a fixed base)" } else { "" }
    )]
    Massless {
        /// The link.
        link: String,
        /// The joint that moves it.
        joint: String,
        /// Whether it has an `<inertial>`.
        has_inertial: bool,
    },
    /// An axis is zero, and so has no direction.
    #[error("joint '{joint}' has the axis 0 0 0, which is no direction")]
    ZeroAxis {
        /// The joint.
        joint: String,
    },
    /// A joint's type is unknown.
    #[error("joint '{joint}' has the unknown type '{kind}'; URDF knows revolute, continuous, prismatic, fixed, floating and planar")]
    UnknownJointType {
        /// The joint.
        joint: String,
        /// Its type.
        kind: String,
    },
    /// A joint mimics another, and cannot follow it.
    #[error("joint '{joint}' mimics joint '{of}', {why}; remove its <mimic> to free it")]
    Mimic {
        /// The joint.
        joint: String,
        /// The joint that it mimics.
        of: String,
        /// Why it cannot follow.
        why: &'static str,
    },
    /// Two elements share a name.
    #[error("two {what}s are named '{name}'; names must be unique")]
    DuplicateName {
        /// `link` or `joint`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A joint names a link that does not exist.
    #[error("joint '{joint}' names '{link}' as its {role}, but there is no such link")]
    UnknownLink {
        /// The joint.
        joint: String,
        /// The link.
        link: String,
        /// `parent` or `child`.
        role: &'static str,
    },
    /// Two joints carry the same link.
    #[error("link '{link}' is the child of two joints, '{first}' and '{second}'; a robot is a tree")]
    TwoParents {
        /// The link.
        link: String,
        /// One joint.
        first: String,
        /// The other joint.
        second: String,
    },
    /// Joints form a cycle.
    #[error("the parents of link '{link}' return to itself (joint '{joint}'); cut the cycle, a robot is a tree")]
    Cycle {
        /// A link of the cycle.
        link: String,
        /// The joint that carries it.
        joint: String,
    },
    /// More than one link has no parent.
    #[error("links '{first}' and '{second}' have no parent joint each; a robot has one root{}", if *alone { " (the second one is connected to nothing)" } else { "" })]
    TwoRoots {
        /// The first root.
        first: String,
        /// The second root.
        second: String,
        /// Whether the second root has no joints at all.
        alone: bool,
    },
    /// There are no links.
    #[error("the robot has no <link>")]
    NoLinks,
    /// The numbers are not a robot.
    #[error(transparent)]
    Malformed(#[from] Malformed),
}

/// A problem and the byte offset of the element that has it.
pub(super) struct At {
    pub offset: Option<usize>,
    pub problem: UrdfProblem,
}

impl UrdfProblem {
    /// This problem at a byte offset.
    pub(super) fn at(self, offset: usize) -> At {
        At { offset: Some(offset), problem: self }
    }
}

/// A note and the byte offset that it is about.
pub(super) struct NoteAt {
    pub offset: usize,
    pub text: String,
    pub warning: Option<Warning>,
}

impl NoteAt {
    pub fn new(offset: usize, text: String) -> Self {
        Self { offset, text, warning: None }
    }
}
