//! Stars: links that are all joined to the world, so that the mass matrix is diagonal.

use super::BadFamily;
use super::parameters::{MOST_LINKS, parameters, require};
use super::parts::{DYADIC_GRAVITY, X, Y, Z, dyadic_link};
use featherbench_model::{Description, JointType};

parameters! {
    /// `n` revolute dyadic links on the world, side by side along y, axes x, y, z cycling.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Star {
        /// Links.
        pub n: usize = 30, "a number of links", "{}";
    }
}

impl Star {
    pub(super) fn check(&self) -> Result<(), BadFamily> {
        require((1..=MOST_LINKS).contains(&self.n), "star", "n", self.n, "1 to 1000000")
    }

    pub(super) fn describe(&self) -> Description {
        let link = |k: usize| {
            let kind = JointType::Revolute { axis: [X, Y, Z][k % 3] };
            dyadic_link(format!("ray_{}", k + 1), None, kind, [0.0, k as f64, 0.0])
        };
        let bodies = (0..self.n).map(link).collect();
        Description { name: format!("star-{}", self.n), gravity: DYADIC_GRAVITY, bodies, ..Description::default() }
    }
}
