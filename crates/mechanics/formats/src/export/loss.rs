//! What a format cannot hold.

use featherbench_model::Description;
use std::fmt;

/// Something of a robot that a format cannot hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Loss {
    /// What it is about: `joint 'elbow'`, `body 'arm'`, `frame 'tool'`, `the robot`.
    pub about: String,
    /// What the format cannot hold.
    pub reason: Reason,
}

/// Why a format cannot hold something.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// URDF has no gravity, and is imported with (0, 0, −9.81).
    Gravity,
    /// The format has no such joint.
    JointType {
        /// The joint's type.
        kind: &'static str,
        /// What to do instead.
        advice: &'static str,
    },
    /// The format has no place for this number of a joint.
    Property {
        /// The field: `armature`, `velocity`, …
        field: &'static str,
    },
    /// The format has this number only for joints with one degree of freedom.
    SeveralDofs {
        /// The field.
        field: &'static str,
    },
    /// The format has one number per joint, and the joint's degrees of freedom differ.
    Unequal {
        /// The field.
        field: &'static str,
    },
    /// A lower limit without an upper one, or the reverse.
    OneSided,
    /// URDF asks for all four limits of a joint, or on a revolute joint for speed and effort, or for none.
    IncompleteLimits,
    /// An interval of limits of length zero, where the format needs a longer one.
    EmptyRange {
        /// The field.
        field: &'static str,
    },
    /// The format has no such loop.
    Loop {
        /// The loop's type.
        kind: &'static str,
    },
    /// The format has no bodies that deform.
    Deforms,
    /// A residual.
    Residual,
    /// Uncertain parameters.
    Uncertain,
    /// A free joint whose coordinates do not begin at the world's origin, as those of MuJoCo do.
    FreePlacement,
    /// MuJoCo moves no body without mass.
    Massless,
    /// MuJoCo refuses an inertia that no mass distribution has.
    Unphysical,
    /// A free joint below another body.
    FreeBelow,
    /// The name is empty, contains a control character, or looks like a macro of xacro.
    BadName,
    /// The name occurs twice where the format needs it to be unique.
    RepeatedName,
    /// The name is reserved by the format.
    ReservedName,
}

impl Reason {
    /// Whether the rest is still the robot: the same bodies and joints in the same places, to within rounding.
    pub fn can_be_left_out(&self) -> bool {
        match self {
            Self::Gravity
            | Self::Property { .. }
            | Self::SeveralDofs { .. }
            | Self::Unequal { .. }
            | Self::OneSided
            | Self::IncompleteLimits
            | Self::EmptyRange { .. }
            | Self::Loop { .. }
            | Self::Residual
            | Self::Uncertain
            | Self::FreePlacement => true,
            Self::JointType { .. }
            | Self::Deforms
            | Self::Massless
            | Self::Unphysical
            | Self::FreeBelow
            | Self::BadName
            | Self::RepeatedName
            | Self::ReservedName => false,
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gravity => write!(f, "gravity, which is not part of the format: it is read with (0, 0, -9.81)"),
            Self::JointType { kind, advice } => write!(f, "{kind} joint, which the format has not; {advice}"),
            Self::Property { field } => write!(f, "{field}, for which the format has no place"),
            Self::SeveralDofs { field } => write!(f, "{field}, for which the format has a place on joints with one degree of freedom only"),
            Self::Unequal { field } => write!(f, "{field} that differs between degrees of freedom; the format has one number per joint"),
            Self::OneSided => write!(f, "a lower limit without an upper one, or the reverse; give both or none"),
            Self::IncompleteLimits => {
                write!(
                    f,
                    "limits in part: the format asks for lower, upper, velocity and effort (a revolute joint may have none, or the last two)"
                )
            }
            Self::EmptyRange { field } => write!(f, "{field} that leave no range; the format asks for a lower end below the upper one"),
            Self::Loop { kind } => write!(f, "a loop of type {kind}, for which the format has no place"),
            Self::Deforms => write!(f, "a body that deforms, which the format has not; keep the neutral format"),
            Self::Residual => write!(f, "a residual: the format has rigid bodies alone"),
            Self::Uncertain => write!(f, "its distribution: the format has nominal numbers alone"),
            Self::FreePlacement => {
                write!(f, "a free joint whose coordinates are not the world's, as the format has them; place it at the world's origin")
            }
            Self::Massless => {
                write!(f, "moves with a mass or a principal moment of inertia below 1e-15, which MuJoCo does not compile; give it more")
            }
            Self::Unphysical => write!(f, "an inertia that no mass distribution has, which MuJoCo does not compile; correct it"),
            Self::FreeBelow => write!(f, "a free joint on another body; MuJoCo has them on the world only"),
            Self::BadName => write!(f, "a name that is empty, holds a control character or reads as a macro; rename it"),
            Self::RepeatedName => {
                write!(f, "the name stands twice where the format asks for unique ones (links and frames share names); rename one")
            }
            Self::ReservedName => write!(f, "the name 'world' is the root's own; rename it"),
        }
    }
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.about, self.reason)
    }
}

/// The bodies that deform.
pub(crate) fn deforming(robot: &Description) -> impl Iterator<Item = Loss> + '_ {
    let about = |(index, name): (usize, &str)| Loss { about: format!("continua[{index}] '{name}'"), reason: Reason::Deforms };
    robot.continua.iter().map(|continuum| continuum.name.as_str()).enumerate().map(about)
}

/// The residuals.
pub(crate) fn residuals(robot: &Description) -> impl Iterator<Item = Loss> + '_ {
    robot.residuals.iter().map(|residual| Loss { about: format!("the residual '{}'", residual.name), reason: Reason::Residual })
}

/// All losses, one line for each reason.
pub(super) fn listed(format: &str, losses: &[Loss]) -> String {
    let mut lines: Vec<(&Reason, Vec<&str>)> = Vec::new();
    for Loss { about, reason } in losses {
        match lines.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, all)) => all.push(about),
            None => lines.push((reason, vec![about])),
        }
    }
    let lines = lines.into_iter().map(|(reason, about)| format!("\n- {}: {reason}", about.join(", ")));
    format!("{format} cannot hold this robot:{}", lines.collect::<String>())
}
