//! Platforms: many arms that share one floating base, so that the mass matrix has the shape of an arrow.

use super::BadFamily;
use super::parameters::{MOST_LINKS, parameters, require};
use super::parts::{DYADIC_GRAVITY, LINK, X, Y, Z, dyadic_link};
use featherbench_model::{BodyDescription, Description, JointType};

parameters! {
    /// A free platform that carries `robots` arms of `n` revolute dyadic links each: 6 + robots·n dofs.
    ///
    /// The arms stand a metre apart, √robots of them in each row (rounded down). Their axes are z, y, x, z, …. The platform has twice
    /// the mass of the arms.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Platform {
        /// Arms.
        pub robots: usize = 100, "a number of arms", "{}";
        /// Links of each arm.
        pub n: usize = 7, "a number of links", "{}";
    }
}

impl Platform {
    pub(super) fn check(&self) -> Result<(), BadFamily> {
        require((1..MOST_LINKS).contains(&self.robots), "platform", "robots", self.robots, "1 to 999999")?;
        let most = (MOST_LINKS - 1) / self.robots;
        require((1..=most).contains(&self.n), "platform", "n", self.n, &format!("1 to {most}, for 1000000 links in all"))
    }

    pub(super) fn describe(&self) -> Description {
        let links = self.robots * self.n;
        let mut bodies: Vec<BodyDescription> = Vec::with_capacity(1 + links);
        let mut base = dyadic_link("platform".to_owned(), None, JointType::Free, [0.0; 3]);
        base.mass *= (2 * links) as f64;
        base.inertia = base.inertia.map(|entry| entry * (2 * links) as f64);
        bodies.push(base);
        let row = self.robots.isqrt().max(1);
        for robot in 0..self.robots {
            for k in 0..self.n {
                let (parent, at) =
                    if k == 0 { (0, [(robot / row) as f64, (robot % row) as f64, 0.0]) } else { (bodies.len() - 1, [LINK, 0.0, 0.0]) };
                let axis = [Z, Y, X][k % 3];
                bodies.push(dyadic_link(format!("robot_{robot}_{k}"), Some(parent), JointType::Revolute { axis }, at));
            }
        }
        let name = format!("platform-{}-{}", self.robots, self.n);
        Description { name, gravity: DYADIC_GRAVITY, bodies, ..Description::default() }
    }
}
