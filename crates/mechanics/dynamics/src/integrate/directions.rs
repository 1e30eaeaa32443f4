//! The numbers on which a right-hand side depends, as duals, and one direction after the other in which they change.
//!
//! Source: forward-mode differentiation; the direction δq enters as `q ⊕ ε δq`. Shapes: `nq` numbers of q, `nv` of v, then controls and
//! parameters. Cost: that of what is called, once per direction. A call does not allocate.

use crate::error::expect;
use crate::{DimensionError, Error};
use featherbench_model::Topology;
use featherbench_spatial::{Angle, Dual, Real};

/// q, v, controls and parameters as duals. All rates are zero but in a direction.
#[derive(Clone, Debug)]
pub(super) struct Directions<T> {
    topology: Topology,
    pub(super) q: Vec<Dual<T>>,
    pub(super) v: Vec<Dual<T>>,
    pub(super) controls: Vec<Dual<T>>,
    pub(super) parameters: Vec<Dual<T>>,
}

/// Which inputs change in a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Input {
    Control,
    Parameter,
}

impl<T: Angle> Directions<T> {
    /// Controls of zero, and these parameters.
    pub(super) fn new(topology: Topology, controls: usize, parameters: &[T]) -> Self {
        let zeros = |count| vec![Dual::constant(T::zero()); count];
        let parameters = parameters.iter().map(|x| Dual::constant(*x)).collect();
        Self { q: zeros(topology.nq()), v: zeros(topology.nv()), controls: zeros(controls), parameters, topology }
    }

    /// How many inputs there are: controls, then parameters.
    pub(super) fn inputs(&self) -> usize {
        self.controls.len() + self.parameters.len()
    }

    /// The state from which the directions go.
    pub(super) fn set_state(&mut self, q: &[T], v: &[T]) -> Result<(), DimensionError> {
        expect("configuration q", self.q.len(), q.len())?;
        expect("velocity v", self.v.len(), v.len())?;
        copy(&mut self.q, q);
        copy(&mut self.v, v);
        Ok(())
    }

    /// Calls `column` with the duals and the number of each direction of q.
    pub(super) fn by_q(&mut self, mut column: impl FnMut(&Self, usize) -> Result<(), Error>) -> Result<(), Error> {
        for body in 0..self.topology.bodies() {
            let joint = self.topology.joints()[body];
            let (at, width) = (joint.q, joint.kind.nq());
            let mut still = [Dual::constant(T::zero()); 7];
            still[..width].copy_from_slice(&self.q[at..at + width]);
            for k in 0..joint.kind.nv() {
                let mut direction = [Dual::constant(T::zero()); 6];
                direction[k].derivative = T::one();
                joint.kind.integrate(&still, &direction, &mut self.q[at..]);
                column(self, joint.v + k)?;
            }
            self.q[at..at + width].copy_from_slice(&still[..width]);
        }
        Ok(())
    }

    /// The same for each direction of v.
    pub(super) fn by_v(&mut self, mut column: impl FnMut(&Self, usize) -> Result<(), Error>) -> Result<(), Error> {
        for dof in 0..self.v.len() {
            self.v[dof].derivative = T::one();
            let done = column(self, dof);
            self.v[dof].derivative = T::zero();
            done?;
        }
        Ok(())
    }

    /// The same for each control, then for each parameter.
    pub(super) fn by_inputs(&mut self, mut column: impl FnMut(&Self, Input, usize) -> Result<(), Error>) -> Result<(), Error> {
        let controls = self.controls.len();
        for k in 0..controls {
            self.controls[k].derivative = T::one();
            let done = column(self, Input::Control, k);
            self.controls[k].derivative = T::zero();
            done?;
        }
        for k in 0..self.parameters.len() {
            self.parameters[k].derivative = T::one();
            let done = column(self, Input::Parameter, controls + k);
            self.parameters[k].derivative = T::zero();
            done?;
        }
        Ok(())
    }
}

/// Values as constants.
pub(super) fn copy<T: Real>(duals: &mut [Dual<T>], values: &[T]) {
    for (dual, value) in duals.iter_mut().zip(values) {
        *dual = Dual::constant(*value);
    }
}
