//! A robot's state, and its true answers, in an engine's own numbers: `v_e = T v`, `a_e = T a + b`, `τ_e = T τ` with an orthogonal T
//! (CONVENTIONS.md).

use featherbench_bench::{Quantity, Robot};
use featherbench_rbd::{Convention, Error, Robot as LibraryRobot};

/// q_e, T and b at the first state of a robot.
pub struct Theirs {
    /// The engine's configuration.
    pub q: Vec<f64>,
    /// The rows of T.
    pub t: Vec<Vec<f64>>,
    /// The engine's acceleration where the neutral one is zero.
    pub b: Vec<f64>,
}

impl Theirs {
    /// Those of an engine whose coordinates the library knows; `None` if the engine does not have a joint of the robot.
    pub fn of(robot: &Robot, convention: Convention) -> Option<Self> {
        Self::by_library(robot, convention).ok()
    }

    fn by_library(robot: &Robot, convention: Convention) -> Result<Self, Error> {
        let (q, v, nv) = (robot.states.q(0), robot.states.v(0), robot.states.nv);
        let robot = LibraryRobot::from_description(&robot.description)?;
        let unit = |k: usize| (0..nv).map(|i| if i == k { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = (0..nv).map(|k| robot.velocity_to(convention, q, &unit(k))).collect::<Result<_, _>>()?;
        Ok(Self {
            q: robot.configuration_to(convention, q)?,
            t: (0..nv).map(|i| columns.iter().map(|column| column[i]).collect()).collect(),
            b: robot.acceleration_to(convention, q, v, &vec![0.0; nv])?,
        })
    }

    /// Whether the engine's velocities, accelerations and forces are the neutral ones.
    pub fn are_neutral(&self) -> bool {
        let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        let is_unit = self.t.iter().enumerate().all(|(i, row)| row.iter().enumerate().all(|(j, x)| *x == unit(i, j)));
        is_unit && self.b.iter().all(|b| *b == 0.0)
    }

    /// T x: velocities and forces.
    pub fn turned(&self, x: &[f64]) -> Vec<f64> {
        self.t.iter().map(|row| row.iter().zip(x).map(|(t, x)| t * x).sum()).collect()
    }

    /// T a + b.
    pub fn acceleration(&self, a: &[f64]) -> Vec<f64> {
        self.turned(a).iter().zip(&self.b).map(|(a, b)| a + b).collect()
    }

    /// |T| s: at least the magnitudes s in the engine's axes, and at most √3 times as much, as T turns by threes.
    pub fn magnitudes(&self, s: &[f64]) -> Vec<f64> {
        self.t.iter().map(|row| row.iter().zip(s).map(|(t, s)| t.abs() * s).sum()).collect()
    }

    /// T M Tᵀ, row after row.
    pub fn mass(&self, mass: &[f64]) -> Vec<f64> {
        let half: Vec<Vec<f64>> = mass.chunks_exact(self.t.len().max(1)).map(|row| self.turned(row)).collect();
        let column = |j: usize| half.iter().map(|row| row[j]).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = (0..self.t.len()).map(|j| self.turned(&column(j))).collect();
        (0..self.t.len()).flat_map(|i| columns.iter().map(move |column| column[i])).collect()
    }

    /// The engine's answer that belongs to a neutral one, at a mass matrix; `None` where the way is longer than T and b.
    pub fn answer(&self, quantity: Quantity, neutral: &[f64], mass: &[f64]) -> Option<Vec<f64>> {
        Some(match quantity {
            Quantity::InverseDynamics => self.turned(neutral),
            Quantity::ForwardDynamics | Quantity::ForwardDynamicsSingle => self.acceleration(neutral),
            Quantity::MassMatrix => self.mass(neutral),
            Quantity::Bias => {
                let of_b = self
                    .mass(mass)
                    .chunks_exact(self.b.len().max(1))
                    .map(|row| row.iter().zip(&self.b).map(|(m, b)| m * b).sum::<f64>())
                    .collect::<Vec<_>>();
                self.turned(neutral).iter().zip(of_b).map(|(h, mb)| h - mb).collect()
            }
            Quantity::KineticEnergy => neutral.to_vec(),
            _ if self.are_neutral() => neutral.to_vec(),
            _ => return None,
        })
    }
}
