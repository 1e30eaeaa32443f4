//! Classes of robots, by their properties: which robots a known deviation, or a lack of an engine, is about.

use featherbench_model::JointType;
use featherbench_results::{Base, Feature, Properties};
use serde::Deserialize;

/// The robots that meet every condition that is given. Without a condition it is any robot.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct RobotClass {
    /// One of its joints is of one of these kinds.
    joint: Option<Vec<String>>,
    /// Whether a joint has armature; or the kinds of joints of which one has it.
    armature: Option<Armature>,
    /// How the first body is attached.
    base: Option<Base>,
    /// It has more degrees of freedom than this.
    dofs_above: Option<u64>,
    /// The joint of its first body is farther from the origin of the world than this, m.
    offset_above: Option<f64>,
    /// Its heaviest body is heavier than its lightest one with a mass by more than this factor.
    mass_ratio_above: Option<f64>,
    /// It has one of these features.
    feature: Option<Vec<Feature>>,
    /// It has none of these features.
    without: Option<Vec<Feature>>,
    /// It is one of these robots, where no property tells it from others: names; a trailing `*` stands for any rest.
    robots: Option<Vec<String>>,
}

/// The condition on armature.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "true, false, or a list of kinds of joints")]
enum Armature {
    /// Whether there is any.
    Any(bool),
    /// One of the joints that have it is of one of these kinds.
    On(Vec<String>),
}

impl RobotClass {
    /// Whether a robot is in the class. Nothing is known of a robot without properties: it is in no class that has a condition on them.
    pub fn holds(&self, robot: &str, properties: Option<&Properties>) -> bool {
        self.robots.as_ref().is_none_or(|robots| named(robots, robot))
            && (!self.needs_properties() || properties.is_some_and(|properties| self.holds_of(properties)))
    }

    /// The words that are no kinds of joints, to be told as an error.
    pub(crate) fn unknown_joint(&self) -> Option<&str> {
        let with_armature = match &self.armature {
            Some(Armature::On(kinds)) => kinds.as_slice(),
            Some(Armature::Any(_)) | None => &[],
        };
        let kinds = self.joint.iter().flatten().chain(with_armature);
        kinds.map(String::as_str).find(|kind| !JointType::names().contains(kind))
    }

    /// The names of robots in it: exceptions that no property explains.
    pub fn names(&self) -> &[String] {
        self.robots.as_deref().unwrap_or_default()
    }

    fn needs_properties(&self) -> bool {
        let of_names = Self { robots: self.robots.clone(), ..Self::default() };
        *self != of_names
    }

    fn holds_of(&self, robot: &Properties) -> bool {
        let share = |kinds: &[String], held: &[String]| kinds.iter().any(|kind| held.contains(kind));
        let has = |features: &Vec<Feature>| features.iter().any(|feature| robot.features.contains(feature));
        let armature = |condition: &Armature| match condition {
            Armature::Any(any) => *any != robot.armature.is_empty(),
            Armature::On(kinds) => share(kinds, &robot.armature),
        };
        self.joint.as_ref().is_none_or(|kinds| share(kinds, &robot.joints))
            && self.armature.as_ref().is_none_or(armature)
            && self.base.is_none_or(|base| base == robot.base)
            && self.dofs_above.is_none_or(|limit| robot.dofs > limit)
            && self.offset_above.is_none_or(|limit| robot.offset > limit)
            && self.mass_ratio_above.is_none_or(|limit| robot.mass_ratio > limit)
            && self.feature.as_ref().is_none_or(has)
            && !self.without.as_ref().is_some_and(has)
    }
}

/// Whether a list of names contains a name; a trailing `*` stands for any rest.
pub(crate) fn named(names: &[String], name: &str) -> bool {
    names.iter().any(|known| known.strip_suffix('*').map_or(known == name, |stem| name.starts_with(stem)))
}
