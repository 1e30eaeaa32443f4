//! Rigid bodies in the plane: a sphere that begins to roll, a box on balls, a rocking block.

use crate::malformed::Malformed;
use crate::problem::{Contact, Level, Mechanism, Problem};
use nalgebra::{DMatrix, DVector};

/// A sphere that slides without spin on the ground, during one step of any length.
///
/// It slides until t* = 2v₀/(7μg) and rolls with 5v₀/7 afterwards. Friction has one direction throughout, so one step is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlidingSphere {
    /// The mass in kg.
    pub mass: f64,
    /// The radius in m.
    pub radius: f64,
    /// v₀ in m/s.
    pub speed: f64,
    /// μ.
    pub friction: f64,
    /// g in m/s².
    pub gravity: f64,
    /// The step in s.
    pub duration: f64,
}

impl Default for SlidingSphere {
    /// 1 kg, radius 0.1 m, v₀ = 5 m/s, μ = 0.3, g = 9.81, 1 s.
    fn default() -> Self {
        Self { mass: 1.0, radius: 0.1, speed: 5.0, friction: 0.3, gravity: 9.81, duration: 1.0 }
    }
}

impl SlidingSphere {
    /// The problem: dofs x, z and spin; one planar contact.
    ///
    /// # Errors
    /// [`Malformed`] if a parameter is not finite or out of its range.
    pub fn problem(&self) -> Result<Problem, Malformed> {
        let (m, r) = (self.mass, self.radius);
        let mass = DMatrix::from_diagonal(&DVector::from_vec(vec![m, m, 0.4 * m * r * r]));
        let jacobian = DMatrix::from_row_slice(2, 3, &[0.0, 1.0, 0.0, 1.0, 0.0, -r]);
        let free = DVector::from_vec(vec![self.speed, -self.gravity * self.duration, 0.0]);
        Problem::from_mechanism(
            "sliding_sphere",
            Level::Impulse,
            vec![Contact::planar("ground", self.friction)],
            Mechanism { mass, jacobian, free },
        )
    }

    /// t* = 2v₀/(7μg) in s.
    pub fn slides(&self) -> f64 {
        2.0 * self.speed / (7.0 * self.friction * self.gravity)
    }

    /// The speed after the step: v₀ − μ g h while it slides, then 5v₀/7.
    pub fn speed_after(&self) -> f64 {
        if self.duration < self.slides() { self.speed - self.friction * self.gravity * self.duration } else { 5.0 * self.speed / 7.0 }
    }
}

/// A box that is pulled over balls on the ground, from rest, in the plane. The force acts at the height of the balls' tops.
///
/// Each ball touches the ground and the box. While nothing slips the box accelerates with F/(M + 7nm/20), the balls half as much. The
/// normal forces are redundant: 2n rows for n + 1 vertical dofs. So the answer is not unique with several balls: where the load is uneven,
/// balls with little load may slip, and the box is faster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxOnBalls {
    /// M in kg.
    pub box_mass: f64,
    /// n.
    pub balls: usize,
    /// m in kg.
    pub ball_mass: f64,
    /// The radius in m.
    pub radius: f64,
    /// μ between balls and ground.
    pub ground_friction: f64,
    /// μ between box and balls.
    pub box_friction: f64,
    /// F in N.
    pub force: f64,
    /// g in m/s².
    pub gravity: f64,
}

impl Default for BoxOnBalls {
    /// The numbers of SimBenchmark's rolling test: 10 kg on 25 balls of 1 kg, μ 0.4 and 0.8, 150 N.
    fn default() -> Self {
        Self {
            box_mass: 10.0,
            balls: 25,
            ball_mass: 1.0,
            radius: 0.1,
            ground_friction: 0.4,
            box_friction: 0.8,
            force: 150.0,
            gravity: 9.81,
        }
    }
}

