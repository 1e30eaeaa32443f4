//! Loads that are shared: a box on balls, a stack of balls, a table on four legs.

use super::{Measure, Question, STEPS, level};
use crate::motion::Motion;
use crate::scene::{Body, Geometry, Shape};
use featherbench_spatial::larger;
use nalgebra::{DMatrix, DVector, Vector3};
use serde::Serialize;
use serde_json::json;

/// A box that is pulled over balls on the ground. Nothing slips: a = F/(M + 7 n m/20).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoxOnBalls {
    /// M, kg.
    pub mass: f64,
    /// m, kg.
    pub ball: f64,
    /// Balls along each side: n is its square.
    pub side: usize,
    /// m.
    pub radius: f64,
    /// N.
    pub force: f64,
    /// μ.
    pub friction: f64,
    /// m/s².
    pub gravity: f64,
}

impl Default for BoxOnBalls {
    /// 10 kg on nine balls of 1 kg, pulled by 60 N.
    fn default() -> Self {
        Self { mass: 10.0, ball: 1.0, side: 3, radius: 0.1, force: 60.0, friction: 0.8, gravity: 9.81 }
    }
}

impl BoxOnBalls {
    /// The acceleration, m/s². A ball that rolls below the box has a/2 and the spin a/(2r); the box pulls it with 7/20 m a.
    pub fn acceleration(&self) -> f64 {
        self.force / (self.mass + 0.35 * self.ball * (self.side * self.side) as f64)
    }

    /// The question: the box's acceleration from its way, and that of the balls' mean over that.
    pub fn question(&self) -> Question {
        let (r, spacing) = (self.radius, 3.0 * self.radius);
        let middle = (self.side as f64 - 1.0) / 2.0;
        let half = [spacing * (middle + 1.0), spacing * (middle + 1.0), r];
        let mut top = Body::new("box", self.mass, 0.0, [0.0, 0.0, 3.0 * r]);
        let moment = |a: f64, b: f64| self.mass * (a * a + b * b) / 3.0;
        top.inertia = [moment(half[1], half[2]), moment(half[0], half[2]), moment(half[0], half[1])];
        top.force = [self.force, 0.0, 0.0];
        // The force acts at the height of the balls' tops in the closed form; at the centre it only shifts load between them.
        top.shapes.push(Shape { geometry: Geometry::Box { half }, at: [0.0; 3] });
        let mut bodies = vec![top];
        for k in 0..self.side * self.side {
            let (x, y) = ((k % self.side) as f64 - middle, (k / self.side) as f64 - middle);
            bodies.push(Body::ball(format!("ball {k}"), self.ball, r, [spacing * x, spacing * y, r]));
        }
        const DURATION: f64 = 0.2;
        let (exact, balls) = (self.acceleration(), self.side * self.side);
        let by_way = |way: f64| 2.0 * way / (DURATION * DURATION);
        let middle_of = move |motion: &Motion| (1..=balls).map(|k| motion.position(motion.last(), k).x).sum::<f64>() / balls as f64;
        Question {
            scene: level("box_on_balls", self.gravity, self.friction, bodies),
            duration: DURATION,
            dts: STEPS,
            measures: vec![
                Measure::new("box_acceleration", "m/s²", exact, exact, move |motion| by_way(motion.position(motion.last(), 0).x)),
                Measure::new("ball_acceleration", "m/s²", exact / 2.0, exact / 2.0, move |motion| by_way(middle_of(motion))),
            ],
            params: json!(self),
        }
    }
}

/// Balls one above the other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stack {
    /// How many.
    pub balls: usize,
    /// The mass of the top one; the others have 1 kg.
    pub top: f64,
    /// m.
    pub radius: f64,
    /// m/s².
    pub gravity: f64,
}

impl Default for Stack {
    /// Four balls, the top one of 10 kg.
    fn default() -> Self {
        Self { balls: 4, top: 10.0, radius: 0.1, gravity: 9.81 }
    }
}

impl Stack {
    /// The question: how far the forces are from the weight above each contact, and how deep the balls sink.
    pub fn question(&self) -> Question {
        let mass = |k: usize| if k + 1 == self.balls { self.top } else { 1.0 };
        let bodies: Vec<Body> = (0..self.balls)
            .map(|k| Body::ball(format!("ball {k}"), mass(k), self.radius, [0.0, 0.0, self.radius * (2 * k + 1) as f64]))
            .collect();
        // Below ball k.
        let above: Vec<f64> = (0..self.balls).map(|k| self.gravity * (k..self.balls).map(mass).sum::<f64>()).collect();
        let (balls, radius) = (self.balls, self.radius);
        Question {
            scene: level(format!("stack_{:.0}", self.top), self.gravity, 0.5, bodies),
            duration: 0.4,
            dts: STEPS,
            measures: vec![
                Measure::new("load_error", "1", 0.0, 1.0, move |motion| load_error(motion, &above)),
                Measure::new("sinking", "1", 0.0, 1.0, move |motion| {
                    let height = motion.position(motion.last(), balls - 1).z;
                    (radius * (2 * balls - 1) as f64 - height) / radius
                }),
            ],
            params: json!(self),
        }
    }
}

