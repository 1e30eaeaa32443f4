//! A stack of boxes: it rests, and each contact plane carries the weight above it.

use super::loads::load_error;
use super::{Measure, Question, STEPS, level};
use crate::motion::Motion;
use crate::scene::{Body, Geometry, Shape};
use featherbench_spatial::larger;
use nalgebra::Vector3;
use serde::Serialize;
use serde_json::json;

/// Cubes one above the other. Each is a little smaller than the one below it, so that its corners are on a face and no edge meets an edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoxStack {
    /// How many: at least one.
    pub boxes: usize,
    /// The mass of the top one; the others have 1 kg.
    pub top: f64,
    /// Half of an edge of the lowest, m.
    pub half: f64,
    /// The edge of a cube over that of the cube below it.
    pub taper: f64,
    /// μ.
    pub friction: f64,
    /// m/s².
    pub gravity: f64,
}

impl Default for BoxStack {
    /// Five cubes of 1 kg; the lowest has an edge of 0.2 m.
    fn default() -> Self {
        Self { boxes: 5, top: 1.0, half: 0.1, taper: 0.9, friction: 0.5, gravity: 9.81 }
    }
}

impl BoxStack {
    fn mass(&self, index: usize) -> f64 {
        if index + 1 == self.boxes { self.top } else { 1.0 }
    }

    /// The force that the plane below each box carries, N: the sum over the boxes from it to the top.
    pub fn loads(&self) -> Vec<f64> {
        (0..self.boxes).map(|k| self.gravity * (k..self.boxes).map(|above| self.mass(above)).sum::<f64>()).collect()
    }

    /// Half edges and heights of the centres, m.
    fn places(&self) -> Vec<(f64, f64)> {
        let mut foot = 0.0;
        (0..self.boxes)
            .map(|k| {
                let half = self.half * self.taper.powi(i32::try_from(k).unwrap_or(i32::MAX));
                foot += 2.0 * half;
                (half, foot - half)
            })
            .collect()
    }

    /// The question, which measures:
    ///
    /// - errors of the loads,
    /// - how far the pressure is from the middle of each plane, over the half edge,
    /// - how deep the top sinks and how far a box drifts, over the lowest half edge,
    /// - the energy that appears, over that of the stack above the ground.
    pub fn question(&self) -> Question {
        let places = self.places();
        let bodies: Vec<Body> = places
            .iter()
            .enumerate()
            .map(|(k, &(half, height))| {
                // A cube of the edge 2h has ⅔ m h².
                let mut cube = Body::new(format!("box {k}"), self.mass(k), self.mass(k) * half * half / 1.5, [0.0, 0.0, height]);
                cube.shapes.push(Shape { geometry: Geometry::Box { half: [half; 3] }, at: [0.0; 3] });
                cube
            })
            .collect();
        let Self { half, gravity, .. } = *self;
        let (loads, of_offset) = (self.loads(), self.loads());
        let edges: Vec<f64> = places.iter().map(|place| place.0).collect();
        let heights: Vec<f64> = places.iter().map(|place| place.1).collect();
        let masses: Vec<(f64, f64)> = bodies.iter().map(|body| (body.mass, body.inertia[0])).collect();
        let start: f64 = masses.iter().zip(&heights).map(|(of, height)| of.0 * gravity * height).sum();
        let (boxes, top) = (self.boxes, heights.last().copied().unwrap_or_default());
        Question {
            scene: level(format!("boxes_{}_{:.0}", self.boxes, self.top), gravity, self.friction, bodies),
            duration: 0.4,
            dts: STEPS,
            measures: vec![
                Measure::new("load_error", "1", 0.0, 1.0, move |motion| load_error(motion, &loads)),
                Measure::new("pressure_offset", "1", 0.0, 1.0, move |motion| {
                    (0..boxes).map(|k| pressure_offset(motion, k, of_offset[k]) / edges[k]).fold(0.0, larger)
                }),
                Measure::new("sinking", "1", 0.0, 1.0, move |motion| (top - motion.position(motion.last(), boxes - 1).z) / half),
                Measure::new("drift", "1", 0.0, 1.0, move |motion| {
                    let way = |body: usize| motion.position(motion.last(), body).xy().norm();
                    (0..boxes).map(way).fold(0.0, larger) / half
                }),
                Measure::new("energy_created", "1", 0.0, 1.0, move |motion| {
                    let energy =
                        |sample: usize| -> f64 { masses.iter().enumerate().map(|(k, &of)| energy(motion, sample, k, of, gravity)).sum() };
                    (0..motion.samples()).map(|sample| energy(sample) - start).fold(0.0, larger) / start
                }),
            ],
            params: json!(self),
        }
    }
}

/// How far the pressure below a body is from the vertical through its centre, m: the moment of the vertical forces over the load.
fn pressure_offset(motion: &Motion, body: usize, load: f64) -> f64 {
    let (centre, below) = (motion.position(motion.last(), body), body.checked_sub(1));
    let moment: Vector3<f64> = motion
        .pushes
        .iter()
        .filter_map(|push| match (push.on, push.from) {
            (on, from) if on == body && from == below => Some((push.at - centre) * push.force.z),
            (on, from) if below == Some(on) && from == Some(body) => Some((centre - push.at) * push.force.z),
            _ => None,
        })
        .sum();
    moment.xy().norm() / load
}

/// Kinetic and potential energy of a body of a mass and a moment of inertia that is the same about all axes, J.
fn energy(motion: &Motion, sample: usize, body: usize, (mass, moment): (f64, f64), gravity: f64) -> f64 {
    let (linear, angular) = (motion.linear(sample, body), motion.angular(sample, body));
    mass * (linear.norm_squared() / 2.0 + gravity * motion.position(sample, body).z) + moment * angular.norm_squared() / 2.0
}
