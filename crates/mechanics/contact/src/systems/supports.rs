//! Bodies on more supports than they have dofs: a table on four legs, flat feet.

use crate::malformed::Malformed;
use crate::problem::{Contact, Level, Mechanism, Problem};
use nalgebra::{DMatrix, DVector};

/// A table on four legs at the corners of a square. Three equations for four forces; no friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// The weight in N.
    pub weight: f64,
    /// The centre of mass in m.
    pub centre: [f64; 2],
    /// Half the side of the square in m.
    pub half_side: f64,
}

impl Default for Table {
    /// 10 N at (0.1, 0.05), legs at ±0.5.
    fn default() -> Self {
        Self { weight: 10.0, centre: [0.1, 0.05], half_side: 0.5 }
    }
}

/// g, by which a weight becomes a mass, and the radius of gyration of the plate. Neither changes the static forces.
const GRAVITY: f64 = 9.81;
const GYRATION: f64 = 0.25;

impl Table {
    /// The signs of the legs' coordinates, around the table.
    const LEGS: [[f64; 2]; 4] = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];

    /// The problem: dofs z and two tilts of the plate about its centre of mass.
    ///
    /// # Errors
    /// [`Malformed`] if a parameter is not finite or the weight is not positive.
    pub fn problem(&self) -> Result<Problem, Malformed> {
        let mass = self.weight / GRAVITY;
        let inertia = mass * GYRATION * GYRATION;
        let mut jacobian = DMatrix::zeros(4, 3);
        for (row, leg) in Self::LEGS.iter().enumerate() {
            let from_centre = [leg[0] * self.half_side - self.centre[0], leg[1] * self.half_side - self.centre[1]];
            (jacobian[(row, 0)], jacobian[(row, 1)], jacobian[(row, 2)]) = (1.0, from_centre[1], -from_centre[0]);
        }
        let contacts = (0..4).map(|leg| Contact::frictionless(format!("leg {leg}"))).collect();
        let mass = DMatrix::from_diagonal(&DVector::from_vec(vec![mass, inertia, inertia]));
        let free = DVector::from_vec(vec![-GRAVITY, 0.0, 0.0]);
        Problem::from_mechanism("table", Level::Force, contacts, Mechanism { mass, jacobian, free })
    }

    /// The forces of least norm: W/4 (1 + (x_c x_i + y_c y_i)/a²), by symmetry of the square.
    pub fn least_forces(&self) -> [f64; 4] {
        let a = self.half_side;
        Self::LEGS.map(|leg| 0.25 * self.weight * (1.0 + (self.centre[0] * leg[0] + self.centre[1] * leg[1]) / a))
    }

    /// How far forces are from the line of all forces that carry the table: least forces + s (1, −1, 1, −1).
    ///
    /// NaN for another number of forces than four.
    pub fn distance(&self, forces: &[f64]) -> f64 {
        if forces.len() != 4 {
            return f64::NAN;
        }
        let difference: Vec<f64> = forces.iter().zip(self.least_forces()).map(|(a, b)| a - b).collect();
        let along = 0.25 * (difference[0] - difference[1] + difference[2] - difference[3]);
        let off = [difference[0] - along, difference[1] + along, difference[2] - along, difference[3] + along];
        off.iter().map(|x| x * x).sum::<f64>().sqrt()
    }
}

/// Flat rectangular feet, each a free rigid body with a load above it: four spatial contacts per foot, 12 rows of rank 6.
#[derive(Clone, Debug, PartialEq)]
pub struct Feet {
    /// How many feet.
    pub count: usize,
    /// Half length and half width in m.
    pub half_sides: [f64; 2],
    /// The height of the centre of mass above the sole, in m.
    pub height: f64,
    /// The mass of each foot with its load, in kg.
    pub mass: f64,
    /// μ.
    pub friction: f64,
    /// The velocity of each foot without contact: [linear; angular] in m/s and rad/s, in world axes with z up.
    pub free: [f64; 6],
}

impl Default for Feet {
    /// Two feet of 10 kg that press down and are pushed sideways within their friction.
    fn default() -> Self {
        let free = [0.02, 0.01, -0.1, 0.05, -0.03, 0.02];
        Self { count: 2, half_sides: [0.1, 0.05], height: 0.05, mass: 10.0, friction: 0.7, free }
    }
}

impl Feet {
    /// The problem: six dofs per foot, the linear ones first.
    ///
    /// # Errors
    /// [`Malformed`] if a parameter is not finite or out of its range.
    pub fn problem(&self) -> Result<Problem, Malformed> {
        let [a, b] = self.half_sides;
        let (mut masses, mut free, mut contacts) = (Vec::new(), Vec::new(), Vec::new());
        let mut jacobian = DMatrix::zeros(12 * self.count, 6 * self.count);
        let inertia = |p: f64, q: f64| self.mass * (p * p + q * q) / 3.0;
        for foot in 0..self.count {
            masses.extend([self.mass; 3]);
            masses.extend([inertia(b, self.height), inertia(a, self.height), inertia(a, b)]);
            free.extend(self.free);
            for (corner, [x, y]) in [[a, b], [-a, b], [-a, -b], [a, -b]].into_iter().enumerate() {
                let (row, dof, z) = (12 * foot + 3 * corner, 6 * foot, -self.height);
                // v + ω × r, rows z, x, y: the normal first.
                (jacobian[(row, dof + 2)], jacobian[(row, dof + 3)], jacobian[(row, dof + 4)]) = (1.0, y, -x);
                (jacobian[(row + 1, dof)], jacobian[(row + 1, dof + 4)], jacobian[(row + 1, dof + 5)]) = (1.0, z, -y);
                (jacobian[(row + 2, dof + 1)], jacobian[(row + 2, dof + 3)], jacobian[(row + 2, dof + 5)]) = (1.0, -z, x);
                contacts.push(Contact::spatial(format!("foot {foot} corner {corner}"), self.friction));
            }
        }
        let mass = DMatrix::from_diagonal(&DVector::from_vec(masses));
        Problem::from_mechanism("feet", Level::Impulse, contacts, Mechanism { mass, jacobian, free: DVector::from_vec(free) })
    }
}
