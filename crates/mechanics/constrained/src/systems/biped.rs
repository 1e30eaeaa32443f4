//! A biped on a free base whose knees and ankles are driven through six loops.
//!
//! Each leg has hip, knee and ankle about y. A crank on the thigh pushes the shin by a rod; two cranks on the shin push the foot by a rod
//! each, one on either side. Each rod's far end is a ball joint of the loop, at a distance from its hinge that makes a parallelogram of
//! crank, rod and lever. All hinges are parallel, so each loop has three rows of rank two: the row along y is redundant.
//!
//! Dofs: 6 + 2·3 + 6·2 = 24. Rows: 18, of rank 12. Mobility: 12, the base's six and three per leg. Grübler's count in space is 6.
//! The bodies are uniform rods, so all masses and lengths are arguments. Units: SI. Frames: x ahead, y left, z up.

use super::parts::{at, closed, rod};
use crate::mechanism::{BadMechanism, Mechanism};
use featherbench_model::LoopMotion;
use featherbench_model::{BodyDescription, Description, JointDescription, JointType};

/// A biped with six loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biped {
    /// Mass of the trunk, kg.
    pub trunk_mass: f64,
    /// Mass of a thigh and of a shin, kg.
    pub limb_mass: f64,
    /// Mass of a foot, kg.
    pub foot_mass: f64,
    /// Mass of a crank and of a rod, kg.
    pub drive_mass: f64,
    /// Length of a thigh and of a shin, m.
    pub limb: f64,
    /// Length of a foot, m.
    pub foot: f64,
    /// Length of a crank and of the lever that it pushes, m.
    pub crank: f64,
    /// Distance of the hips from the middle, m.
    pub hip: f64,
    /// Gravitational acceleration, m/s².
    pub gravity: f64,
}

impl Default for Biped {
    /// 30 kg, legs of 0.8 m.
    fn default() -> Self {
        Self {
            trunk_mass: 20.0,
            limb_mass: 2.0,
            foot_mass: 0.8,
            drive_mass: 0.1,
            limb: 0.4,
            foot: 0.2,
            crank: 0.06,
            hip: 0.1,
            gravity: 9.81,
        }
    }
}

impl Biped {
    /// The robot. At the neutral configuration it stands upright, and its loops are closed.
    ///
    /// # Errors
    /// [`BadMechanism`] when a mass or length makes no sense.
    pub fn mechanism(&self) -> Result<Mechanism, BadMechanism> {
        Mechanism::of(&self.description())
    }

    /// The robot as a description that has the loops' joints in its section `loops`.
    pub fn description(&self) -> Description {
        let y = [0.0, 1.0, 0.0];
        let down = [0.0, 0.0, -self.limb];
        let size = 0.3_f64;
        let moment = self.trunk_mass * size * size / 6.0;
        let free = JointDescription { kind: JointType::Free, ..JointDescription::default() };
        let inertia = [moment, 0.0, 0.0, moment, 0.0, moment];
        let trunk = BodyDescription {
            name: "trunk".into(),
            parent: None,
            mass: self.trunk_mass,
            com: [0.0, 0.0, 0.5 * size],
            inertia,
            joint: free,
        };
        let mut bodies = vec![trunk];
        let mut loops = Vec::new();
        for (side, sign) in [("left", 1.0), ("right", -1.0)] {
            let thigh = bodies.len();
            let named = |part: &str| format!("{side} {part}");
            bodies.push(rod(&named("thigh"), Some(0), [0.0, sign * self.hip, 0.0], y, down, self.limb_mass));
            bodies.push(rod(&named("shin"), Some(thigh), down, y, down, self.limb_mass));
            bodies.push(rod(&named("foot"), Some(thigh + 1), down, y, [self.foot, 0.0, 0.0], self.foot_mass));
            let (shin, foot) = (thigh + 1, thigh + 2);
            for (drive, base, pushed, aside) in
                [("knee", thigh, shin, 0.0), ("outer ankle", shin, foot, 0.03), ("inner ankle", shin, foot, -0.03)]
            {
                // Crank and lever point back, the rod down: a parallelogram with the limb between their hinges.
                let back = [-self.crank, 0.0, 0.0];
                let shifted = |[x, _, z]: [f64; 3]| [x, sign * aside, z];
                let (crank, pusher) = (named(&format!("{drive} crank")), named(&format!("{drive} rod")));
                bodies.push(rod(&crank, Some(base), shifted([0.0; 3]), y, back, self.drive_mass));
                bodies.push(rod(&pusher, Some(bodies.len() - 1), back, y, down, self.drive_mass));
                let ends = [(Some(pushed), at(shifted(back))), (Some(bodies.len() - 1), at(down))];
                loops.push(closed(named(&format!("{drive} loop")), ends, LoopMotion::Spherical));
            }
        }
        Description { name: "biped".into(), gravity: [0.0, 0.0, -self.gravity], bodies, loops, ..Description::default() }
    }
}
