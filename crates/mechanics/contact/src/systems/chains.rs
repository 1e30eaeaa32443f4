//! Rows of bodies: stacks at rest, and balls that collide.

use crate::malformed::Malformed;
use crate::problem::{Contact, Level, Mechanism, Problem};
use nalgebra::{DMatrix, DVector};

/// Bodies on top of each other at rest, the lowest first. No friction; forces.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    /// The masses in kg, from the ground up.
    pub masses: Vec<f64>,
    /// g in m/s².
    pub gravity: f64,
}

impl Stack {
    /// A body of this mass on a body of 1 kg.
    pub fn two(ratio: f64) -> Self {
        Self { masses: vec![1.0, ratio], gravity: 9.81 }
    }

    /// Bodies of 1 kg.
    pub fn equal(count: usize) -> Self {
        Self { masses: vec![1.0; count], gravity: 9.81 }
    }

    /// The problem: contact k is below body k.
    ///
    /// # Errors
    /// [`Malformed`] if a mass is not positive or there is none.
    pub fn problem(&self) -> Result<Problem, Malformed> {
        let count = self.masses.len();
        let mut jacobian = DMatrix::identity(count, count);
        (1..count).for_each(|k| jacobian[(k, k - 1)] = -1.0);
        let contacts = (0..count).map(|k| Contact::frictionless(format!("below {k}"))).collect();
        let mass = DMatrix::from_diagonal(&DVector::from_row_slice(&self.masses));
        let free = DVector::from_element(count, -self.gravity);
        Problem::from_mechanism("stack", Level::Force, contacts, Mechanism { mass, jacobian, free })
    }

    /// The forces: each contact carries the weight above it.
    pub fn forces(&self) -> Vec<f64> {
        (0..self.masses.len()).map(|k| self.gravity * self.masses[k..].iter().sum::<f64>()).collect()
    }

    /// The rate of Gauss–Seidel where a closed form is known: R/(1 + R) of two bodies, cos²(π/2n) of n equal ones.
    pub fn rate(&self) -> Option<f64> {
        match self.masses[..] {
            [below, above] => Some(above / (below + above)),
            [first, ..] if self.masses.iter().all(|m| *m == first) => {
                Some((std::f64::consts::FRAC_PI_2 / self.masses.len() as f64).cos().powi(2))
            }
            _ => None,
        }
    }
}

/// Balls in a row on a line that touch each other. No friction; impulses.
#[derive(Clone, Debug, PartialEq)]
pub struct Cradle {
    /// The masses in kg, from left to right.
    pub masses: Vec<f64>,
    /// The velocities before, in m/s, to the right.
    pub velocities: Vec<f64>,
    /// e of every contact.
    pub restitution: f64,
}

impl Default for Cradle {
    /// Three balls of 1 kg; the left one hits the others at 1 m/s without loss.
    fn default() -> Self {
        Self { masses: vec![1.0; 3], velocities: vec![1.0, 0.0, 0.0], restitution: 1.0 }
    }
}

impl Cradle {
    /// The problem: contact k is between balls k and k + 1.
    ///
    /// # Errors
    /// [`Malformed`] if a mass is not positive, there are fewer than two balls, or their numbers differ.
    pub fn problem(&self) -> Result<Problem, Malformed> {
        let count = self.masses.len();
        let gaps = count.saturating_sub(1);
        let mut jacobian = DMatrix::zeros(gaps, count);
        for k in 0..gaps {
            jacobian[(k, k)] = -1.0;
            jacobian[(k, k + 1)] = 1.0;
        }
        let contact = |k| Contact::frictionless(format!("{k} and {}", k + 1)).with_restitution(self.restitution);
        let mass = DMatrix::from_diagonal(&DVector::from_row_slice(&self.masses));
        let mechanism = Mechanism { mass, jacobian, free: DVector::from_row_slice(&self.velocities) };
        Problem::from_mechanism("cradle", Level::Impulse, (0..gaps).map(contact).collect(), mechanism)
    }

    /// The balls' velocities after impulses at the contacts.
    pub fn velocities_after(&self, impulses: &[f64]) -> Vec<f64> {
        let impulse = |k: usize| impulses.get(k).copied().unwrap_or(0.0);
        let left = |k: usize| if k == 0 { 0.0 } else { impulse(k - 1) };
        self.velocities.iter().zip(&self.masses).enumerate().map(|(k, (v, m))| v + (left(k) - impulse(k)) / m).collect()
    }
}
