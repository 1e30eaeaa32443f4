//! Small branched trees that show one kind of joint in the middle and at the tips, on a fixed and on a free base.

use super::parameters::{Parameters, words};
use super::parts::{MOVABLE, random_body, random_kind};
use super::{BadFamily, Base};
use crate::{Description, JointType, Random};
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
}

words!(Kind {
    Revolute => "revolute",
    Prismatic => "prismatic",
    Helical => "helical",
    Spherical => "spherical",
    Planar => "planar",
    Universal => "universal",
    Mixed => "mixed",
});

/// A root with two branches for each kind shown: the joint on the root, a revolute forearm on it, and the joint again at the tip of one
/// branch; in the other branch the joint is the tip. Skew axes and placements, full inertias, masses within a factor of 1.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Joints {
    /// The joint shown.
    pub kind: Kind,
    /// On a fixed base the root is a revolute body; a free base is the root itself.
    pub base: Base,
}

/// Masses of the bodies, kg.
const MASS: (f64, f64) = (0.8, 1.2);
/// The bodies are the same in every run and every variant.
const SEED: u64 = 1;

impl Joints {
    pub(super) fn read(parameters: &mut Parameters) -> Result<Self, BadFamily> {
        Ok(Self {
            kind: parameters.take("kind", Kind::default(), Kind::WORDS)?,
            base: parameters.take("base", Base::default(), Base::WORDS)?,
        })
    }

    pub(super) fn describe(&self) -> Description {
        let mut random = Random::named(SEED, "joints");
        let mut bodies = Vec::new();
        let root = match self.base {
            Base::Fixed => random_kind(&mut random, "revolute"),
            Base::Free => JointType::Free,
        };
        bodies.push(random_body(&mut random, "root".to_owned(), None, root, MASS, false));
        let one = [self.kind.name()];
        let shown: &[&str] = if self.kind == Kind::Mixed { &MOVABLE } else { &one };
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
        Description { name: format!("joints-{}-{}", self.kind, self.base), gravity: [1.25, -2.5, -9.25], bodies, ..Description::default() }
    }
}

impl fmt::Display for Joints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "kind={},base={}", self.kind, self.base)
    }
}
