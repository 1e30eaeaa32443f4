//! Where bodies touch: spheres and boxes on the ground, spheres on spheres and on boxes, corners of boxes on faces of boxes.

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

/// All places with a gap below `margin` where the bodies have these positions and orientations. A box meets the ground and other boxes with its
/// corners. Edges do not meet edges.
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
                Geometry::Box { half } => corners(centre, turns[on], half).for_each(ground),
            }
        }
        for (from, other) in scene.bodies.iter().enumerate().skip(on + 1) {
            for a in &body.shapes {
                for b in &other.shapes {
                    let (first, second) = (centre(on, a), centre(from, b));
                    match (a.geometry, b.geometry) {
                        (Geometry::Sphere { radius: r }, Geometry::Sphere { radius: s }) => {
                            found.extend(spheres((on, first, r), (from, second, s)));
                        }
                        (Geometry::Sphere { radius }, Geometry::Box { half }) => {
                            found.extend(ball_on_box((on, first, radius), &Solid { body: from, centre: second, turn: turns[from], half }));
                        }
                        (Geometry::Box { half }, Geometry::Sphere { radius }) => {
                            found.extend(ball_on_box((from, second, radius), &Solid { body: on, centre: first, turn: turns[on], half }));
                        }
                        (Geometry::Box { half }, Geometry::Box { half: other }) => {
                            let (a, b) = (
                                Solid { body: on, centre: first, turn: turns[on], half },
                                Solid { body: from, centre: second, turn: turns[from], half: other },
                            );
                            found.extend(a.on_faces_of(&b, margin));
                            found.extend(b.on_faces_of(&a, margin));
                        }
                    }
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

/// A sphere (body, centre, radius) outside a box. None where the sphere's centre is inside: no scene presses so hard.
fn ball_on_box((on, ball, radius): (usize, Vector3<f64>, f64), solid: &Solid) -> Option<Touch> {
    let seen = solid.turn.inverse() * (ball - solid.centre);
    let nearest = Vector3::from_fn(|k, _| seen[k].clamp(-solid.half[k], solid.half[k]));
    let normal = solid.turn * (seen - nearest).try_normalize(0.0)?;
    let gap = (seen - nearest).norm() - radius;
    Some(Touch { on, from: Some(solid.body), at: solid.centre + solid.turn * nearest + normal * (gap / 2.0), normal, gap })
}

/// The corners of a box.
fn corners(centre: Vector3<f64>, turn: UnitQuaternion<f64>, half: [f64; 3]) -> impl Iterator<Item = Vector3<f64>> {
    (0..8_u8).map(move |corner| {
        let sign = |bit: u8| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
        centre + turn * Vector3::new(sign(0) * half[0], sign(1) * half[1], sign(2) * half[2])
    })
}

/// A box of a body.
struct Solid {
    body: usize,
    centre: Vector3<f64>,
    turn: UnitQuaternion<f64>,
    half: [f64; 3],
}

impl Solid {
    /// The corners of this box over or just below a face of another. Where a corner is beyond two faces, it is beside an edge and touches none.
    fn on_faces_of(&self, other: &Self, margin: f64) -> Vec<Touch> {
        let touch = |corner: Vector3<f64>| {
            let seen = other.turn.inverse() * (corner - other.centre);
            let over = Vector3::from_fn(|k, _| seen[k].abs() - other.half[k]);
            // The face that the corner is above, or that it is least below.
            let (face, gap) = over.argmax();
            let beside = (0..3).any(|k| k != face && over[k] > 0.0);
            let mut normal = Vector3::zeros();
            normal[face] = seen[face].signum();
            let normal = other.turn * normal;
            (!beside && gap < margin).then(|| Touch {
                on: self.body,
                from: Some(other.body),
                at: corner - normal * (gap / 2.0),
                normal,
                gap,
            })
        };
        corners(self.centre, self.turn, self.half).filter_map(touch).collect()
    }
}
