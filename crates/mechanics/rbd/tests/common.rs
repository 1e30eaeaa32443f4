//! A robot with every kind of joint, and numbers for it.

use featherbench_rbd::Robot;
use featherbench_rbd::model::{BodyDescription, Description, Frame, JointDescription, JointType, Placement};
use featherbench_rbd::robots::Random;
use featherbench_rbd::spatial::{Quaternion, Transform, Vec3};

/// A placement that is skew to all axes, another one for each number.
pub fn skew(number: usize) -> Placement {
    let shift = number as f64;
    let turn = Quaternion::exp(Vec3::new(0.3 + 0.1 * shift, -0.5, 0.4 - 0.1 * shift)).to_rotation();
    Placement::from_transform(&Transform::new(turn, Vec3::new(0.1, -0.2 + 0.05 * shift, 0.3)))
}

/// A free base, and on it a body for each other kind of joint, each on the one before; without the helical joint if not wanted.
pub fn every_joint(helical: bool) -> Robot {
    let axis = [0.0, 0.6, 0.8];
    let mut kinds = vec![
        JointType::Free,
        JointType::Revolute { axis },
        JointType::Spherical,
        JointType::Prismatic { axis },
        JointType::Planar,
        JointType::Universal,
        JointType::Translation,
        JointType::Cylindrical { axis },
        JointType::EulerZyx,
    ];
    if helical {
        kinds.push(JointType::Helical { axis, pitch: 0.2 });
    }
    let body = |(k, kind): (usize, JointType)| BodyDescription {
        name: format!("body {k}"),
        parent: k.checked_sub(1),
        mass: 1.0 + 0.1 * k as f64,
        com: [0.02, -0.03, 0.1],
        inertia: [0.02, 0.001, -0.002, 0.03, 0.0015, 0.025],
        joint: JointDescription { name: format!("joint {k}"), kind, placement: skew(k), ..JointDescription::default() },
    };
    let count = kinds.len();
    let bodies = kinds.into_iter().enumerate().map(body).collect();
    let frames = vec![
        Frame { name: "tool".into(), body: Some(count - 1), placement: skew(20) },
        Frame { name: "post".into(), body: None, placement: skew(21) },
    ];
    let description = Description { name: "every joint".into(), gravity: [0.0, 0.0, -9.81], bodies, frames, ..Description::default() };
    Robot::from_description(&description).unwrap()
}

/// Numbers in (−1, 1), one per dof.
pub fn random_v(robot: &Robot, seed: u64, stream: u64) -> Vec<f64> {
    let mut random = Random::new(seed, stream);
    (0..robot.nv()).map(|_| random.uniform(-1.0, 1.0)).collect()
}

/// The largest absolute value.
pub fn largest(values: &[f64]) -> f64 {
    featherbench_rbd::spatial::largest(values.iter().copied())
}
