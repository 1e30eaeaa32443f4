//! What a format cannot hold.

use featherbench_model::Description;
use thiserror::Error;

/// Something of a robot that a format cannot hold.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{about}: {reason}")]
pub struct Loss {
    /// What it is about: `joint 'elbow'`, `body 'arm'`, `frame 'tool'`, `the robot`.
    pub about: String,
    /// What the format cannot hold.
    pub reason: Reason,
}

/// Why a format cannot hold something.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Reason {
    /// URDF has no gravity, and is imported with (0, 0, −9.81).
    #[error("gravity, which is not part of the format: it is read with (0, 0, -9.81)")]
    Gravity,
    /// The format has no such joint.
    #[error("{kind} joint, which the format has not; {advice}")]
    JointType {
        /// The joint's type.
        kind: &'static str,
        /// What to do instead.
        advice: &'static str,
    },
    /// The format has no place for this number of a joint.
    #[error("{field}, for which the format has no place")]
    Property {
        /// The field: `armature`, `velocity`, …
        field: &'static str,
    },
    /// The format has this number only for joints with one degree of freedom.
    #[error("{field}, for which the format has a place on joints with one degree of freedom only")]
    SeveralDofs {
        /// The field.
        field: &'static str,
    },
    /// The format has one number per joint, and the joint's degrees of freedom differ.
    #[error("{field} that differs between degrees of freedom; the format has one number per joint")]
    Unequal {
        /// The field.
        field: &'static str,
    },
    /// A lower limit without an upper one, or the reverse.
    #[error("a lower limit without an upper one, or the reverse; give both or none")]
    OneSided,
    /// URDF asks for all four limits of a joint, or on a revolute joint for speed and effort, or for none.
    #[error("limits in part: the format asks for lower, upper, velocity and effort (a revolute joint may have none, or the last two)")]
    IncompleteLimits,
    /// An interval of limits of length zero, where the format needs a longer one.
    #[error("{field} that leave no range; the format asks for a lower end below the upper one")]
    EmptyRange {
        /// The field.
        field: &'static str,
    },
    /// The format has no such loop.
    #[error("a loop of type {kind}, for which the format has no place")]
    Loop {
        /// The loop's type.
        kind: &'static str,
    },
    /// The format has no bodies that deform.
    #[error("a body that deforms, which the format has not; keep the neutral format")]
    Deforms,
    /// A residual.
    #[error("a residual: the format has rigid bodies alone")]
    Residual,
    /// Uncertain parameters.
    #[error("its distribution: the format has nominal numbers alone")]
    Uncertain,
    /// A free joint whose coordinates do not begin at the world's origin, as those of MuJoCo do.
    #[error("a free joint whose coordinates are not the world's, as the format has them; place it at the world's origin")]
    FreePlacement,
    /// MuJoCo moves no body without mass.
    #[error("moves with a mass or a principal moment of inertia below 1e-15, which MuJoCo does not compile; give it more")]
    Massless,
    /// MuJoCo refuses an inertia that no mass distribution has.
    #[error("an inertia that no mass distribution has, which MuJoCo does not compile; correct it")]
    Unphysical,
    /// A free joint below another body.
    #[error("a free joint on another body; MuJoCo has them on the world only")]
    FreeBelow,
    /// A name that USD writes otherwise.
    #[error("a name that is no identifier, or is there twice; it is written as one")]
    Identifier,
    /// USD has no frames.
    #[error("a frame, which the format has not")]
    Frame,
    /// A mass of 0 is none in USD, and so is what stands beside it.
    #[error("an inertia without a mass; the format takes a mass of 0 for one that is not given")]
    InertiaAlone,
    /// A number beyond single precision.
    #[error("a mass or inertia that single precision does not hold")]
    BeyondSingle,
    /// The name is empty, contains a control character, or looks like a macro of xacro.
    #[error("a name that is empty, holds a control character or reads as a macro; rename it")]
    BadName,
    /// The name occurs twice where the format needs it to be unique.
    #[error("the name stands twice where the format asks for unique ones (links and frames share names); rename one")]
    RepeatedName,
    /// The name is reserved by the format.
    #[error("the name 'world' is the root's own; rename it")]
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
            | Self::FreePlacement
            | Self::Identifier
            | Self::Frame
            | Self::InertiaAlone => true,
            Self::JointType { .. }
            | Self::Deforms
            | Self::Massless
            | Self::Unphysical
            | Self::BeyondSingle
            | Self::FreeBelow
            | Self::BadName
            | Self::RepeatedName
            | Self::ReservedName => false,
        }
    }
}

/// The bodies that deform.
pub(crate) fn deforming(robot: &Description) -> impl Iterator<Item = Loss> + '_ {
    let about = |(index, name): (usize, &str)| Loss { about: format!("continua[{index}] '{name}'"), reason: Reason::Deforms };
    robot.continua.iter().map(|continuum| continuum.name.as_str()).enumerate().map(about)
}

/// The residuals and the uncertain variables.
pub(crate) fn residuals(robot: &Description) -> impl Iterator<Item = Loss> + '_ {
    let residual = |name: &String| Loss { about: format!("the residual '{name}'"), reason: Reason::Residual };
    let uncertain = |name: &String| Loss { about: format!("the uncertain variable '{name}'"), reason: Reason::Uncertain };
    let variables = robot.uncertain.variables.iter().map(move |variable| uncertain(&variable.name));
    robot.residuals.iter().map(move |law| residual(&law.name)).chain(variables)
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
