//! The robot that is learned: a hanging arm of uniform rods.

use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Placement};

/// A planar arm of uniform rods that hangs down at q = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// Mass of each rod, kg.
    pub masses: Vec<f64>,
    /// Length of each rod, m; as many as masses.
    pub lengths: Vec<f64>,
    /// Gravity, m/s².
    pub gravity: f64,
}

impl Arm {
    /// It as a robot. The joints turn about y.
    pub fn describe(&self) -> Description {
        let rods: Vec<(f64, f64)> = self.masses.iter().copied().zip(self.lengths.iter().copied()).collect();
        let rod = |(k, &(mass, length)): (usize, &(f64, f64))| {
            let above = if k > 0 { rods[k - 1].1 } else { 0.0 };
            BodyDescription {
                name: format!("rod {k}"),
                parent: k.checked_sub(1),
                mass,
                com: [0.0, 0.0, -length / 2.0],
                inertia: [mass * length * length / 12.0, 0.0, 0.0, mass * length * length / 12.0, 0.0, 0.0],
                joint: JointDescription {
                    name: format!("joint {k}"),
                    kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] },
                    placement: Placement { translation: [0.0, 0.0, -above], ..Placement::default() },
                    ..JointDescription::default()
                },
            }
        };
        let bodies = rods.iter().enumerate().map(rod).collect();
        Description { name: format!("arm of {} rods", rods.len()), gravity: [0.0, 0.0, -self.gravity], bodies, ..Description::default() }
    }
}
