//! Centipedes: a floating spine of dyadic links with two legs on each.

use super::BadFamily;
use super::parameters::{MOST_LINKS, parameters, require};
use super::parts::{DYADIC_GRAVITY, LINK, X, Y, Z, dyadic_link};
use featherbench_model::{BodyDescription, Description, JointType};

parameters! {
    /// `segments` dyadic links in a row, the first on a free joint, and on each a left and a right leg of `leg` revolute joints:
    /// 6 + segments − 1 + 2·leg·segments dofs.
    ///
    /// The axes of the spine are z, y, z, …; those of a leg z, x, x, ….
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Centipede {
        /// Links of the spine, the free one included.
        pub segments: usize = 10, "a number of links", "{}";
        /// Joints of each leg.
        pub leg: usize = 3, "a number of joints", "{}";
    }
}

/// Where a leg stands on its segment, m from the middle plane.
const ASIDE: f64 = 0.125;

impl Centipede {
    pub(super) fn check(&self) -> Result<(), BadFamily> {
        require((1..=MOST_LINKS).contains(&self.segments), "centipede", "segments", self.segments, "1 to 1000000")?;
        let most = (MOST_LINKS / self.segments - 1) / 2;
        require(self.leg <= most, "centipede", "leg", self.leg, &format!("0 to {most}, for 1000000 links in all"))
    }

    pub(super) fn describe(&self) -> Description {
        let mut bodies: Vec<BodyDescription> = Vec::with_capacity(self.segments * (1 + 2 * self.leg));
        let mut spine = None;
        for k in 0..self.segments {
            let (kind, at) = match spine {
                None => (JointType::Free, [0.0; 3]),
                Some(_) => (JointType::Revolute { axis: if k % 2 == 1 { Z } else { Y } }, [LINK, 0.0, 0.0]),
            };
            let segment = bodies.len();
            bodies.push(dyadic_link(format!("segment_{k}"), spine, kind, at));
            for (side, aside) in [("left", ASIDE), ("right", -ASIDE)] {
                for joint in 0..self.leg {
                    let (parent, at, axis) =
                        if joint == 0 { (segment, [0.5 * LINK, aside, 0.0], Z) } else { (bodies.len() - 1, [LINK, 0.0, 0.0], X) };
                    let name = format!("{side}_{k}_{joint}");
                    bodies.push(dyadic_link(name, Some(parent), JointType::Revolute { axis }, at));
                }
            }
            spine = Some(segment);
        }
        let name = format!("centipede-{}-{}", self.segments, self.leg);
        Description { name, gravity: DYADIC_GRAVITY, bodies, ..Description::default() }
    }
}
