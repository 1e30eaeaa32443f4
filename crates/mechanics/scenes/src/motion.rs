//! What an engine answers: the bodies over time, and the last contacts' forces.

use crate::scene::SceneError;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Numbers of a body in a sample: position, quaternion (x, y, z, w), velocity of the centre of mass, angular velocity.
const BODY: usize = 13;
/// Numbers of a push.
const PUSH: usize = 8;

/// The force of a contact during the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// The body that the force acts on.
    pub on: usize,
    /// The body that it comes from; none is the ground.
    pub from: Option<usize>,
    /// Where, m.
    pub at: Vector3<f64>,
    /// N.
    pub force: Vector3<f64>,
}

/// Bodies over time, in world axes. Sample k is after `every·(k + 1)` steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    bodies: usize,
    samples: Vec<f64>,
    /// The contacts of the last step.
    pub pushes: Vec<Push>,
}

impl Motion {
    /// The motion of the numbers of an answer: of each sample and body thirteen, of each push eight (on, from, point, force; −1 is the ground).
    ///
    /// # Errors
    /// [`SceneError::Malformed`] when numbers are missing or a push is of no body.
    pub fn new(bodies: usize, samples: Vec<f64>, pushes: &[f64]) -> Result<Self, SceneError> {
        let wrong = |field: &str, problem| SceneError::Malformed { field: field.into(), problem };
        if bodies == 0 || samples.is_empty() || !samples.len().is_multiple_of(BODY * bodies) {
            return Err(wrong("motion", "must have thirteen numbers for each sample and body"));
        }
        if !pushes.len().is_multiple_of(PUSH) {
            return Err(wrong("contacts", "must have eight numbers for each contact"));
        }
        let body = |number: f64| (0..bodies).find(|&body| body as f64 == number);
        let push = |numbers: &[f64]| {
            let on = body(numbers[0]).ok_or_else(|| wrong("contacts", "a force acts on a body of the scene"))?;
            let from = body(numbers[1]);
            if from.is_none() && numbers[1] != -1.0 {
                return Err(wrong("contacts", "a force comes from a body of the scene or from the ground, −1"));
            }
            let vector = |at: usize| Vector3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
            Ok(Push { on, from, at: vector(2), force: vector(5) })
        };
        let pushes = pushes.chunks_exact(PUSH).map(push).collect::<Result<_, _>>()?;
        Ok(Self { bodies, samples, pushes })
    }

    /// How many samples there are.
    pub fn samples(&self) -> usize {
        self.samples.len() / (BODY * self.bodies)
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        let forces = self.pushes.iter().flat_map(|push| push.at.iter().chain(push.force.iter()));
        self.samples.iter().chain(forces).all(|x| x.is_finite())
    }

    /// The numbers of a body in a sample; NaN where there is none, so that no measure of it passes.
    fn numbers(&self, sample: usize, body: usize) -> [f64; BODY] {
        let start = (sample * self.bodies + body) * BODY;
        let found = self.samples.get(start..start + BODY).filter(|_| body < self.bodies);
        found.and_then(|numbers| numbers.try_into().ok()).unwrap_or([f64::NAN; BODY])
    }

    /// Where a body's centre of mass is, m.
    pub fn position(&self, sample: usize, body: usize) -> Vector3<f64> {
        let x = self.numbers(sample, body);
        Vector3::new(x[0], x[1], x[2])
    }

    /// Body to world.
    pub fn orientation(&self, sample: usize, body: usize) -> UnitQuaternion<f64> {
        let x = self.numbers(sample, body);
        UnitQuaternion::from_quaternion(Quaternion::new(x[6], x[3], x[4], x[5]))
    }

    /// The velocity of a body's centre of mass, m/s.
    pub fn linear(&self, sample: usize, body: usize) -> Vector3<f64> {
        let x = self.numbers(sample, body);
        Vector3::new(x[7], x[8], x[9])
    }

    /// A body's angular velocity, rad/s.
    pub fn angular(&self, sample: usize, body: usize) -> Vector3<f64> {
        let x = self.numbers(sample, body);
        Vector3::new(x[10], x[11], x[12])
    }

    /// The last sample.
    pub fn last(&self) -> usize {
        self.samples().saturating_sub(1)
    }
}
