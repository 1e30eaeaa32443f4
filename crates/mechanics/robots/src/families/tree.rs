//! Random trees with random bodies: skew axes, skew placements, full inertias.

use super::parameters::{MOST_LINKS, parameters, require, words};
use super::parts::{COMMON, MOVABLE, random_body, random_kind};
use super::{BadFamily, Base};
use crate::Random;
use featherbench_model::{Description, JointType};

words! {
    /// Which joints a random tree has.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
    pub enum Mix {
        /// Revolute joints alone.
        #[default]
        Revolute => "revolute",
        /// Revolute, prismatic, helical, spherical, planar and universal joints, equally likely.
        All => "all",
        /// The same without screws, which not every engine has.
        Common => "common",
        /// Prismatic joints alone.
        Prismatic => "prismatic",
        /// Screws alone.
        Helical => "helical",
        /// Spherical joints alone.
        Spherical => "spherical",
        /// Planar joints alone.
        Planar => "planar",
        /// Universal joints alone.
        Universal => "universal",
    }
}

parameters! {
    /// A random tree. Body k depends on the seed and k only, the tree's shape on the seed and `spread`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Tree {
        /// Jointed bodies; a free base is one body more.
        pub n: usize = 20, "a number of bodies", "{}";
        /// The seed of every draw.
        pub seed: u64 = 1, "a whole number", "{}";
        /// The probability that a body starts a new branch, at an ancestor of the body before it chosen uniformly.
        /// The mean depth is about 2/spread: 0 gives a chain, 1 a shallow tree.
        pub spread: f64 = 0.3, "a probability", "{:?}";
        /// Which joints it has.
        pub joints: Mix = Mix::Revolute, Mix::WORDS, "{}";
        /// The base.
        pub base: Base = Base::Fixed, Base::WORDS, "{}";
        /// Whether one-dof joints have armature.
        pub armature: bool = false, "true or false", "{}";
        /// Factor on the last body's mass and inertia.
        pub tip_scale: f64 = 1.0, "a positive number", "{:?}";
        /// The joints on the world are this far along x and y from where they were drawn, m.
        pub base_offset: f64 = 0.0, "a distance in metres", "{:?}";
    }
}

/// Masses of the bodies, kg.
const MASS: (f64, f64) = (0.5, 2.0);

impl Tree {
    pub(super) fn check(&self) -> Result<(), BadFamily> {
        require((1..=MOST_LINKS).contains(&self.n), "tree", "n", self.n, "1 to 1000000")?;
        require((0.0..=1.0).contains(&self.spread), "tree", "spread", self.spread, "a probability, 0 to 1")?;
        require(self.tip_scale.is_normal() && self.tip_scale > 0.0, "tree", "tip_scale", self.tip_scale, "a positive number")?;
        require(self.base_offset.is_finite(), "tree", "base_offset", self.base_offset, "a finite distance in metres")
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
                Mix::All => MOVABLE[random.below(MOVABLE.len())],
                Mix::Common => COMMON[random.below(COMMON.len())],
                one => one.name(),
            };
            let kind = random_kind(&mut random, word);
            bodies.push(random_body(&mut random, format!("body_{k}"), path.last().copied(), kind, MASS, self.armature));
            path.push(bodies.len() - 1);
        }
        if let Some(tip) = bodies.last_mut() {
            tip.mass *= self.tip_scale;
            tip.inertia = tip.inertia.map(|entry| entry * self.tip_scale);
        }
        for body in bodies.iter_mut().filter(|body| body.parent.is_none()) {
            let [x, y, z] = body.joint.placement.translation;
            body.joint.placement.translation = [x + self.base_offset, y + self.base_offset, z];
        }
        Description { name: self.name(), gravity, bodies, ..Description::default() }
    }

    fn name(&self) -> String {
        let base = if self.base == Base::Free { "-free" } else { "" };
        let armature = if self.armature { "-armature" } else { "" };
        let mut name = format!("tree-{}-{}-spread{}-seed{}{base}{armature}", self.joints, self.n, self.spread, self.seed);
        if self.tip_scale != 1.0 {
            name += &format!("-tip{:e}", self.tip_scale);
        }
        if self.base_offset != 0.0 {
            name += &format!("-offset{:e}", self.base_offset);
        }
        name
    }
}
