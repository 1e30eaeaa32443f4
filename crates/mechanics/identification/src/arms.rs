//! Arms by their Denavit–Hartenberg numbers: what the known ranks are asked on.
//!
//! The rank of the regressor depends on the axes and on gravity, and on inertias not at all, as long as these are general. So the arms have
//! drawn inertias: each link is a cloud of six point masses.

use crate::PseudoInertia;
use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Placement};
use featherbench_robots::Random;

/// Gravity, m/s².
const G: f64 = 9.81;

/// A serial arm of revolute joints: the numbers of J. Craig's convention (*Introduction to Robotics*, section 3.4).
///
/// Joint i follows frame i−1 by a turn about x and a distance along it, and then by a distance along its own axis z.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// Its name.
    pub name: String,
    /// Of each joint: the distance along x, m; the turn about x, °; the distance along z, m.
    pub joints: Vec<[f64; 3]>,
}

impl Arm {
    /// The Unimation PUMA 560. Source of the distances: B. Armstrong, O. Khatib & J. Burdick, *The explicit dynamic model and inertial
    /// parameters of the PUMA 560 arm* (1986).
    pub fn puma560() -> Self {
        let joints =
            [[0.0, 0.0, 0.0], [0.0, -90.0, 0.2435], [0.4318, 0.0, -0.0934], [-0.0203, 90.0, 0.4331], [0.0, -90.0, 0.0], [0.0, 90.0, 0.0]];
        Self { name: "puma560".into(), joints: joints.into() }
    }

    /// The Universal Robots UR5, by the maker's table of Denavit–Hartenberg numbers. A test compares its axes with those of its URDF.
    pub fn ur5() -> Self {
        let joints = [
            [0.0, 0.0, 0.089159],
            [0.0, 90.0, 0.0],
            [-0.425, 0.0, 0.0],
            [-0.39225, 0.0, 0.10915],
            [0.0, 90.0, 0.09465],
            [0.0, -90.0, 0.0823],
        ];
        Self { name: "ur5".into(), joints: joints.into() }
    }

    /// The Franka Emika Panda, by the maker's table of Denavit–Hartenberg numbers. A test compares its axes with those of its URDF.
    pub fn panda() -> Self {
        let joints = [
            [0.0, 0.0, 0.333],
            [0.0, -90.0, 0.0],
            [0.0, 90.0, 0.316],
            [0.0825, 90.0, 0.0],
            [-0.0825, -90.0, 0.384],
            [0.0, 90.0, 0.0],
            [0.088, 90.0, 0.0],
        ];
        Self { name: "panda".into(), joints: joints.into() }
    }

    /// The KUKA LBR iiwa 7: shoulder, elbow and wrist are spherical. Source: the joint twists of the Explicit-Robotics documentation.
    pub fn iiwa() -> Self {
        let joints = [
            [0.0, 0.0, 0.34],
            [0.0, -90.0, 0.0],
            [0.0, 90.0, 0.4],
            [0.0, 90.0, 0.0],
            [0.0, -90.0, 0.4],
            [0.0, -90.0, 0.0],
            [0.0, 90.0, 0.126],
        ];
        Self { name: "iiwa".into(), joints: joints.into() }
    }

    /// An arm of `n` joints, no two axes of which are parallel or meet.
    pub fn general(n: usize, seed: u64) -> Self {
        let mut random = Random::named(seed, "general arm");
        let mut of = |k: usize| {
            let turn = if k == 0 { 0.0 } else { random.uniform(35.0, 75.0) * if random.unit() < 0.5 { -1.0 } else { 1.0 } };
            [if k == 0 { 0.0 } else { random.uniform(0.1, 0.4) }, turn, random.uniform(0.1, 0.4)]
        };
        let joints = (0..n).map(&mut of).collect();
        Self { name: format!("general {n}R"), joints }
    }

    /// The arm as a robot with drawn inertias, under gravity of this direction.
    pub fn describe(&self, gravity: Gravity, seed: u64) -> Description {
        let count = self.joints.len();
        let body = |(k, &[along, turn, up]): (usize, &[f64; 3])| {
            let (s, c) = quarter(turn);
            let placement = Placement { rotation: [1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c], translation: [along, -s * up, c * up] };
            // Links are lighter towards the tip.
            let mass = 4.0 * (1.0 - k as f64 / (1.5 * count as f64));
            let (mass, com, inertia) = cloud(&mut Random::new(seed, k as u64), mass);
            let joint = JointDescription {
                name: format!("joint_{}", k + 1),
                kind: JointType::Revolute { axis: [0.0, 0.0, 1.0] },
                placement,
                lower: vec![-2.5],
                upper: vec![2.5],
                velocity: vec![4.0],
                effort: vec![if k < count.div_ceil(2) { 250.0 } else { 80.0 }],
                ..JointDescription::default()
            };
            BodyDescription { name: format!("link_{}", k + 1), parent: k.checked_sub(1), mass, com, inertia, joint }
        };
        let bodies = self.joints.iter().enumerate().map(body).collect();
        Description { name: self.name.clone(), gravity: gravity.vector(), bodies, ..Description::default() }
    }
}

/// The direction of gravity in the frame of an arm's base, whose first axis is z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gravity {
    /// Along the first axis.
    Parallel,
    /// Neither along the first axis nor across it.
    Oblique,
    /// None.
    Zero,
}

impl Gravity {
    /// The acceleration, m/s².
    pub fn vector(self) -> [f64; 3] {
        match self {
            Self::Parallel => [0.0, 0.0, -G],
            // The direction (2, 3, −6)/7.
            Self::Oblique => [2.0 / 7.0 * G, 3.0 / 7.0 * G, -6.0 / 7.0 * G],
            Self::Zero => [0.0; 3],
        }
    }

    /// The word for it in rows.
    pub fn name(self) -> &'static str {
        match self {
            Self::Parallel => "parallel",
            Self::Oblique => "oblique",
            Self::Zero => "zero",
        }
    }
}

/// Sine and cosine of an angle in degrees, exact for quarter turns.
fn quarter(degrees: f64) -> (f64, f64) {
    match degrees {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        -90.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}

/// Mass, centre of mass and inertia about it, of six point masses in a box of 0.2 m: a body that exists.
pub(crate) fn cloud(random: &mut Random, mass: f64) -> (f64, [f64; 3], [f64; 6]) {
    let mut sum = PseudoInertia::zero();
    for _ in 0..6 {
        let place: [f64; 3] = std::array::from_fn(|_| random.uniform(-0.1, 0.2));
        sum = sum + PseudoInertia::point(mass / 6.0 * random.uniform(0.6, 1.4), place);
    }
    sum.central()
}
