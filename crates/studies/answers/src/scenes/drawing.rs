//! A side view of a scene: bodies, contacts with their friction cones, and the forces of a step.

use featherbench_scenes::{Geometry, Motion, Push, Question, Scene};
use featherbench_spatial::{larger, smaller};
use maud::{Markup, html};
use nalgebra::{UnitQuaternion, Vector3};

/// Width and height of a drawing, in its own units.
const WIDTH: f64 = 360.0;
const HEIGHT: f64 = 250.0;
/// The length of the largest force, and that of a cone's sides.
const ARROW: f64 = 70.0;
const CONE: f64 = 34.0;

/// World to drawing: x to the right, z up.
struct View {
    scale: f64,
    left: f64,
    ground: f64,
}

impl View {
    /// The view in which all of these points are inside, with room for arrows.
    fn of(points: &[Vector3<f64>]) -> Self {
        let range = |axis: usize| {
            points.iter().fold((0.0_f64, 0.0_f64), |(low, high), point| (smaller(low, point[axis]), larger(high, point[axis])))
        };
        let ((x0, x1), (_, z1)) = (range(0), range(2));
        // A scene of one point has no extent.
        let scale = ((WIDTH - 80.0) / (x1 - x0).max(1e-3)).min((HEIGHT - 100.0) / z1.max(1e-3));
        Self { scale, left: WIDTH / 2.0 - scale * (x0 + x1) / 2.0, ground: HEIGHT - 40.0 }
    }

    fn at(&self, point: &Vector3<f64>) -> (f64, f64) {
        (self.left + self.scale * point.x, self.ground - self.scale * point.z)
    }
}

/// The drawing of a motion's last sample with the forces of its last step.
pub(crate) fn drawing(question: &Question, motion: &Motion, caption: &str) -> Markup {
    let (scene, last) = (&question.scene, motion.last());
    let view = View::of(&outline(scene, motion));
    let strongest = motion.pushes.iter().map(|push| push.force.norm()).fold(0.0, larger);
    html! {
        figure {
            svg role="img" aria-label={ "Side view: " (caption) } viewBox={ "0 0 " (WIDTH) " " (HEIGHT) } width="100%" style="max-width: 26rem" {
                line x1="0" x2=(WIDTH) y1=(number(view.ground)) y2=(number(view.ground)) stroke="var(--soft)" stroke-width="1.5" {}
                @for (k, body) in scene.bodies.iter().enumerate() {
                    @let (place, turn) = (motion.position(last, k), motion.orientation(last, k));
                    @for shape in &body.shapes {
                        (solid(&view, &(place + turn * Vector3::from(shape.at)), &turn, &shape.geometry))
                    }
                    (skeleton(&view, scene, k, &place, &turn))
                }
                @for push in &motion.pushes { (contact(&view, push, scene, strongest)) }
            }
            figcaption.quiet { (caption) }
        }
    }
}

/// The points that a drawing must hold: of every shape its corners or its ends.
fn outline(scene: &Scene, motion: &Motion) -> Vec<Vector3<f64>> {
    let last = motion.last();
    let mut points = Vec::new();
    for (k, body) in scene.bodies.iter().enumerate() {
        let (place, turn) = (motion.position(last, k), motion.orientation(last, k));
        points.push(place);
        for shape in &body.shapes {
            let centre = place + turn * Vector3::from(shape.at);
            let reach = match shape.geometry {
                Geometry::Sphere { radius } => Vector3::repeat(radius),
                Geometry::Box { half } => (turn.to_rotation_matrix().matrix().abs()) * Vector3::from(half),
            };
            points.extend([centre - reach, centre + reach]);
        }
    }
    points
}

/// Two digits after the point are a hundredth of a pixel.
fn number(x: f64) -> String {
    format!("{x:.2}")
}

fn joined(points: &[(f64, f64)]) -> String {
    points.iter().map(|(x, y)| format!("{},{}", number(*x), number(*y))).collect::<Vec<_>>().join(" ")
}

fn solid(view: &View, centre: &Vector3<f64>, turn: &UnitQuaternion<f64>, geometry: &Geometry) -> Markup {
    let (x, y) = view.at(centre);
    html! {
        @match geometry {
            Geometry::Sphere { radius } => circle cx=(number(x)) cy=(number(y)) r=(number(view.scale * radius)) fill="var(--sunken)" stroke="var(--ink)" {}
            Geometry::Box { half } => {
                @let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(a, b)| view.at(&(centre + turn * Vector3::new(a * half[0], 0.0, b * half[2]))));
                polygon points=(joined(&corners)) fill="var(--sunken)" stroke="var(--ink)" {}
            }
        }
    }
}

/// Lines from the centre of mass to the shapes of a body that has them elsewhere, and a mark at the centre of mass.
fn skeleton(view: &View, scene: &Scene, body: usize, place: &Vector3<f64>, turn: &UnitQuaternion<f64>) -> Markup {
    let (x, y) = view.at(place);
    let away = scene.bodies[body].shapes.iter().filter(|shape| Vector3::from(shape.at).norm() > 0.0);
    html! {
        @for shape in away {
            @let end = view.at(&(place + turn * Vector3::from(shape.at)));
            line x1=(number(x)) y1=(number(y)) x2=(number(end.0)) y2=(number(end.1)) stroke="var(--ink)" stroke-width="2" {}
        }
        circle cx=(number(x)) cy=(number(y)) r="3" fill="var(--ink)" {}
    }
}

/// A contact's friction cone on the side that is pushed, and its force. Both are seen from −y. A contact's normal is that of its surfaces;
/// where no tangential force acts it is the force's direction, and else the scene's contacts are on the ground, whose normal is z.
fn contact(view: &View, push: &Push, scene: &Scene, strongest: f64) -> Markup {
    let (x, y) = view.at(&push.at);
    let up = if push.force.z < 0.0 { -1.0 } else { 1.0 };
    let half = scene.friction.atan();
    let side = |sign: f64| (x + sign * CONE * half.sin(), y - up * CONE * half.cos());
    let shown = if strongest > 0.0 { ARROW / strongest } else { 0.0 };
    let (dx, dy) = (shown * push.force.x, -shown * push.force.z);
    let (tip, length) = ((x + dx, y + dy), dx.hypot(dy));
    let (ux, uy) = if length > 0.0 { (dx / length, dy / length) } else { (0.0, 0.0) };
    let wing = |sign: f64| (tip.0 - 7.0 * ux + sign * 3.5 * uy, tip.1 - 7.0 * uy - sign * 3.5 * ux);
    html! {
        polygon points=(joined(&[(x, y), side(-1.0), side(1.0)])) fill="var(--series-4)" fill-opacity="0.22" stroke="var(--series-4)" stroke-width="0.8" {}
        @if length > 1.0 {
            line x1=(number(x)) y1=(number(y)) x2=(number(tip.0)) y2=(number(tip.1)) stroke="var(--series-1)" stroke-width="2" {}
            polygon points=(joined(&[tip, wing(1.0), wing(-1.0)])) fill="var(--series-1)" {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::drawing;
    use featherbench_scenes::{OwnSolver, simulate, systems::Table};

    /// A table in side view has four cones and four arrows, all inside the drawing.
    #[test]
    fn a_table_shows_cones_and_forces() {
        let question = Table::default().question();
        let motion = simulate(&question.scene, 1e-3, 5, 5, &mut OwnSolver::newton()).unwrap();
        let text = drawing(&question, &motion, "a table").into_string();
        assert_eq!(text.matches("fill-opacity").count(), 4);
        assert_eq!(text.matches("fill=\"var(--series-1)\"").count(), 4);
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }
}
