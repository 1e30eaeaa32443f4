//! Bricard's six-bar: six hinges in a ring, each at a right angle to the next. Grübler counts 0 dofs, and it moves.
//!
//! The ring begins along six edges of a cube: +x, +y, +z, −x, −y and back along −z, which is the ground. Each hinge is at a right angle to
//! both of its links. The loop's hinge has five rows for five dofs, of which four are independent.
//! Source: IFToMM T.C. for Multibody Dynamics, benchmark A04 (five rods of 1 kg and 1 m); R. Bricard (1897). Units: SI.

use super::parts::{closed, rod};
use crate::mechanism::{BadMechanism, Mechanism};
use featherbench_model::LoopMotion;
use featherbench_model::{Description, Placement};

/// Bricard's six-bar of five equal rods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bricard {
    /// Length of a rod, m.
    pub length: f64,
    /// Mass of a rod, kg.
    pub mass: f64,
    /// Gravitational acceleration, m/s².
    pub gravity: [f64; 3],
}

impl Default for Bricard {
    /// Rods of 1 kg and 1 m, gravity along −y.
    fn default() -> Self {
        Self { length: 1.0, mass: 1.0, gravity: [0.0, -9.81, 0.0] }
    }
}

impl Bricard {
    /// The robot, whose loop is closed at q = 0.
    ///
    /// # Errors
    /// [`BadMechanism`] when a mass or length makes no sense.
    pub fn mechanism(&self) -> Result<Mechanism, BadMechanism> {
        Mechanism::of(&self.description())
    }

    /// The robot as a description that has the loops' joints in its section `loops`.
    pub fn description(&self) -> Description {
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let long = |direction: [f64; 3], sign: f64| direction.map(|part| sign * part * self.length);
        let rods = [(y, long(x, 1.0)), (z, long(y, 1.0)), (x, long(z, 1.0)), (y, long(x, -1.0)), (z, long(y, -1.0))];
        let mut place = [0.0; 3];
        let mut bodies = Vec::new();
        for (k, (axis, end)) in rods.into_iter().enumerate() {
            bodies.push(rod(&format!("rod {k}"), k.checked_sub(1), place, axis, end, self.mass));
            place = end;
        }
        // The last hinge turns about x, at the end of the last rod and at the far end of the ground's edge.
        let about_x = |translation| Placement { rotation: [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], translation };
        let ends = [(None, about_x([0.0, 0.0, self.length])), (Some(4), about_x(place))];
        let loops = vec![closed("loop".into(), ends, LoopMotion::Revolute)];
        Description { name: "bricard".into(), gravity: self.gravity, bodies, loops, ..Description::default() }
    }
}
