//! Stars: links that are all joined to the world, so that the mass matrix is diagonal.

use super::BadFamily;
use super::parameters::{MOST_LINKS, Parameters, require};
use super::parts::{DYADIC_GRAVITY, X, Y, Z, dyadic_link};
use featherbench_model::{Description, JointType};
use std::fmt;

/// `n` revolute dyadic links on the world, side by side along y, axes x, y, z cycling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Star {
    /// Links.
    pub n: usize,
}

impl Default for Star {
    fn default() -> Self {
        Self { n: 30 }
    }
}

impl Star {
    pub(super) fn read(parameters: &mut Parameters) -> Result<Self, BadFamily> {
        Ok(Self { n: parameters.take("n", Self::default().n, "a number of links")? })
    }

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

impl fmt::Display for Star {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "n={}", self.n)
    }
}
