//! A humanoid designed for this project, about 1.6 m and 52 kg: a free pelvis with six dofs, two legs of six, and three waist joints.
//! The waist carries two arms of seven and a head of one.

use super::BadFamily;
use super::parameters::{parameters, require};
use super::parts::{GRAVITY, Part, X, Y, Z, free_box, limb};
use featherbench_model::Description;

parameters! {
    /// The 36-dof humanoid; x forward, y left, z up.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Humanoid {
        /// Mass of each hand, kg; its size stays.
        pub hand_mass: f64 = 0.5, "a mass in kg", "{:?}";
    }
}

impl Humanoid {
    pub(super) fn check(&self) -> Result<(), BadFamily> {
        require(self.hand_mass.is_normal() && self.hand_mass > 0.0, "humanoid", "hand_mass", self.hand_mass, "a positive mass in kg")
    }

    pub(super) fn describe(&self) -> Description {
        let mut bodies = vec![free_box("pelvis", 7.0, [0.0, 0.0, 0.02], [0.16, 0.24, 0.14])];
        limb(&mut bodies, 0, "left_", 1.0, &leg());
        limb(&mut bodies, 0, "right_", -1.0, &leg());
        limb(&mut bodies, 0, "", 1.0, &waist());
        let torso = bodies.len() - 1;
        limb(&mut bodies, torso, "left_", 1.0, &arm(self.hand_mass));
        limb(&mut bodies, torso, "right_", -1.0, &arm(self.hand_mass));
        limb(&mut bodies, torso, "", 1.0, &head());
        let usual = self.hand_mass == Self::default().hand_mass;
        let name = if usual { "humanoid".to_owned() } else { format!("humanoid-hand{}", self.hand_mass) };
        Description { name, gravity: GRAVITY, bodies, ..Description::default() }
    }
}

#[rustfmt::skip] // a table
fn leg() -> [Part; 6] {
    [
        Part { name: "hip_yaw", axis: Z, at: [0.0, 0.10, -0.05], mass: 1.2, com: [0.0, 0.01, -0.03], size: [0.10, 0.10, 0.08], range: (-0.7, 0.9), effort: 60.0 },
        Part { name: "hip_roll", axis: X, at: [0.0, 0.0, -0.05], mass: 1.0, com: [0.01, 0.0, 0.0], size: [0.10, 0.08, 0.08], range: (-0.4, 0.8), effort: 90.0 },
        Part { name: "thigh", axis: Y, at: [0.0, 0.02, 0.0], mass: 5.0, com: [0.01, 0.0, -0.17], size: [0.13, 0.12, 0.36], range: (-2.0, 0.8), effort: 150.0 },
        Part { name: "shin", axis: Y, at: [0.0, 0.0, -0.37], mass: 2.8, com: [0.01, 0.0, -0.16], size: [0.09, 0.09, 0.34], range: (0.0, 2.3), effort: 150.0 },
        Part { name: "ankle", axis: Y, at: [0.0, 0.0, -0.36], mass: 0.3, com: [0.0, 0.0, 0.0], size: [0.05, 0.06, 0.05], range: (-0.9, 0.7), effort: 60.0 },
        Part { name: "foot", axis: X, at: [0.0, 0.0, -0.02], mass: 0.9, com: [0.03, 0.0, -0.03], size: [0.22, 0.09, 0.04], range: (-0.4, 0.4), effort: 40.0 },
    ]
}

#[rustfmt::skip] // a table
fn waist() -> [Part; 3] {
    [
        Part { name: "waist_yaw", axis: Z, at: [0.0, 0.0, 0.10], mass: 0.8, com: [0.0, 0.0, 0.02], size: [0.10, 0.12, 0.05], range: (-1.2, 1.2), effort: 80.0 },
        Part { name: "waist_roll", axis: X, at: [0.0, 0.0, 0.04], mass: 0.6, com: [0.0, 0.0, 0.01], size: [0.08, 0.10, 0.05], range: (-0.4, 0.4), effort: 80.0 },
        Part { name: "torso", axis: Y, at: [0.0, 0.0, 0.03], mass: 14.0, com: [0.01, 0.0, 0.20], size: [0.18, 0.30, 0.40], range: (-0.4, 0.9), effort: 80.0 },
    ]
}

#[rustfmt::skip] // a table
fn arm(hand_mass: f64) -> [Part; 7] {
    [
        Part { name: "shoulder_pitch", axis: Y, at: [0.0, 0.16, 0.33], mass: 0.7, com: [0.0, 0.03, 0.0], size: [0.08, 0.08, 0.08], range: (-2.8, 1.0), effort: 40.0 },
        Part { name: "shoulder_roll", axis: X, at: [0.0, 0.05, 0.0], mass: 0.6, com: [0.0, 0.01, -0.02], size: [0.07, 0.07, 0.08], range: (-0.2, 2.6), effort: 40.0 },
        Part { name: "upper_arm", axis: Z, at: [0.0, 0.01, -0.06], mass: 1.3, com: [0.0, 0.0, -0.10], size: [0.08, 0.08, 0.22], range: (-1.6, 1.6), effort: 25.0 },
        Part { name: "elbow", axis: Y, at: [0.01, 0.0, -0.20], mass: 0.5, com: [0.0, 0.0, -0.03], size: [0.07, 0.07, 0.08], range: (-2.4, 0.0), effort: 25.0 },
        Part { name: "forearm", axis: Z, at: [-0.01, 0.0, -0.06], mass: 0.9, com: [0.0, 0.0, -0.08], size: [0.06, 0.06, 0.18], range: (-2.0, 2.0), effort: 12.0 },
        Part { name: "wrist", axis: X, at: [0.0, 0.0, -0.18], mass: 0.2, com: [0.0, 0.0, -0.01], size: [0.04, 0.05, 0.04], range: (-0.6, 0.6), effort: 8.0 },
        Part { name: "hand", axis: Y, at: [0.0, 0.0, -0.02], mass: hand_mass, com: [0.01, 0.0, -0.07], size: [0.04, 0.08, 0.16], range: (-1.0, 1.0), effort: 8.0 },
    ]
}

#[rustfmt::skip] // a table
fn head() -> [Part; 1] {
    [Part { name: "head", axis: Z, at: [0.0, 0.0, 0.42], mass: 3.5, com: [0.02, 0.0, 0.11], size: [0.18, 0.15, 0.22], range: (-1.3, 1.3), effort: 10.0 }]
}
