//! Where bodies touch: spheres and boxes on the ground, spheres on spheres and on boxes.

use crate::scene::{Geometry, Scene, Shape};
use nalgebra::{UnitQuaternion, Vector3};

/// A place where two bodies touch or nearly touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The body that the normal points into.
    pub on: usize,
    /// The other; none is the ground.
    pub from: Option<usize>,
    /// Half way between both surfaces, m.
    pub at: Vector3<f64>,
    /// Unit vector, from the other body to this one.
    pub normal: Vector3<f64>,
    /// The distance of the surfaces, negative where they overlap, m.
    pub gap: f64,
}

/// All places with a gap below `margin` where the bodies have these positions and orientations. A box meets the ground with its corners.
/// Boxes do not meet boxes.
pub fn touches(scene: &Scene, positions: &[Vector3<f64>], turns: &[UnitQuaternion<f64>], margin: f64) -> Vec<Touch> {
    let mut found = Vec::new();
    let centre = |body: usize, shape: &Shape| positions[body] + turns[body] * Vector3::from(shape.at);
    for (on, body) in scene.bodies.iter().enumerate() {
        for shape in &body.shapes {
            let centre = centre(on, shape);
            let mut ground = |lowest: Vector3<f64>| {
                let at = Vector3::new(lowest.x, lowest.y, lowest.z / 2.0);
                found.push(Touch { on, from: None, at, normal: Vector3::z(), gap: lowest.z });
            };
            match shape.geometry {
                Geometry::Sphere { radius } => ground(centre - radius * Vector3::z()),
                Geometry::Box { half } => {
                    for corner in 0..8_u8 {
                        let sign = |bit: u8| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
                        ground(centre + turns[on] * Vector3::new(sign(0) * half[0], sign(1) * half[1], sign(2) * half[2]));
                    }
                }
            }
        }
        for (from, other) in scene.bodies.iter().enumerate().skip(on + 1) {
            for a in &body.shapes {
                for b in &other.shapes {
                    let (first, second) = (centre(on, a), centre(from, b));
                    found.extend(match (a.geometry, b.geometry) {
                        (Geometry::Sphere { radius: r }, Geometry::Sphere { radius: s }) => spheres((on, first, r), (from, second, s)),
                        (Geometry::Sphere { radius }, Geometry::Box { half }) => {
                            ball_on_box((on, first, radius), (from, second, turns[from], half))
                        }
                        (Geometry::Box { half }, Geometry::Sphere { radius }) => {
                            ball_on_box((from, second, radius), (on, first, turns[on], half))
                        }
                        (Geometry::Box { .. }, Geometry::Box { .. }) => None,
                    });
                }
            }
        }
    }
    found.retain(|touch| touch.gap < margin);
    found
}

/// Two spheres: body, centre, radius. None where the centres coincide.
fn spheres((on, a, r): (usize, Vector3<f64>, f64), (from, b, s): (usize, Vector3<f64>, f64)) -> Option<Touch> {
    let normal = (a - b).try_normalize(0.0)?;
    let gap = (a - b).norm() - r - s;
    Some(Touch { on, from: Some(from), at: b + normal * (s + gap / 2.0), normal, gap })
}

/// A sphere (body, centre, radius) outside a box (body, centre, turn, half edges). None where the sphere's centre is inside: no scene presses so hard.
fn ball_on_box(
    (on, ball, radius): (usize, Vector3<f64>, f64),
    (from, centre, turn, half): (usize, Vector3<f64>, UnitQuaternion<f64>, [f64; 3]),
) -> Option<Touch> {
    let seen = turn.inverse() * (ball - centre);
    let nearest = Vector3::from_fn(|k, _| seen[k].clamp(-half[k], half[k]));
    let normal = turn * (seen - nearest).try_normalize(0.0)?;
    let gap = (seen - nearest).norm() - radius;
    Some(Touch { on, from: Some(from), at: centre + turn * nearest + normal * (gap / 2.0), normal, gap })
}
