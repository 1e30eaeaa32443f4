//! Small branched trees that show one kind of joint in the middle and at the tips, on a fixed and on a free base.

use super::Base;
use super::parameters::{parameters, words};
use super::parts::{ARMATURE, COMMON, MOVABLE, random_body, random_kind};
use crate::Random;
use featherbench_model::{BodyDescription, Description, JointType};

words! {
    /// The joint that a [`Joints`] robot shows.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
    pub enum Kind {
        /// Rotation about an axis.
        #[default]
        Revolute => "revolute",
        /// Translation along an axis.
        Prismatic => "prismatic",
        /// Screw.
        Helical => "helical",
        /// Rotation about a point.
        Spherical => "spherical",
        /// Motion in a plane.
        Planar => "planar",
        /// Rotation about x, then y.
        Universal => "universal",
        /// Motion along x, y and z.
        Translation => "translation",
        /// Rotation about an axis, and motion along it.
        Cylindrical => "cylindrical",
        /// Rotation about z, then y, then x.
        EulerZyx => "euler_zyx",
        /// Free motion, in the middle of a tree as well.
        Free => "free",
        /// The kinds from revolute to universal, each in the middle and at a tip.
        Mixed => "mixed",
        /// The same without screws, which not every engine has.
        Common => "common",
        /// Every single kind, each in the middle and at a tip.
        All => "all",
    }
}

impl Kind {
    /// The words of the joints that it shows.
    fn shown(self) -> Vec<&'static str> {
        match self {
            Self::Mixed => MOVABLE.to_vec(),
            Self::Common => COMMON.to_vec(),
            Self::All => Self::ALL.iter().filter(|kind| kind.is_single()).map(|kind| kind.name()).collect(),
            one => vec![one.name()],
        }
    }

    /// Whether it is one kind of joint rather than several.
    pub fn is_single(self) -> bool {
        !matches!(self, Self::Mixed | Self::Common | Self::All)
    }
}

words! {
    /// The size of the tree around the joint.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
    pub enum Shape {
        /// The joint in the middle and at the tips of a branched tree.
        #[default]
        Branched => "branched",
        /// The joint alone, on the world or on a heavy free body. This is so well conditioned that errors are easy to see.
        Single => "single",
    }
}

parameters! {
    /// A root with two branches for each kind shown. In one branch the joint is on the root, a revolute forearm on it, and the joint again at
    /// the tip. In the other branch the joint is the tip. Axes and placements are skew, inertias full, masses within a factor of 1.5.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Joints {
        /// The joint shown.
        pub kind: Kind = Kind::Revolute, Kind::WORDS, "{}";
        /// On a fixed base the root of a branched tree is a revolute body; a free base is the root itself.
        pub base: Base = Base::Fixed, Base::WORDS, "{}";
        /// The size of the tree.
        pub shape: Shape = Shape::Branched, Shape::WORDS, "{}";
        /// Whether every joint but free ones has armature on each of its degrees of freedom.
        pub armature: bool = false, "true or false", "{}";
    }
}

/// Masses of the bodies, kg.
const MASS: (f64, f64) = (0.8, 1.2);
/// Mass of the free body that carries single joints, kg.
const HEAVY: (f64, f64) = (8.0, 12.0);
/// The bodies are the same in every run and every variant.
const SEED: u64 = 1;

impl Joints {
    pub(super) fn describe(&self) -> Description {
        let shown = self.kind.shown();
        let (mut bodies, suffix) = match self.shape {
            Shape::Branched => (self.branched(&shown), ""),
            Shape::Single => (self.single(&shown), "-single"),
        };
        if self.armature {
            // A separate stream, so that the switch changes nothing else.
            let mut random = Random::named(SEED, "joints/armature");
            for joint in bodies.iter_mut().map(|body| &mut body.joint).filter(|joint| joint.kind != JointType::Free) {
                joint.armature = (0..joint.kind.nv()).map(|_| random.uniform(ARMATURE.0, ARMATURE.1)).collect();
            }
        }
        let armature = if self.armature { "-armature" } else { "" };
        let name = format!("joints-{}-{}{suffix}{armature}", self.kind, self.base);
        Description { name, gravity: [1.25, -2.5, -9.25], bodies, ..Description::default() }
    }

    fn branched(&self, shown: &[&str]) -> Vec<BodyDescription> {
        let mut random = Random::named(SEED, "joints");
        let mut bodies = Vec::new();
        let root = match self.base {
            Base::Fixed => random_kind(&mut random, "revolute"),
            Base::Free => JointType::Free,
        };
        bodies.push(random_body(&mut random, "root".to_owned(), None, root, MASS, false));
        for word in shown {
            let mut add = |name: &str, parent: usize, word: &str| {
                let kind = random_kind(&mut random, word);
                bodies.push(random_body(&mut random, name.to_owned(), Some(parent), kind, MASS, false));
                bodies.len() - 1
            };
            let middle = add(&format!("{word}_middle"), 0, word);
            let forearm = add(&format!("{word}_forearm"), middle, "revolute");
            add(&format!("{word}_tip"), forearm, word);
            let aside = add(&format!("{word}_side_arm"), middle, "revolute");
            add(&format!("{word}_side_tip"), aside, word);
        }
        bodies
    }

    fn single(&self, shown: &[&str]) -> Vec<BodyDescription> {
        let mut random = Random::named(SEED, "joints/single");
        let mut bodies = Vec::new();
        if self.base == Base::Free {
            bodies.push(random_body(&mut random, "root".to_owned(), None, JointType::Free, HEAVY, false));
        }
        let parent = (self.base == Base::Free).then_some(0);
        for word in shown {
            let kind = random_kind(&mut random, word);
            bodies.push(random_body(&mut random, (*word).to_owned(), parent, kind, MASS, false));
        }
        bodies
    }
}