/// The largest error of the vertical force below a body of a stack, over the stack's weight. `above` is the weight that is due below each.
pub(super) fn load_error(motion: &Motion, above: &[f64]) -> f64 {
    let off = |k: usize| {
        let below = k.checked_sub(1);
        let up = motion.pushes.iter().map(|push| match (push.on, push.from) {
            (on, from) if on == k && from == below => push.force.z,
            // The force on the body below is the opposite.
            (on, from) if below == Some(on) && from == Some(k) => -push.force.z,
            _ => 0.0,
        });
        (up.sum::<f64>() - above[k]).abs()
    };
    (0..above.len()).map(off).fold(0.0, larger) / above[0]
}

/// A table on four legs whose load is not in the middle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Table {
    /// W, N.
    pub weight: f64,
    /// The centre of mass from the middle of the legs, m.
    pub offset: [f64; 2],
    /// Half of the distance between legs, m.
    pub half: f64,
    /// m/s².
    pub gravity: f64,
}

impl Default for Table {
    /// 10 N at (0.1, 0.05) between legs at ±0.5.
    fn default() -> Self {
        Self { weight: 10.0, offset: [0.1, 0.05], half: 0.5, gravity: 9.81 }
    }
}

impl Table {
    /// The legs, from the centre of mass.
    fn legs(&self) -> [[f64; 2]; 4] {
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| [x * self.half - self.offset[0], y * self.half - self.offset[1]])
    }

    /// The forces of least norm: W/4 (1 ± x/a ± y/a) at the legs ±a.
    pub fn least_forces(&self) -> [f64; 4] {
        let [x, y] = self.offset.map(|offset| offset / self.half);
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(sx, sy)| self.weight / 4.0 * (1.0 + sx * x + sy * y))
    }

    /// The question, which measures:
    ///
    /// - the wrench of the contacts against W,
    /// - how far the legs' forces are from the set of all that hold it,
    /// - where in that set they are: the part along (1, −1, 1, −1)/2 over W, which no law determines.
    pub fn question(&self) -> Question {
        let (legs, least, weight) = (self.legs(), self.least_forces(), self.weight);
        let mass = weight / self.gravity;
        let mut table = Body::new("table", mass, mass * self.half * self.half, [0.0, 0.0, HEIGHT]);
        for [x, y] in legs {
            table = table.with_sphere(LEG, [x, y, LEG - HEIGHT]);
        }
        let half = self.half;
        Question {
            scene: level("table", self.gravity, 0.5, vec![table]),
            duration: 0.4,
            dts: STEPS,
            measures: vec![
                Measure::new("wrench_error", "1", 0.0, 1.0, move |motion| {
                    let centre = motion.position(motion.last(), 0);
                    let force: Vector3<f64> = motion.pushes.iter().map(|push| push.force).sum();
                    let moment: Vector3<f64> = motion.pushes.iter().map(|push| (push.at - centre).cross(&push.force)).sum();
                    ((force - weight * Vector3::z()).norm() + moment.norm() / half) / weight
                }),
                Measure::new("affine_distance", "1", 0.0, 1.0, move |motion| {
                    distance(&legs, &(on_legs(motion, &legs) - DVector::from_column_slice(&least))) / weight
                }),
                Measure::new("null_share", "1", 0.0, 1.0, move |motion| {
                    let forces = on_legs(motion, &legs);
                    (forces[0] - forces[1] + forces[2] - forces[3]) / (2.0 * weight)
                }),
            ],
            params: json!(self),
        }
    }
}

/// Height of the table's centre of mass, and the radius of a leg's end, m.
const HEIGHT: f64 = 0.2;
const LEG: f64 = 0.02;

/// The normal force on each leg: each contact belongs to the nearest.
fn on_legs(motion: &Motion, legs: &[[f64; 2]; 4]) -> DVector<f64> {
    let mut forces = DVector::zeros(4);
    let centre = motion.position(motion.last(), 0);
    for push in &motion.pushes {
        let far = |leg: usize| (push.at.x - centre.x - legs[leg][0]).hypot(push.at.y - centre.y - legs[leg][1]);
        let nearest = (1..4).fold(0, |best, leg| if far(leg) < far(best) { leg } else { best });
        forces[nearest] += push.force.z;
    }
    forces
}

/// The distance of d from the forces that have no wrench: ‖d − N Nᵀd‖ with the null space N of the map from forces to (ΣF, ΣM).
fn distance(legs: &[[f64; 2]; 4], d: &DVector<f64>) -> f64 {
    let map = DMatrix::from_fn(3, 4, |row, leg| if row == 0 { 1.0 } else { legs[leg][row - 1] });
    let svd = map.clone().svd(true, true);
    // The pseudo-inverse of the map takes its value to the part of d that it sees.
    svd.solve(&(map * d), 1e-12).map_or(f64::NAN, |seen| seen.norm())
}
