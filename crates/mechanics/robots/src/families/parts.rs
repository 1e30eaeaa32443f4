//! The parts of the families: links, boxes, random bodies.

use crate::Random;
use featherbench_model::{BodyDescription, JointDescription, JointType, Placement};

pub(super) const X: [f64; 3] = [1.0, 0.0, 0.0];
pub(super) const Y: [f64; 3] = [0.0, 1.0, 0.0];
pub(super) const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Standard gravity as most robot files give it, m/s².
pub(super) const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];
/// A dyadic gravity: exact in every binary format, m/s².
pub(super) const DYADIC_GRAVITY: [f64; 3] = [0.0, 0.0, -9.8125];

/// Length of the dyadic link, m.
pub(super) const LINK: f64 = 0.5;

/// The dyadic link (1 kg, 0.5 m along x): every number is exact in every binary format.
pub(super) fn dyadic_link(name: String, parent: Option<usize>, kind: JointType, translation: [f64; 3]) -> BodyDescription {
    let (along, across) = (1.0 / 128.0, 1.0 / 32.0);
    BodyDescription {
        joint: joint(&name, kind, translation),
        name,
        parent,
        mass: 1.0,
        com: [0.5 * LINK, 0.0, 0.0],
        inertia: [along, 0.0, 0.0, across, 0.0, across],
    }
}

/// A joint without any properties, its frame parallel to the parent's.
pub(super) fn joint(body: &str, kind: JointType, translation: [f64; 3]) -> JointDescription {
    JointDescription {
        name: format!("{body}_joint"),
        kind,
        placement: Placement { translation, ..Placement::default() },
        ..JointDescription::default()
    }
}

/// A part of a robot: a homogeneous box on a revolute joint.
pub(super) struct Part {
    pub name: &'static str,
    /// Axis of the joint: X, Y or Z.
    pub axis: [f64; 3],
    /// The joint on the parent, m.
    pub at: [f64; 3],
    pub mass: f64,
    /// Centre of the box, m.
    pub com: [f64; 3],
    /// Edges of the box, m.
    pub size: [f64; 3],
    /// Position limits, rad.
    pub range: (f64, f64),
    /// Effort limit, N·m.
    pub effort: f64,
}

/// Armature as a share of the effort limit: 0.1 N·m stands for 2·10⁻⁵ kg·m², 100 N·m for 0.02 kg·m², as geared drives have it.
const ARMATURE_PER_EFFORT: f64 = 2e-4;
/// Viscous damping per effort limit, s.
const DAMPING_PER_EFFORT: f64 = 2e-3;
/// Dry friction as a share of the effort limit.
const FRICTION_PER_EFFORT: f64 = 1e-2;
/// Speed limit of the drives, rad/s.
const SPEED: f64 = 12.0;

/// Appends a row of parts, each on the one before and the first on `parent`. `side` is 1 for the left, −1 for its mirror image.
pub(super) fn limb(bodies: &mut Vec<BodyDescription>, parent: usize, prefix: &str, side: f64, parts: &[Part]) {
    let mut parent = parent;
    for part in parts {
        let mirror = |v: [f64; 3]| if side < 0.0 { [v[0], 0.0 - v[1], v[2]] } else { v };
        let name = format!("{prefix}{}", part.name);
        // A mirror image keeps a rotation about y, and reverses one about x or z.
        let (low, high) = if side < 0.0 && part.axis != Y { (0.0 - part.range.1, 0.0 - part.range.0) } else { part.range };
        let kind = JointType::Revolute { axis: part.axis };
        let joint = JointDescription {
            armature: vec![ARMATURE_PER_EFFORT * part.effort],
            damping: vec![DAMPING_PER_EFFORT * part.effort],
            friction: vec![FRICTION_PER_EFFORT * part.effort],
            lower: vec![low],
            upper: vec![high],
            velocity: vec![SPEED],
            effort: vec![part.effort],
            ..joint(&name, kind, mirror(part.at))
        };
        let inertia = box_inertia(part.mass, part.size);
        bodies.push(BodyDescription { name, parent: Some(parent), mass: part.mass, com: mirror(part.com), inertia, joint });
        parent = bodies.len() - 1;
    }
}

