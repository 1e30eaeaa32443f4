//! Small branched trees that show one kind of joint in the middle and at the tips, on a fixed and on a free base.

use super::parameters::{Parameters, words};
use super::parts::{COMMON, MOVABLE, random_body, random_kind};
use super::{BadFamily, Base};
use crate::{BodyDescription, Description, JointType, Random};
use std::fmt;

/// The joint that a [`Joints`] robot shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Kind {
    /// Rotation about an axis.
    #[default]
    Revolute,
    /// Translation along an axis.
    Prismatic,
    /// Screw.
    Helical,
    /// Rotation about a point.
    Spherical,
    /// Motion in a plane.
    Planar,
    /// Rotation about x, then y.
    Universal,
    /// Every kind, each in the middle and at a tip.
    Mixed,
    /// Every kind but screws, which not every engine has.
    Common,
}

words!(Kind {
    Revolute => "revolute",
    Prismatic => "prismatic",
    Helical => "helical",
    Spherical => "spherical",
    Planar => "planar",
    Universal => "universal",
    Mixed => "mixed",
    Common => "common",
});

/// How much of a tree stands around the joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Shape {
    /// The joint in the middle and at the tips of a branched tree.
    #[default]
    Branched,
    /// The joint alone, on the world or on a heavy free body: so well conditioned that errors have nothing to hide behind.
    Single,
}

words!(Shape { Branched => "branched", Single => "single" });

/// A root with two branches for each kind shown: the joint on the root, a revolute forearm on it, and the joint again at the tip of one
/// branch; in the other branch the joint is the tip. Skew axes and placements, full inertias, masses within a factor of 1.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Joints {
    /// The joint shown.
    pub kind: Kind,
    /// On a fixed base the root of a branched tree is a revolute body; a free base is the root itself.
    pub base: Base,
    /// How much of a tree there is.
    pub shape: Shape,
}

/// Masses of the bodies, kg.
const MASS: (f64, f64) = (0.8, 1.2);
/// Mass of the free body that carries single joints, kg.
const HEAVY: (f64, f64) = (8.0, 12.0);
/// The bodies are the same in every run and every variant.
const SEED: u64 = 1;

impl Joints {
    pub(super) fn read(parameters: &mut Parameters) -> Result<Self, BadFamily> {
        Ok(Self {
            kind: parameters.take("kind", Kind::default(), Kind::WORDS)?,
            base: parameters.take("base", Base::default(), Base::WORDS)?,
            shape: parameters.take("shape", Shape::default(), Shape::WORDS)?,
        })
    }

    pub(super) fn describe(&self) -> Description {
        let one = [self.kind.name()];
        let shown: &[&str] = match self.kind {
            Kind::Mixed => &MOVABLE,
            Kind::Common => &COMMON,
            _ => &one,
        };
        let (bodies, suffix) = match self.shape {
            Shape::Branched => (self.branched(shown), ""),
            Shape::Single => (self.single(shown), "-single"),
        };
        let name = format!("joints-{}-{}{suffix}", self.kind, self.base);
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

impl fmt::Display for Joints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "kind={},base={},shape={}", self.kind, self.base, self.shape)
    }
}
