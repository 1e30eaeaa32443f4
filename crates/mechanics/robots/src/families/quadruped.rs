//! A quadruped designed for this project, about 24 kg: a free trunk with six dofs and four legs of three.

use super::parts::{GRAVITY, Part, X, Y, free_box, limb};
use featherbench_model::Description;

/// The 18-dof quadruped; x forward, y left, z up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Quadruped;

impl Quadruped {
    pub(super) fn describe(&self) -> Description {
        let mut bodies = vec![free_box("trunk", 12.0, [0.005, 0.0, 0.01], [0.50, 0.20, 0.12])];
        for (end, forward) in [("front", 1.0), ("hind", -1.0)] {
            for (flank, side) in [("left", 1.0), ("right", -1.0)] {
                limb(&mut bodies, 0, &format!("{end}_{flank}_"), side, &leg(forward));
            }
        }
        Description { name: "quadruped".to_owned(), gravity: GRAVITY, bodies, ..Description::default() }
    }
}

#[rustfmt::skip] // a table
fn leg(forward: f64) -> [Part; 3] {
    [
        Part { name: "hip", axis: X, at: [0.22 * forward, 0.06, 0.0], mass: 0.9, com: [0.01 * forward, 0.02, 0.0], size: [0.08, 0.08, 0.08], range: (-0.8, 0.8), effort: 33.0 },
        Part { name: "thigh", axis: Y, at: [0.0, 0.08, 0.0], mass: 1.6, com: [0.0, -0.01, -0.05], size: [0.07, 0.05, 0.22], range: (-1.2, 3.2), effort: 33.0 },
        Part { name: "shank", axis: Y, at: [0.0, 0.0, -0.22], mass: 0.45, com: [0.005, 0.0, -0.11], size: [0.03, 0.03, 0.24], range: (-2.7, -0.8), effort: 33.0 },
    ]
}
