//! Balanced binary trees of dyadic links.

use super::BadFamily;
use super::parameters::{parameters, require};
use super::parts::{DYADIC_GRAVITY, LINK, X, Y, Z, dyadic_link};
use featherbench_model::{Description, JointType};

parameters! {
    /// A balanced binary tree of `2^depth − 1` revolute links, axes x, y, z cycling with the level.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct BinaryTree {
        /// Levels.
        pub depth: u32 = 6, "a number of levels", "{}";
    }
}

/// Half the distance of two siblings' joints, m.
const ASIDE: f64 = 0.125;

impl BinaryTree {
    pub(super) fn check(&self) -> Result<(), BadFamily> {
        require((1..=20).contains(&self.depth), "binary_tree", "depth", self.depth, "1 to 20")
    }

    pub(super) fn describe(&self) -> Description {
        let mut bodies = Vec::with_capacity((1 << self.depth) - 1);
        // What is still to be built: number (children of k are 2k and 2k+1), level, parent.
        let mut waiting = vec![(1_usize, 0_u32, None)];
        while let Some((number, level, parent)) = waiting.pop() {
            let at = match parent {
                None => [0.0; 3],
                Some(_) => [LINK, if number % 2 == 0 { ASIDE } else { -ASIDE }, 0.0],
            };
            let axis = [X, Y, Z][level as usize % 3];
            let body = bodies.len();
            bodies.push(dyadic_link(format!("node_{number}"), parent, JointType::Revolute { axis }, at));
            if level + 1 < self.depth {
                waiting.push((2 * number + 1, level + 1, Some(body)));
                waiting.push((2 * number, level + 1, Some(body)));
            }
        }
        Description { name: format!("binary-tree-{}", self.depth), gravity: DYADIC_GRAVITY, bodies, ..Description::default() }
    }
}
