//! Random trees with random bodies: skew axes, skew placements, full inertias.

use super::parameters::{MOST_LINKS, Parameters, require, words};
use super::parts::{COMMON, MOVABLE, random_body, random_kind};
use super::{BadFamily, Base};
use crate::Random;
use featherbench_model::{Description, JointType};
use std::fmt;

/// Which joints a random tree has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Mix {
    /// Revolute joints alone.
    #[default]
    Revolute,
    /// Revolute, prismatic, helical, spherical, planar and universal joints, equally likely.
    All,
    /// The same without screws, which not every engine has.
    Common,
}

words!(Mix { Revolute => "revolute", All => "all", Common => "common" });

/// A random tree. Body k depends on the seed and k only, the tree's shape on the seed and `spread`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tree {
    /// Jointed bodies; a free base is one body more.
    pub n: usize,
    /// The seed of every draw.
    pub seed: u64,
    /// The probability that a body starts a new branch, at an ancestor of the body before it chosen uniformly.
    /// The mean depth is about 2/spread: 0 gives a chain, 1 a shallow tree.
    pub spread: f64,
    /// Which joints it has.
    pub joints: Mix,
    /// The base.
    pub base: Base,
    /// Whether one-dof joints have armature.
    pub armature: bool,
}

impl Default for Tree {
    fn default() -> Self {
        Self { n: 20, seed: 1, spread: 0.3, joints: Mix::Revolute, base: Base::Fixed, armature: false }
    }
}

/// Masses of the bodies, kg.
const MASS: (f64, f64) = (0.5, 2.0);

impl Tree {
    pub(super) fn read(parameters: &mut Parameters) -> Result<Self, BadFamily> {
        let default = Self::default();
        Ok(Self {
            n: parameters.take("n", default.n, "a number of bodies")?,
            seed: parameters.take("seed", default.seed, "a whole number")?,
            spread: parameters.take("spread", default.spread, "a probability")?,
            joints: parameters.take("joints", default.joints, Mix::WORDS)?,
            base: parameters.take("base", default.base, Base::WORDS)?,
            armature: parameters.take("armature", default.armature, "true or false")?,
        })
    }

    pub(super) fn check(&self) -> Result<(), BadFamily> {
        require((1..=MOST_LINKS).contains(&self.n), "tree", "n", self.n, "1 to 1000000")?;
        require((0.0..=1.0).contains(&self.spread), "tree", "spread", self.spread, "a probability, 0 to 1")
    }

    pub(super) fn describe(&self) -> Description {
        let mut shape = Random::named(self.seed, "tree/shape");
        let gravity = shape.direction::<3>().map(|x| 9.81 * x);
        let mut bodies = Vec::with_capacity(self.n + 1);
        // The bodies from the root to the one before; a free base never leaves it.
        let mut path: Vec<usize> = Vec::new();
        let mut kept = 0;
        if self.base == Base::Free {
            let mut random = Random::named(self.seed, "tree/base");
            bodies.push(random_body(&mut random, "base".to_owned(), None, JointType::Free, MASS, false));
            path.push(0);
            kept = 1;
        }
        for k in 1..=self.n {
            let branches = shape.unit() < self.spread;
            let place = shape.unit();
            if branches {
                path.truncate(kept + (place * (path.len() - kept) as f64) as usize);
            }
            let mut random = Random::named(self.seed, &format!("tree/body/{k}"));
            let word = match self.joints {
                Mix::Revolute => "revolute",
                Mix::All => MOVABLE[random.below(MOVABLE.len())],
                Mix::Common => COMMON[random.below(COMMON.len())],
            };
            let kind = random_kind(&mut random, word);
            bodies.push(random_body(&mut random, format!("body_{k}"), path.last().copied(), kind, MASS, self.armature));
            path.push(bodies.len() - 1);
        }
        Description { name: self.name(), gravity, bodies, ..Description::default() }
    }

    fn name(&self) -> String {
        let base = if self.base == Base::Free { "-free" } else { "" };
        let armature = if self.armature { "-armature" } else { "" };
        format!("tree-{}-{}-spread{}-seed{}{base}{armature}", self.joints, self.n, self.spread, self.seed)
    }
}

impl fmt::Display for Tree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { n, seed, spread, joints, base, armature } = self;
        write!(f, "n={n},seed={seed},spread={spread:?},joints={joints},base={base},armature={armature}")
    }
}
