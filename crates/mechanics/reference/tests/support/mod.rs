//! What the tests and examples share: the cases of the truth, their states, and oracles.

#![allow(dead_code, reason = "every test and example compiles this module and uses a part of it")]

pub mod golden;
pub mod oracle;
// The module for the factor on tolerances does not depend on dynamics.
#[path = "../../../dynamics/tests/common/tolerance.rs"]
mod tolerance;

use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model, Placement};
use featherbench_reference::Mp;
use featherbench_robots::{Family, Random, StateBatch};
use std::path::{Path, PathBuf};

/// How the states of a case are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draw {
    /// Angles in (−0.2, 0.2).
    Small,
    /// Angles in (−π, π).
    Wide,
    /// Random states as in the agreement study, quaternions included.
    Random,
}

/// A robot with a way to draw states for it.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub name: &'static str,
    pub family: &'static str,
    pub draw: Draw,
}

/// Chains of planar and spatial layout, heavy and light tips, a humanoid with light and heavy hands, and every common joint.
pub const CASES: [Case; 12] = [
    Case { name: "planar_small_10", family: "chain:n=10", draw: Draw::Small },
    Case { name: "planar_small_50", family: "chain:n=50", draw: Draw::Small },
    Case { name: "planar_small_200", family: "chain:n=200", draw: Draw::Small },
    Case { name: "rand3d_20", family: "chain:n=20,layout=spatial", draw: Draw::Wide },
    Case { name: "rand3d_200", family: "chain:n=200,layout=spatial", draw: Draw::Wide },
    Case { name: "rand3d_20_tip1e3", family: "chain:n=20,layout=spatial,tip_scale=1e3", draw: Draw::Wide },
    Case { name: "rand3d_20_tip1e6", family: "chain:n=20,layout=spatial,tip_scale=1e6", draw: Draw::Wide },
    Case { name: "planar_20_tip1e6", family: "chain:n=20,tip_scale=1e6", draw: Draw::Small },
    Case { name: "planar_20_tip1e-6", family: "chain:n=20,tip_scale=1e-6", draw: Draw::Small },
    Case { name: "humanoid_hand1", family: "humanoid:hand_mass=1", draw: Draw::Random },
    Case { name: "humanoid_hand1000", family: "humanoid:hand_mass=1000", draw: Draw::Random },
    Case { name: "joints_common_free", family: "joints:kind=common,base=free", draw: Draw::Random },
];

/// One state.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub a: Vec<f64>,
    pub tau: Vec<f64>,
}

impl Case {
    pub fn describe(&self) -> Description {
        describe(self.family)
    }

    /// State `k` of a seed; q, v, τ and a are drawn in that order.
    pub fn state(&self, seed: u64, k: usize) -> State {
        let description = self.describe();
        if self.draw == Draw::Random {
            let model = Model::<f64>::build(&description).unwrap();
            let batch = StateBatch::random(&model, k + 1, seed);
            return State { q: batch.q(k).to_vec(), v: batch.v(k).to_vec(), a: batch.a(k).to_vec(), tau: batch.tau(k).to_vec() };
        }
        let mut random = Random::named(seed, &format!("{}/{k}", self.name));
        let reach = if self.draw == Draw::Small { 0.2 } else { std::f64::consts::PI };
        let mut draw = |n: usize, reach: f64| (0..n).map(|_| random.uniform(-reach, reach)).collect::<Vec<_>>();
        let (q, v) = (draw(description.nq(), reach), draw(description.nv(), 1.0));
        let (tau, a) = (draw(description.nv(), 1.0), draw(description.nv(), 1.0));
        State { q, v, a, tau }
    }
}

pub fn describe(family: &str) -> Description {
    Family::parse(family).and_then(|family| family.generate()).unwrap_or_else(|error| panic!("{family}: {error}"))
}

/// A body below another, whose joint is at this place of it.
pub fn body(parent: Option<usize>, mass: f64, com: [f64; 3], inertia: [f64; 6], kind: JointType, at: [f64; 3]) -> BodyDescription {
    let placement = Placement { translation: at, ..Placement::default() };
    let joint = JointDescription { kind, placement, ..JointDescription::default() };
    BodyDescription { name: format!("below {parent:?}"), parent, mass, com, inertia, joint }
}

/// Bodies under gravity along −z.
pub fn under_gravity(gravity: f64, bodies: Vec<BodyDescription>) -> Description {
    Description { gravity: [0.0, 0.0, -gravity], bodies, ..Description::default() }
}

/// The project's root.
pub fn project() -> PathBuf {
    // Tests and examples are of two packages, whose folders are not alike deep.
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().find(|folder| folder.join("Cargo.lock").exists()).unwrap().to_owned()
}

/// max |x − y| / max |y|, or the larger of the two when y is zero.
pub fn distance(x: &[Mp], y: &[Mp]) -> Mp {
    assert_eq!(x.len(), y.len());
    let largest = |numbers: &mut dyn Iterator<Item = Mp>| numbers.fold(Mp::zero(), |largest, x| largest.max(x.abs()));
    let scale = largest(&mut y.iter().cloned());
    let gap = largest(&mut x.iter().zip(y).map(|(x, y)| x - y));
    if scale.is_zero() { gap } else { gap / scale }
}

/// Asserts that a distance is within its tolerance, times the factor of `FEATHERBENCH_TOL_SCALE`.
#[track_caller]
pub fn close(what: &str, distance: &Mp, tolerance: f64) {
    tolerance::assert_within(what, distance.to_f64(), tolerance);
}