impl BoxOnBalls {
    /// The problem: dofs x and z of the box, then x, z and spin of each ball; contacts ground, box of each ball.
    ///
    /// # Errors
    /// [`Malformed`] if a parameter is not finite or out of its range.
    pub fn problem(&self) -> Result<Problem, Malformed> {
        let dofs = 2 + 3 * self.balls;
        let (mut masses, mut free) = (vec![self.box_mass; 2], vec![self.force / self.box_mass, -self.gravity]);
        let mut jacobian = DMatrix::zeros(4 * self.balls, dofs);
        let mut contacts = Vec::new();
        for ball in 0..self.balls {
            masses.extend([self.ball_mass, self.ball_mass, 0.4 * self.ball_mass * self.radius * self.radius]);
            free.extend([0.0, -self.gravity, 0.0]);
            let (row, x) = (4 * ball, 2 + 3 * ball);
            // Below: the ball against the ground. A positive spin rolls along +x.
            (jacobian[(row, x + 1)], jacobian[(row + 1, x)], jacobian[(row + 1, x + 2)]) = (1.0, 1.0, -self.radius);
            // Above: the box against the ball.
            (jacobian[(row + 2, 1)], jacobian[(row + 2, x + 1)]) = (1.0, -1.0);
            (jacobian[(row + 3, 0)], jacobian[(row + 3, x)], jacobian[(row + 3, x + 2)]) = (1.0, -1.0, -self.radius);
            contacts.push(Contact::planar(format!("ground {ball}"), self.ground_friction));
            contacts.push(Contact::planar(format!("box {ball}"), self.box_friction));
        }
        let mass = DMatrix::from_diagonal(&DVector::from_vec(masses));
        Problem::from_mechanism("box_on_balls", Level::Force, contacts, Mechanism { mass, jacobian, free: DVector::from_vec(free) })
    }

    /// The acceleration of the box while nothing slips, in m/s².
    pub fn acceleration(&self) -> f64 {
        self.force / (self.box_mass + 0.35 * self.balls as f64 * self.ball_mass)
    }

    /// The forces while nothing slips and every ball carries the same load, in the order of the problem's rows.
    pub fn even_forces(&self) -> DVector<f64> {
        let load = self.box_mass * self.gravity / self.balls as f64;
        let pull = self.ball_mass * self.acceleration();
        let ball = [load + self.ball_mass * self.gravity, 0.15 * pull, load, -0.35 * pull];
        DVector::from_iterator(4 * self.balls, ball.into_iter().cycle().take(4 * self.balls))
    }
}

/// A block that rocks from one corner to the other, at the moment when it is flat.
///
/// Without restitution, and with enough friction, its rate falls by Housner's ratio r = 1 − (3/2) sin²α with tan α = width/height.
///
/// Source: G. W. Housner, *The behavior of inverted pendulum structures during earthquakes* (1963).
///
/// ```
/// let block = featherbench_contact::systems::RockingBlock::default();
/// assert!((block.ratio() - 31.0 / 34.0).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RockingBlock {
    /// The mass in kg.
    pub mass: f64,
    /// Half the width in m.
    pub half_width: f64,
    /// Half the height in m.
    pub half_height: f64,
    /// The rate before, in rad/s; positive.
    pub rate: f64,
    /// μ of both corners.
    pub friction: f64,
}

impl Default for RockingBlock {
    /// 1 kg, half width 0.25 m, half height 1 m, 1 rad/s, μ = 1.
    fn default() -> Self {
        Self { mass: 1.0, half_width: 0.25, half_height: 1.0, rate: 1.0, friction: 1.0 }
    }
}

impl RockingBlock {
    /// The problem: dofs x, z and turn; contacts left and right corner. The block turns about the left corner, and the right one lands.
    ///
    /// # Errors
    /// [`Malformed`] if a parameter is not finite or out of its range.
    pub fn problem(&self) -> Result<Problem, Malformed> {
        let (m, b, h) = (self.mass, self.half_width, self.half_height);
        let mass = DMatrix::from_diagonal(&DVector::from_vec(vec![m, m, m * (b * b + h * h) / 3.0]));
        // A corner at (x, −h) from the centre moves by (vx + ω h, vz + ω x).
        let jacobian = DMatrix::from_row_slice(4, 3, &[0.0, 1.0, -b, 1.0, 0.0, h, 0.0, 1.0, b, 1.0, 0.0, h]);
        let turn = -self.rate;
        let free = DVector::from_vec(vec![-turn * h, turn * b, turn]);
        let contacts = vec![Contact::planar("left", self.friction), Contact::planar("right", self.friction)];
        Problem::from_mechanism("rocking_block", Level::Impulse, contacts, Mechanism { mass, jacobian, free })
    }

    /// Housner's ratio of the rates after and before.
    pub fn ratio(&self) -> f64 {
        let (b, h) = (self.half_width, self.half_height);
        1.0 - 1.5 * b * b / (b * b + h * h)
    }
}
