//! Snakes: a floating chain of dyadic links whose axes alternate, as in snake robots.

use super::BadFamily;
use super::parameters::{MOST_LINKS, parameters, require};
use super::parts::{DYADIC_GRAVITY, LINK, Y, Z, dyadic_link};
use featherbench_model::{Description, JointType};

parameters! {
    /// `n` dyadic links in a row, the first on a free joint: 6 + n − 1 dofs. The axes of the joints are z, y, z, …: yaw, pitch, yaw.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Snake {
        /// Links, the free one included.
        pub n: usize = 20, "a number of links", "{}";
    }
}

impl Snake {
    pub(super) fn check(&self) -> Result<(), BadFamily> {
        require((1..=MOST_LINKS).contains(&self.n), "snake", "n", self.n, "1 to 1000000")
    }

    pub(super) fn describe(&self) -> Description {
        let link = |k: usize| match k.checked_sub(1) {
            None => dyadic_link("head".to_owned(), None, JointType::Free, [0.0; 3]),
            Some(parent) => {
                let axis = if k % 2 == 1 { Z } else { Y };
                dyadic_link(format!("link_{k}"), Some(parent), JointType::Revolute { axis }, [LINK, 0.0, 0.0])
            }
        };
        let bodies = (0..self.n).map(link).collect();
        Description { name: format!("snake-{}", self.n), gravity: DYADIC_GRAVITY, bodies, ..Description::default() }
    }
}
