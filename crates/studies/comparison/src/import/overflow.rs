//! A file whose numbers overflow: that is the file's fault, and is told before an engine is asked.

use featherbench_model::Description;

/// Products of two entries of M occur in each factorization: an entry above this has a square that is no number.
const LARGEST_ENTRY: f64 = 1e150;

/// The body whose mass or inertia, at the robot's reach, makes M overflow, with the number; `None` if there is none.
///
/// An entry of M is at most the sum over the bodies of I + m r², where r is no longer than all offsets together.
pub fn overflow(robot: &Description) -> Option<String> {
    let norm = |v: [f64; 3]| v[0].hypot(v[1]).hypot(v[2]);
    let reach: f64 = robot.bodies.iter().map(|body| norm(body.joint.placement.translation) + norm(body.com)).sum::<f64>().max(1.0);
    let moment = |inertia: [f64; 6]| inertia.iter().fold(0.0, |sum: f64, x| sum + x.abs());
    let parts = robot.bodies.iter().flat_map(|body| {
        let of_mass = (body.mass * reach * reach, format!("its mass is {:e} kg", body.mass));
        let of_inertia = (moment(body.inertia), format!("its inertia is up to {:e} kg m²", moment(body.inertia)));
        let armature = body.joint.armature.iter().map(|x| (x.abs(), format!("its joint's armature is {x:e}")));
        [of_mass, of_inertia].into_iter().chain(armature).map(move |(size, words)| (size, &body.name, words))
    });
    let (size, body, words) = parts.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let beyond = size.is_nan() || size > LARGEST_ENTRY;
    beyond.then(|| {
        format!(
            "body '{body}': {words}, and the robot reaches {reach:.3e} m: the products that its dynamics need overflow; is it another unit?"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use featherbench_model::{BodyDescription, JointDescription};

    #[test]
    fn the_largest_number_is_named() {
        let body = |name: &str, mass: f64, arm: f64| BodyDescription {
            name: name.into(),
            parent: None,
            mass,
            com: [arm, 0.0, 0.0],
            inertia: [0.0; 6],
            joint: JointDescription::default(),
        };
        let of = |bodies: Vec<BodyDescription>| overflow(&Description { bodies, ..Default::default() });
        assert_eq!(of(vec![body("a", 1.0, 0.1), body("b", 1e149, 0.5)]), None);
        assert!(of(vec![body("a", 1.0, 0.1), body("b", 1e300, 0.5)]).unwrap().starts_with("body 'b': its mass is 1e300 kg"));
        // A light body on a long arm; a sum that is no number.
        assert!(of(vec![body("a", 1.0, 1e80)]).unwrap().contains("'a'"));
        assert!(of(vec![body("a", 1e300, 1e300)]).unwrap().contains("'a'"));
    }
}
