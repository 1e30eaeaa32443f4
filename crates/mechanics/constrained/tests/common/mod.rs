//! Robots, constraints and states that several tests use.

#[path = "../../../dynamics/tests/common/tolerance.rs"]
mod tolerance;

pub use tolerance::assert_within;

use featherbench_constrained::{Attachment, Constraint, Constraints, Law, LoopMotion, Rows};
use featherbench_model::{JointKind, Model};
use featherbench_robots::{Family, Random};
use featherbench_spatial::{Mat3, Quaternion};

pub fn model(spec: &str) -> Model<f64> {
    Model::build(&Family::parse(spec).unwrap().generate().unwrap()).unwrap()
}

/// A small tree with every kind of joint, on a fixed and on a free base.
pub const EVERY_JOINT: [&str; 2] = ["joints:kind=all,base=fixed", "joints:kind=all,base=free"];

pub fn rotation(random: &mut Random) -> Mat3<f64> {
    Quaternion::from_array(random.direction::<4>()).to_rotation()
}

pub fn attachment(random: &mut Random, body: Option<usize>) -> Attachment {
    let point = std::array::from_fn(|_| random.uniform(-0.5, 0.5));
    let placed = body.map_or(Attachment::world(point), |body| Attachment::point(body, point));
    placed.with_axes(rotation(random))
}

/// Two different bodies, of which the first may be the world.
fn pair(random: &mut Random, bodies: usize) -> [Attachment; 2] {
    let second = random.below(bodies);
    let first = Some(random.below(bodies)).filter(|first| *first != second);
    [attachment(random, first), attachment(random, Some(second))]
}

/// The dofs that have a coordinate.
pub fn coordinates(model: &Model<f64>) -> Vec<usize> {
    let joints = model.topology.joints().iter();
    joints.filter(|joint| !matches!(joint.kind, JointKind::Spherical | JointKind::Free)).map(|joint| joint.v).collect()
}

pub const MOTIONS: [LoopMotion; 6] =
    [LoopMotion::Fixed, LoopMotion::Revolute, LoopMotion::Prismatic, LoopMotion::Cylindrical, LoopMotion::Spherical, LoopMotion::Planar];

/// One constraint of every kind, between random frames.
pub fn every_law(model: &Model<f64>, seed: u64) -> Constraints {
    let random = &mut Random::new(seed, 1);
    let bodies = model.topology.bodies();
    let mut list = Vec::new();
    let mut add = |name: &str, law: Law| list.push(Constraint { name: name.into(), law });
    for motion in MOTIONS {
        let [first, second] = pair(random, bodies);
        add(motion.name(), Law::Joint { first, second, motion });
    }
    let [first, second] = pair(random, bodies);
    add("point", Law::Point { first, second, axes: [true, false, true] });
    let [first, second] = pair(random, bodies);
    add("distance", Law::Distance { first, second, length: random.uniform(0.5, 1.5) });
    let dofs = coordinates(model);
    let (a, b) = (dofs[random.below(dofs.len() / 2)], dofs[dofs.len() / 2 + random.below(dofs.len() / 2)]);
    add("gear", Law::Gear { terms: vec![(a, 0.7), (b, -1.3)], offset: 0.2 });
    add("mimic", Law::Mimic { follower: b, leader: a, polynomial: std::array::from_fn(|_| random.uniform(-1.0, 1.0)) });
    Constraints::new(&model.topology, list).unwrap()
}

/// How many roundings an orientation costs: 1/w², the largest of all welds. 4 w² = 1 + tr R is known to ε, and |φ|² = 4 (1 − w²).
pub fn slack(constraints: &Constraints, rows: &Rows<f64>) -> f64 {
    let residuals: Vec<f64> = rows.residuals().collect();
    let welds = constraints
        .list()
        .iter()
        .enumerate()
        .filter(|(_, constraint)| matches!(constraint.law, Law::Joint { motion: LoopMotion::Fixed | LoopMotion::Prismatic, .. }));
    welds.fold(1.0, |largest, (k, _)| {
        let phi = &residuals[constraints.rows_of(k)][..3];
        let square = 1.0 - 0.25 * phi.iter().map(|x| x * x).sum::<f64>();
        largest.max(1.0 / square)
    })
}
