//! The symplectic Euler method: `v' = v + h a(t, q, v)`, `q' = q ⊕ h v'`.
//!
//! Source: Hairer, Lubich and Wanner, *Geometric Numerical Integration* (2006), §I.1.2; on Lie groups the increment stands on the right.
//! Order 1. It is symplectic where M is constant and forces depend on q alone; elsewhere it is explicit and keeps no such structure.
//! Frames, shapes, units: as in [`crate::Aba`]. Cost of a step: one acceleration. A call does not allocate.
//!
//! Derivative, with E_q, E_v those of `q ⊕ h v'`: `δv' = δv + h (A_q δq + A_v δv + A_u δu)`, `δq' = E_q δq + h E_v δv'`.

use super::dense::{add_product, add_scaled, add_transpose_product};
use super::dynamics::Acceleration;
use super::error::{expect_finite, no_room};
use super::{IntegrationError, Integrator, Linearisation, Linearise};
use crate::error::expect;
use featherbench_model::{TangentMap, Topology};
use featherbench_spatial::Angle;

/// The workspace of the symplectic Euler method.
#[derive(Clone, Debug)]
pub struct SymplecticEuler<T> {
    topology: Topology,
    a: Vec<T>,
    increment: Vec<T>,
    q: Vec<T>,
    v: Vec<T>,
    tape: Option<Tape<T>>,
}

/// What the derivative of the last step needs.
#[derive(Clone, Debug)]
struct Tape<T> {
    h: T,
    linear: Linearisation<T>,
    by_q: TangentMap<T>,
    by_v: TangentMap<T>,
    scratch: Vec<T>,
}

impl<T: Angle> SymplecticEuler<T> {
    /// A workspace for steps of this tree.
    pub fn new(topology: &Topology) -> Self {
        let zeros = |count| vec![T::zero(); count];
        let nv = topology.nv();
        Self { topology: topology.clone(), a: zeros(nv), increment: zeros(nv), q: zeros(topology.nq()), v: zeros(nv), tape: None }
    }

    /// A workspace for steps and their derivatives with this many inputs.
    pub fn with_derivatives(topology: &Topology, inputs: usize) -> Self {
        let tape = Tape {
            h: T::zero(),
            linear: Linearisation::new(topology.nv(), inputs),
            by_q: TangentMap::new(topology),
            by_v: TangentMap::new(topology),
            scratch: vec![T::zero(); topology.nv()],
        };
        Self { tape: Some(tape), ..Self::new(topology) }
    }

    /// The step from the acceleration `self.a`.
    fn finish(&mut self, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        self.v.copy_from_slice(v);
        add_scaled(h, &self.a, &mut self.v);
        for (increment, v) in self.increment.iter_mut().zip(&self.v) {
            *increment = h * *v;
        }
        self.topology.integrate(q, &self.increment, &mut self.q)?;
        expect_finite(t, &self.q, &self.v)?;
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        Ok(())
    }
}

impl<T: Angle> Integrator<T> for SymplecticEuler<T> {
    const ORDER: u32 = 1;

    fn step<F: Acceleration<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        expect("velocity v", self.topology.nv(), v.len())?;
        f.acceleration(t, q, v, &mut self.a)?;
        self.finish(t, h, q, v)
    }

    fn linearise<F: Linearise<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        expect("velocity v", self.topology.nv(), v.len())?;
        f.linearise(t, q, v, &mut self.a, &mut self.tape.as_mut().ok_or_else(no_room)?.linear)?;
        self.finish(t, h, q, v)?;
        if let Some(tape) = &mut self.tape {
            tape.h = h;
            tape.by_q.d_integrate_q(&self.increment)?;
            tape.by_v.d_integrate_v(&self.increment)?;
        }
        Ok(())
    }

    fn push(&mut self, dq: &mut [T], dv: &mut [T], du: &[T]) {
        let tape = self.tape.as_mut().expect("a workspace made for derivatives");
        // δa
        self.a.fill(T::zero());
        add_product(&tape.linear.by_q, dq, &mut self.a);
        add_product(&tape.linear.by_v, dv, &mut self.a);
        add_product(&tape.linear.by_input, du, &mut self.a);
        add_scaled(tape.h, &self.a, dv);
        tape.by_q.mul(dq, &mut tape.scratch).expect("δq has the size of the tree");
        dq.copy_from_slice(&tape.scratch);
        tape.by_v.mul(dv, &mut tape.scratch).expect("δv has the size of the tree");
        add_scaled(tape.h, &tape.scratch, dq);
    }

    fn pull(&mut self, lq: &mut [T], lv: &mut [T], lu: &mut [T]) {
        let tape = self.tape.as_mut().expect("a workspace made for derivatives");
        tape.by_v.transpose_mul(lq, &mut tape.scratch).expect("λq has the size of the tree");
        add_scaled(tape.h, &tape.scratch, lv);
        // the gradient of a
        for (a, lv) in self.a.iter_mut().zip(lv.iter()) {
            *a = tape.h * *lv;
        }
        tape.by_q.transpose_mul(lq, &mut tape.scratch).expect("λq has the size of the tree");
        lq.copy_from_slice(&tape.scratch);
        add_transpose_product(&tape.linear.by_q, &self.a, lq);
        add_transpose_product(&tape.linear.by_v, &self.a, lv);
        add_transpose_product(&tape.linear.by_input, &self.a, lu);
    }
}
