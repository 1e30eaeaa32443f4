//! What the tests share: arms, and states drawn at random.

use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model, Placement};
use featherbench_robots::{Family, Random};

/// The arm of the lesson: two uniform rods, angles from the upward vertical, in the xz-plane.
pub fn arm(masses: [f64; 2], lengths: [f64; 2]) -> Description {
    let rod = |k: usize| BodyDescription {
        name: format!("rod {k}"),
        parent: (k > 0).then(|| k - 1),
        mass: masses[k],
        com: [0.0, 0.0, lengths[k] / 2.0],
        inertia: [0.0, 0.0, 0.0, masses[k] * lengths[k] * lengths[k] / 12.0, 0.0, 0.0],
        joint: JointDescription {
            name: format!("joint {k}"),
            kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] },
            placement: Placement { translation: [0.0, 0.0, if k > 0 { lengths[k - 1] } else { 0.0 }], ..Placement::default() },
            ..JointDescription::default()
        },
    };
    Description { name: "arm".into(), gravity: [0.0, 0.0, -9.81], bodies: vec![rod(0), rod(1)], ..Description::default() }
}

/// The lesson's nominal arm.
pub fn lesson() -> Description {
    arm([2.0, 1.0], [1.0, 0.5])
}

/// A box that slides along x, without gravity.
pub fn cart(mass: f64) -> Model<f64> {
    let joint = JointDescription { kind: JointType::Prismatic { axis: [1.0, 0.0, 0.0] }, ..JointDescription::default() };
    let body = BodyDescription { name: "box".into(), parent: None, mass, com: [0.0; 3], inertia: [0.0; 6], joint };
    Model::build(&Description { bodies: vec![body], ..Description::default() }).unwrap()
}

/// Robots of all joints, fixed and free, and a chain.
pub fn robots() -> Vec<Description> {
    let words = ["chain:n=6", "tree:n=8,joints=common,seed=3", "quadruped", "joints:kind=spherical,base=free"];
    words.iter().map(|word| Family::parse(word).unwrap().generate().unwrap()).collect()
}

/// `count` numbers of [−1, 1).
pub fn draw(random: &mut Random, count: usize) -> Vec<f64> {
    (0..count).map(|_| random.uniform(-1.0, 1.0)).collect()
}

/// A configuration, and two vectors of nv numbers.
pub fn state(random: &mut Random, model: &Model<f64>) -> [Vec<f64>; 3] {
    let tree = &model.topology;
    let mut q = featherbench_model::neutral(tree);
    let way = draw(random, tree.nv());
    let neutral = q.clone();
    tree.integrate(&neutral, &way, &mut q).unwrap();
    [q, draw(random, tree.nv()), draw(random, tree.nv())]
}

/// The largest difference over the largest magnitude.
pub fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = |numbers: &mut dyn Iterator<Item = f64>| numbers.fold(0.0, |most: f64, x| if x.abs() <= most { most } else { x.abs() });
    largest(&mut a.iter().zip(b).map(|(a, b)| a - b)) / largest(&mut a.iter().chain(b).copied()).max(f64::MIN_POSITIVE)
}
