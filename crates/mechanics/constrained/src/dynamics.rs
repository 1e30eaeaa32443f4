//! Dynamics on a graph: what its states accelerate by.
//!
//! A graph of links and joints says how a robot is connected. [`Dynamics`] says how it moves: q, v and τ in, v̇ out.
//!
//! | | equations | cost |
//! |---|---|---|
//! | [`Tree`] | M v̇ + h = τ, by the articulated-body algorithm (the book, table 7.1) | O(n) |
//! | [`Closed`] | M v̇ + h = τ + Jᵀλ, J v̇ + J̇v = 0, by a [`Method`] | that of the method |
//!
//! [`Mechanism::dynamics`](crate::Mechanism::dynamics) takes a graph to its dynamics. Coordinates are those of the model: units m, rad, s, N.

use crate::constraint::Constraints;
use crate::error::Error;
use crate::rows::expect_finite;
use crate::solve::{Constrained, Method};
use featherbench_dynamics::{Aba, DimensionError};
use featherbench_model::Model;

/// The accelerations of a robot's states.
pub trait Dynamics {
    /// The name of the algorithm.
    fn name(&self) -> &str;

    /// `acceleration` = v̇ at configuration `q` and velocity `v` with joint forces `tau`, in the model's order of degrees of freedom.
    ///
    /// # Errors
    /// [`Error`]: an argument does not fit or is not finite, or the equations have no solution there. `acceleration` then means nothing.
    fn acceleration(&mut self, q: &[f64], v: &[f64], tau: &[f64], acceleration: &mut [f64]) -> Result<(), Error>;
}

/// The dynamics of a tree: nothing ties it.
#[derive(Clone, Debug)]
pub struct Tree<'a> {
    model: &'a Model<f64>,
    aba: Aba<f64>,
}

impl<'a> Tree<'a> {
    /// A workspace for a model.
    pub fn new(model: &'a Model<f64>) -> Self {
        Self { model, aba: Aba::new(&model.topology) }
    }
}

impl Dynamics for Tree<'_> {
    fn name(&self) -> &str {
        "aba"
    }

    fn acceleration(&mut self, q: &[f64], v: &[f64], tau: &[f64], acceleration: &mut [f64]) -> Result<(), Error> {
        expect_finite("configuration q", q)?;
        expect_finite("velocity v", v)?;
        expect_finite("joint forces tau", tau)?;
        self.aba.run(self.model, q, v, tau, None, acceleration)?;
        expect_finite("acceleration", acceleration)
    }
}

/// The dynamics of a tree with constraints, by a method.
pub struct Closed<'a> {
    constrained: Constrained<'a>,
    method: &'a dyn Method,
}

impl<'a> Closed<'a> {
    /// A workspace for a model, its constraints and a method.
    ///
    /// # Errors
    /// [`Error::OtherTree`] when the constraints were made for another tree.
    pub fn new(model: &'a Model<f64>, constraints: &'a Constraints, method: &'a dyn Method) -> Result<Self, Error> {
        Ok(Self { constrained: Constrained::new(model, constraints)?, method })
    }
}

impl Dynamics for Closed<'_> {
    fn name(&self) -> &str {
        self.method.name()
    }

    fn acceleration(&mut self, q: &[f64], v: &[f64], tau: &[f64], acceleration: &mut [f64]) -> Result<(), Error> {
        let solution = self.constrained.run(q, v, tau, self.method)?;
        DimensionError::expect("accelerations", solution.acceleration.len(), acceleration.len())?;
        acceleration.copy_from_slice(&solution.acceleration);
        Ok(())
    }
}
