//! What each command does with the sections of a robot's description: it uses one, or says by name that it does not.

use crate::fail::Fail;
use crate::message::tell;
use featherbench_model::{Description, Section};

/// Names of one section that are told; the description has them all.
const SHOWN: usize = 3;

/// Who gets a robot.
#[derive(Clone, Copy, Debug)]
pub enum Taker {
    /// `residuals`.
    Residuals,
    /// `uncertainty`, by the description's own variables or by a spread of all masses.
    Uncertainty { own: bool },
    /// `identify --excite`.
    Excitation,
    /// `identify` with a log.
    Identification,
    /// A suite, with or without the study of residuals.
    Suite { residuals: bool },
}

/// What is done with a section.
enum Treatment {
    /// The answer depends on it.
    Used,
    /// The answer is that of the robot without it.
    Told,
    /// An answer without it would be none of this robot.
    Refused,
}

impl Taker {
    fn name(self) -> &'static str {
        match self {
            Self::Residuals => "`residuals`",
            Self::Uncertainty { .. } => "`uncertainty`",
            Self::Excitation => "`identify --excite`",
            Self::Identification => "`identify`",
            Self::Suite { .. } => "the suite",
        }
    }

    fn treatment(self, section: Section) -> Treatment {
        use Treatment::{Refused, Told, Used};
        match (self, section) {
            // A tree alone moves otherwise, and its torques are not those of joints that share a load. Continua a rigid model refuses by itself.
            (Self::Suite { .. }, Section::Loops) => Told,
            (_, Section::Loops | Section::Continua) => Refused,
            (Self::Suite { residuals }, Section::Residuals) if residuals => Used,
            (Self::Suite { .. }, Section::Residuals | Section::Uncertain) => Told,
            // CONVENTIONS says for all robots what becomes of them.
            (Self::Suite { .. }, _) => Used,
            (_, Section::Frames) => Told,
            (_, Section::Armature) => Used,
            (Self::Residuals, Section::Residuals) => Used,
            (_, Section::Residuals) => Told,
            (Self::Uncertainty { own }, Section::Uncertain) if own => Used,
            (_, Section::Uncertain) => Told,
            (Self::Excitation | Self::Identification, Section::Damping | Section::Friction | Section::EffortLimits) => Used,
            (Self::Excitation, Section::PositionLimits | Section::SpeedLimits) => Used,
            (_, Section::Damping | Section::Friction | Section::PositionLimits | Section::SpeedLimits | Section::EffortLimits) => Told,
        }
    }
}

/// Refuses a robot with a section without which an answer would be false, tells the others that are not used, and returns their words.
pub fn heed(robot: &Description, file: &str, taker: Taker) -> Result<Vec<&'static str>, Fail> {
    let (mut unused, mut parts) = (Vec::new(), Vec::new());
    for (section, names) in robot.sections() {
        let word = section.name();
        let listed = listed(&names);
        match taker.treatment(section) {
            Treatment::Used => {}
            Treatment::Told => {
                unused.push(word);
                parts.push(format!("{word} ({listed})"));
            }
            Treatment::Refused => {
                return Err(Fail::input(format!(
                    "{file}: the robot has {word} ({listed}), and {} computes with rigid trees alone: its answer would not be this robot's; \
                     take the section '{word}' out of a copy of the description if you mean the tree without it",
                    taker.name()
                )));
            }
        }
    }
    if !parts.is_empty() {
        tell!("note: {file}: {} does not use {}", taker.name(), parts.join(", "));
    }
    Ok(unused)
}

/// The first names, and how many there are more.
fn listed(names: &[&str]) -> String {
    let more = names.len().saturating_sub(SHOWN);
    let first = names[..names.len() - more].join(", ");
    if more == 0 { first } else { format!("{first} and {more} more") }
}
