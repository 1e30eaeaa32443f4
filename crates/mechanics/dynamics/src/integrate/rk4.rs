//! The classical Runge–Kutta method of order 4, on the configuration space.
//!
//! Source: W. Kutta (1901); its form on manifolds: see `explicit.rs`. Order 4. It keeps no structure but the length of quaternions: energy and
//! momentum drift at its order. Frames, shapes, units: as in [`crate::Aba`]. Cost of a step: 4 accelerations. A call does not allocate.

use super::dynamics::Acceleration;
use super::explicit::{Explicit, Tableau};
use super::{IntegrationError, Integrator, Linearise};
use featherbench_model::Topology;
use featherbench_spatial::Angle;

const TABLEAU: Tableau = Tableau {
    nodes: &[(0.0, 1.0), (1.0, 2.0), (1.0, 2.0), (1.0, 1.0)],
    rows: &[&[], &[(1.0, 2.0)], &[(0.0, 1.0), (1.0, 2.0)], &[(0.0, 1.0), (0.0, 1.0), (1.0, 1.0)]],
    weights: &[(1.0, 6.0), (1.0, 3.0), (1.0, 3.0), (1.0, 6.0)],
};

/// The workspace of the Runge–Kutta method of order 4.
#[derive(Clone, Debug)]
pub struct RungeKutta4<T> {
    method: Explicit<T>,
}

impl<T: Angle> RungeKutta4<T> {
    /// A workspace for steps of this tree.
    pub fn new(topology: &Topology) -> Self {
        Self { method: Explicit::new(topology, &TABLEAU) }
    }

    /// A workspace for steps and their derivatives with this many inputs.
    pub fn with_derivatives(topology: &Topology, inputs: usize) -> Self {
        Self { method: Explicit::with_derivatives(topology, &TABLEAU, inputs) }
    }
}

impl<T: Angle> Integrator<T> for RungeKutta4<T> {
    const ORDER: u32 = 4;

    fn step<F: Acceleration<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        self.method.step(f, t, h, q, v)
    }

    fn linearise<F: Linearise<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        self.method.linearise(f, t, h, q, v)
    }

    fn push(&mut self, dq: &mut [T], dv: &mut [T], du: &[T]) {
        self.method.push(dq, dv, du);
    }

    fn pull(&mut self, lq: &mut [T], lv: &mut [T], lu: &mut [T]) {
        self.method.pull(lq, lv, lu);
    }
}