/// A homogeneous box on a free joint.
pub(super) fn free_box(name: &str, mass: f64, com: [f64; 3], size: [f64; 3]) -> BodyDescription {
    let joint = joint(name, JointType::Free, [0.0; 3]);
    BodyDescription { name: name.to_owned(), parent: None, mass, com, inertia: box_inertia(mass, size), joint }
}

/// Inertia of a homogeneous box about its centre.
fn box_inertia(mass: f64, [a, b, c]: [f64; 3]) -> [f64; 6] {
    let twelfth = mass / 12.0;
    [twelfth * (b * b + c * c), 0.0, 0.0, twelfth * (a * a + c * c), 0.0, twelfth * (a * a + b * b)]
}

/// Armature of random joints, kg·m² or kg.
pub(super) const ARMATURE: (f64, f64) = (0.01, 0.1);

/// A body of random mass, centre and full inertia, whose joint has a random placement and random properties.
pub(super) fn random_body(
    random: &mut Random,
    name: String,
    parent: Option<usize>,
    kind: JointType,
    mass: (f64, f64),
    armature: bool,
) -> BodyDescription {
    let mass = random.uniform(mass.0, mass.1);
    let com = std::array::from_fn(|_| random.uniform(-0.15, 0.15));
    // Second moments of mass per axis, all positive: their pairwise sums are principal moments that satisfy the triangle inequality.
    let [a, b, c]: [f64; 3] = std::array::from_fn(|_| mass * random.uniform(0.002, 0.02));
    let inertia = turned([b + c, a + c, a + b], random_rotation(random));
    let rotation = random_rotation(random);
    let translation = std::array::from_fn(|_| random.uniform(-0.4, 0.4));
    let nv = kind.nv();
    let mut list = |low: f64, high: f64| (0..nv).map(|_| random.uniform(low, high)).collect::<Vec<f64>>();
    let mut joint = JointDescription {
        name: format!("{name}_joint"),
        kind,
        placement: Placement { rotation, translation },
        ..JointDescription::default()
    };
    if kind != JointType::Free {
        joint.damping = list(0.0, 0.5);
        joint.friction = list(0.0, 0.2);
    }
    if nv == 1 {
        joint.lower = list(-2.0, -0.5);
        joint.upper = list(0.5, 2.0);
        joint.velocity = list(1.0, 10.0);
        joint.effort = list(10.0, 100.0);
        // Drawn in any case, so that the switch changes nothing else.
        let drawn = list(ARMATURE.0, ARMATURE.1);
        if armature {
            joint.armature = drawn;
        }
    }
    BodyDescription { name, parent, mass, com, inertia, joint }
}

/// A uniformly distributed rotation, row-major. The products are not fused: a fused one would give other bits on a processor without it.
fn random_rotation(random: &mut Random) -> [f64; 9] {
    let [x, y, z, w] = random.direction::<4>();
    [
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - z * w),
        2.0 * (x * z + y * w),
        2.0 * (x * y + z * w),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - x * w),
        2.0 * (x * z - y * w),
        2.0 * (y * z + x * w),
        1.0 - 2.0 * (x * x + y * y),
    ]
}

/// The tensor with these principal moments along the columns of a rotation: xx, xy, xz, yy, yz, zz of R·diag·Rᵀ.
fn turned(principal: [f64; 3], r: [f64; 9]) -> [f64; 6] {
    let entry = |i: usize, j: usize| (0..3).map(|k| r[3 * i + k] * principal[k] * r[3 * j + k]).sum::<f64>();
    [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)]
}

/// The kinds that random trees draw from.
pub(super) const MOVABLE: [&str; 6] = ["revolute", "prismatic", "helical", "spherical", "planar", "universal"];
/// Those that all the reference engines have.
pub(super) const COMMON: [&str; 5] = ["revolute", "prismatic", "spherical", "planar", "universal"];

/// The joint of this word with a random skew axis and pitch, where it has one.
pub(super) fn random_kind(random: &mut Random, word: &str) -> JointType {
    let axis = random.direction();
    let pitch = random.uniform(0.02, 0.2);
    JointType::named(word, axis, pitch).unwrap_or(JointType::Revolute { axis })
}
