//! Chains of identical links whose every number is dyadic, so that all engines hold bit-identical models.

use super::parameters::{MOST_LINKS, parameters, require, words};
use super::parts::{DYADIC_GRAVITY, LINK, X, Y, Z, dyadic_link};
use super::{BadFamily, Base};
use featherbench_model::{Description, JointType};

words! {
    /// The axes of a chain. (A *straight* chain is a state, q = 0, of either.)
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
    pub enum Layout {
        /// All axes along y: the chain moves in the vertical xz-plane.
        #[default]
        Planar => "planar",
        /// Axes x, y, z, x, …
        Spatial => "spatial",
    }
}

parameters! {
    /// `n` revolute links in a row: 0.5 m along x, 1 kg, centre of mass halfway, inertia diag(2⁻⁷, 2⁻⁵, 2⁻⁵), gravity (0, 0, −9.8125).
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Chain {
        /// Revolute links; a free base is one link more.
        pub n: usize = 10, "a number of links", "{}";
        /// The layout of the axes.
        pub layout: Layout = Layout::Planar, Layout::WORDS, "{}";
        /// Factor on the last link's mass and inertia.
        pub tip_scale: f64 = 1.0, "a positive number", "{:?}";
        /// The first joint is at (offset, offset, 0), m.
        pub base_offset: f64 = 0.0, "a distance in metres", "{:?}";
        /// The base of the chain.
        pub base: Base = Base::Fixed, Base::WORDS, "{}";
    }
}

impl Chain {
    pub(super) fn check(&self) -> Result<(), BadFamily> {
        require((1..=MOST_LINKS).contains(&self.n), "chain", "n", self.n, "1 to 1000000")?;
        require(self.tip_scale.is_normal() && self.tip_scale > 0.0, "chain", "tip_scale", self.tip_scale, "a positive number")?;
        require(self.base_offset.is_finite(), "chain", "base_offset", self.base_offset, "a finite distance in metres")
    }

    pub(super) fn describe(&self) -> Description {
        let origin = [self.base_offset, self.base_offset, 0.0];
        let mut bodies = Vec::with_capacity(self.n + 1);
        if self.base == Base::Free {
            bodies.push(dyadic_link("base".to_owned(), None, JointType::Free, origin));
        }
        for k in 0..self.n {
            let axis = match self.layout {
                Layout::Planar => Y,
                Layout::Spatial => [X, Y, Z][k % 3],
            };
            let parent = bodies.len().checked_sub(1);
            let at = if parent.is_none() { origin } else { [LINK, 0.0, 0.0] };
            bodies.push(dyadic_link(format!("link_{}", k + 1), parent, JointType::Revolute { axis }, at));
        }
        if let Some(tip) = bodies.last_mut() {
            tip.mass *= self.tip_scale;
            tip.inertia = tip.inertia.map(|entry| entry * self.tip_scale);
        }
        Description { name: self.name(), gravity: DYADIC_GRAVITY, bodies, ..Description::default() }
    }

    fn name(&self) -> String {
        let mut name = format!("chain-{}-{}", self.layout, self.n);
        if self.base == Base::Free {
            name += "-free";
        }
        if self.tip_scale != 1.0 {
            name += &format!("-tip{:e}", self.tip_scale);
        }
        if self.base_offset != 0.0 {
            name += &format!("-offset{:e}", self.base_offset);
        }
        name
    }
}
