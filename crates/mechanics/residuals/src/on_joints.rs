//! A residual of some joints, as one of the whole robot.

use crate::{Residual, ResidualError, State};
use nalgebra::DMatrix;

/// A residual that sees and moves chosen joints alone.
#[derive(Debug)]
pub(crate) struct OnJoints<R> {
    pub nq: usize,
    pub nv: usize,
    /// The joints' numbers in q.
    pub coordinates: Vec<usize>,
    /// The joints' numbers in v.
    pub dofs: Vec<usize>,
    /// The residual, for as many dofs.
    pub of: R,
}

/// Some numbers of a list.
pub(crate) fn chosen(places: &[usize], list: &[f64]) -> Vec<f64> {
    places.iter().map(|&place| list[place]).collect()
}

impl<R: Residual> OnJoints<R> {
    /// Asks the residual at its own part of a state.
    fn ask<T>(&self, state: &State<'_>, of: impl FnOnce(&R, &State<'_>) -> T) -> T {
        let (q, v, a) = (chosen(&self.coordinates, state.q), chosen(&self.dofs, state.v), chosen(&self.dofs, state.a));
        let command = if state.command.is_empty() { Vec::new() } else { chosen(&self.dofs, state.command) };
        of(&self.of, &State { q: &q, v: &v, a: &a, command: &command, inner: state.inner })
    }
}

impl<R: Residual> Residual for OnJoints<R> {
    fn nv(&self) -> usize {
        self.nv
    }

    fn nq(&self) -> Option<usize> {
        Some(self.nq)
    }

    fn add(&self, state: &State<'_>, r: &mut [f64]) -> Result<(), ResidualError> {
        let mut own = vec![0.0; self.dofs.len()];
        self.ask(state, |residual, state| residual.add(state, &mut own))?;
        self.dofs.iter().zip(own).for_each(|(&dof, own)| r[dof] += own);
        Ok(())
    }

    fn has_acceleration(&self) -> bool {
        self.of.has_acceleration()
    }

    fn add_by_acceleration(&self, state: &State<'_>, matrix: &mut DMatrix<f64>) -> Result<(), ResidualError> {
        let mut own = DMatrix::zeros(self.dofs.len(), self.dofs.len());
        self.ask(state, |residual, state| residual.add_by_acceleration(state, &mut own))?;
        for (i, &row) in self.dofs.iter().enumerate() {
            self.dofs.iter().enumerate().for_each(|(j, &column)| matrix[(row, column)] += own[(i, j)]);
        }
        Ok(())
    }

    fn inner(&self) -> usize {
        self.of.inner()
    }

    fn inner_rate(&self, state: &State<'_>, rate: &mut [f64]) -> Result<(), ResidualError> {
        self.ask(state, |residual, state| residual.inner_rate(state, rate))
    }
}
