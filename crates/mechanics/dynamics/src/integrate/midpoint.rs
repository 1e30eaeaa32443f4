//! The implicit midpoint rule on the configuration space:
//!
//! ```text
//! u = v + (h/2) a(t + h/2, q ⊕ (h/2) u, u)        q' = q ⊕ h u        v' = 2u − v
//! ```
//!
//! Source: Hairer, Lubich and Wanner, *Geometric Numerical Integration* (2006), §II.1.3; on a Lie group the half steps are
//! `q' = q exp(h u)` and the middle `q exp(h u/2) = q' exp(−h u/2)`. So a step with −h undoes one with h.
//!
//! Order 2. It conserves first integrals that are quadratic in v alone: the kinetic energy and the squared angular momentum of a free
//! body. The momentum in world axes, and the energy where M depends on q, are kept at order 2 without a drift in reversible systems.
//!
//! **Stop.** u is found by fixed-point iteration. The iteration ends when the change of u, at most 10⁻⁶ of the largest velocity, no longer
//! shrinks: then only roundings are left, in every scalar. It converges if `(h/2)·‖∂a/∂v + (h/2) ∂a/∂q‖ < 1`. After 100 iterations it is an
//! error. [`ImplicitMidpoint::step_by_newton`] has no such condition: `u ← u + N⁻¹ (v + (h/2) a − u)`, with N as below.
//! [`Integrator::linearise`] does so where the fixed-point iteration fails. With lanes all iterate until the last one ends. With duals as scalars
//! the derivatives lag behind: use [`Integrator::linearise`], which differentiates the converged step.
//!
//! Derivative, with Q, V those of `q ⊕ (h/2)u`, E, W those of `q ⊕ h u`, and N = 1 − (h/2) A_v − (h/2)² A_q V:
//! `δu = N⁻¹ (δv + (h/2)(A_q Q δq + A_u δu))`, `δq' = E δq + h W δu`, `δv' = 2δu − δv`.
//!
//! Frames, shapes, units: as in [`crate::Aba`]. Cost of a step: one acceleration per iteration, about log ε/log of the rate of convergence.
//! A call does not allocate.

use super::dense::{Lu, add_product, add_scaled, add_transpose_product};
use super::dynamics::Acceleration;
use super::error::{expect_finite, largest, no_room};
use super::{IntegrationError, Integrator, Linearisation, Linearise};
use crate::error::expect;
use featherbench_model::{TangentMap, Topology};
use featherbench_spatial::Angle;

/// The largest number of iterations.
const ITERATIONS: usize = 100;
/// The change, relative to the largest velocity, below which the iteration may end.
const NEAR: f64 = 1e-6;

/// The iteration of an implicit step, and when it ends.
pub(super) struct Iteration {
    time: f64,
    previous: f64,
    pub(super) count: usize,
}

impl Iteration {
    /// Before the first change, of a step from this time.
    pub(super) fn new(time: f64) -> Self {
        Self { time, previous: f64::INFINITY, count: 0 }
    }

    /// Whether a largest change of the velocities, the largest of which is `size`, was the last one.
    ///
    /// # Errors
    /// [`IntegrationError`]: the change is not finite, or there were too many.
    pub(super) fn ends(&mut self, change: f64, size: f64) -> Result<bool, IntegrationError> {
        self.count += 1;
        if !change.is_finite() {
            return Err(IntegrationError::NotFinite { time: self.time });
        }
        if change == 0.0 || (change <= NEAR * size && change >= self.previous) {
            return Ok(true);
        }
        if self.count == ITERATIONS {
            return Err(IntegrationError::NotConverged { time: self.time, iterations: ITERATIONS, change });
        }
        self.previous = change;
        Ok(false)
    }
}

/// The workspace of the implicit midpoint rule.
#[derive(Clone, Debug)]
pub struct ImplicitMidpoint<T> {
    topology: Topology,
    /// u, the next iterate, and the acceleration.
    middle: Vec<T>,
    next: Vec<T>,
    a: Vec<T>,
    /// The step (h/2) u or h u.
    increment: Vec<T>,
    q: Vec<T>,
    v: Vec<T>,
    iterations: usize,
    tape: Option<Tape<T>>,
}

/// What the derivative of the last step needs.
#[derive(Clone, Debug)]
struct Tape<T> {
    h: T,
    /// The configuration in the middle.
    q: Vec<T>,
    linear: Linearisation<T>,
    middle_by_q: TangentMap<T>,
    middle_by_step: TangentMap<T>,
    end_by_q: TangentMap<T>,
    end_by_step: TangentMap<T>,
    /// N.
    factors: Lu<T>,
    x: Vec<T>,
    y: Vec<T>,
}

impl<T: Angle> ImplicitMidpoint<T> {
    /// A workspace for steps of this tree.
    pub fn new(topology: &Topology) -> Self {
        let zeros = |count| vec![T::zero(); count];
        let nv = topology.nv();
        Self {
            topology: topology.clone(),
            middle: zeros(nv),
            next: zeros(nv),
            a: zeros(nv),
            increment: zeros(nv),
            q: zeros(topology.nq()),
            v: zeros(nv),
            iterations: 0,
            tape: None,
        }
    }

    /// A workspace for steps and their derivatives with this many inputs.
    pub fn with_derivatives(topology: &Topology, inputs: usize) -> Self {
        let map = TangentMap::new(topology);
        let nv = topology.nv();
        let tape = Tape {
            h: T::zero(),
            q: vec![T::zero(); topology.nq()],
            linear: Linearisation::new(nv, inputs),
            middle_by_q: map.clone(),
            middle_by_step: map.clone(),
            end_by_q: map.clone(),
            end_by_step: map,
            factors: Lu::new(nv),
            x: vec![T::zero(); nv],
            y: vec![T::zero(); nv],
        };
        Self { tape: Some(tape), ..Self::new(topology) }
    }

    /// The iterations of the last step.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// [`Integrator::step`] by Newton's method, for stiff forces and long steps. The workspace must have been made for derivatives. An
    /// iteration takes one [`Linearise::linearise`] and the solution of `nv` equations.
    ///
    /// # Errors
    /// As [`Integrator::step`]; also for a workspace without room for derivatives, and if the equations of an iteration are singular.
    pub fn step_by_newton<F: Linearise<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        self.solve_by_newton(f, t, h, q, v)?;
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        Ok(())
    }

    /// Solves for u by fixed-point iteration, and computes the state after the step in `self.q` and `self.v`.
    fn solve<F: Acceleration<T>>(&mut self, f: &mut F, t: T, h: T, q: &[T], v: &[T]) -> Result<(), IntegrationError> {
        expect("velocity v", self.topology.nv(), v.len())?;
        let half = h * T::from_f64(0.5);
        self.middle.copy_from_slice(v);
        let mut iteration = Iteration::new(t.min_lane());
        loop {
            scale(half, &self.middle, &mut self.increment);
            self.topology.integrate(q, &self.increment, &mut self.q)?;
            f.acceleration(t + half, &self.q, &self.middle, &mut self.a)?;
            self.next.copy_from_slice(v);
            add_scaled(half, &self.a, &mut self.next);
            let change = largest(self.next.iter().zip(&self.middle).map(|(next, middle)| *next - *middle));
            let size = largest(self.next.iter().copied());
            std::mem::swap(&mut self.middle, &mut self.next);
            if iteration.ends(change, size)? {
                break;
            }
        }
        self.iterations = iteration.count;
        self.end(t, h, q, v)
    }

    /// The same by Newton's method.
    fn solve_by_newton<F: Linearise<T>>(&mut self, f: &mut F, t: T, h: T, q: &[T], v: &[T]) -> Result<(), IntegrationError> {
        expect("velocity v", self.topology.nv(), v.len())?;
        let half = h * T::from_f64(0.5);
        self.middle.copy_from_slice(v);
        let mut iteration = Iteration::new(t.min_lane());
        loop {
            self.expand(f, t, h, q)?;
            let tape = self.tape.as_mut().ok_or_else(no_room)?;
            for (((x, v), middle), a) in tape.x.iter_mut().zip(v).zip(&self.middle).zip(&self.a) {
                *x = half.mul_add(*a, *v - *middle);
            }
            tape.factors.solve(&mut tape.x);
            add_scaled(T::one(), &tape.x, &mut self.middle);
            if iteration.ends(largest(tape.x.iter().copied()), largest(self.middle.iter().copied()))? {
                break;
            }
        }
        self.iterations = iteration.count;
        self.end(t, h, q, v)
    }

    /// The state after the step, from u.
    fn end(&mut self, t: T, h: T, q: &[T], v: &[T]) -> Result<(), IntegrationError> {
        scale(h, &self.middle, &mut self.increment);
        self.topology.integrate(q, &self.increment, &mut self.q)?;
        for ((end, middle), v) in self.v.iter_mut().zip(&self.middle).zip(v) {
            *end = *middle + (*middle - *v);
        }
        expect_finite(t, &self.q, &self.v)
    }

    /// The acceleration in the middle with its derivatives, and the factors of N.
    fn expand<F: Linearise<T>>(&mut self, f: &mut F, t: T, h: T, q: &[T]) -> Result<(), IntegrationError> {
        let tape = self.tape.as_mut().ok_or_else(no_room)?;
        let (nv, half) = (self.middle.len(), h * T::from_f64(0.5));
        scale(half, &self.middle, &mut self.increment);
        tape.middle_by_q.d_integrate_q(&self.increment)?;
        tape.middle_by_step.d_integrate_v(&self.increment)?;
        self.topology.integrate(q, &self.increment, &mut tape.q)?;
        f.linearise(t + half, &tape.q, &self.middle, &mut self.a, &mut tape.linear)?;

        // N = 1 − (h/2) A_v − (h/2)² A_q V, row by row: row of A_q V = Vᵀ (row of A_q)
        for row in 0..nv {
            let of_row = row * nv..(row + 1) * nv;
            tape.middle_by_step.transpose_mul(&tape.linear.by_q[of_row], &mut tape.x)?;
            for column in 0..nv {
                let unit = if row == column { T::one() } else { T::zero() };
                let sum = half.mul_add(tape.x[column], tape.linear.by_v[row * nv + column]);
                tape.factors.values[row * nv + column] = (-half).mul_add(sum, unit);
            }
        }
        if tape.factors.factor() { Ok(()) } else { Err(IntegrationError::Singular { time: t.min_lane() }) }
    }
}

/// `result = factor · x`
pub(super) fn scale<T: Angle>(factor: T, x: &[T], result: &mut [T]) {
    for (x, result) in x.iter().zip(result) {
        *result = factor * *x;
    }
}

impl<T: Angle> Integrator<T> for ImplicitMidpoint<T> {
    const ORDER: u32 = 2;

    fn step<F: Acceleration<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        self.solve(f, t, h, q, v)?;
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        Ok(())
    }

    fn linearise<F: Linearise<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        match self.solve(f, t, h, q, v) {
            Err(IntegrationError::NotConverged { .. } | IntegrationError::NotFinite { .. }) => self.solve_by_newton(f, t, h, q, v)?,
            solved => solved?,
        }
        self.expand(f, t, h, q)?;
        let tape = self.tape.as_mut().ok_or_else(no_room)?;
        tape.h = h;
        scale(h, &self.middle, &mut self.increment);
        tape.end_by_q.d_integrate_q(&self.increment)?;
        tape.end_by_step.d_integrate_v(&self.increment)?;
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        Ok(())
    }

    fn push(&mut self, dq: &mut [T], dv: &mut [T], du: &[T]) {
        let tape = self.tape.as_mut().expect("a workspace made for derivatives");
        let half = tape.h * T::from_f64(0.5);
        // right-hand side: δv + (h/2)(A_q Q δq + A_u δu)
        tape.middle_by_q.mul(dq, &mut tape.x).expect("δq has the size of the tree");
        tape.y.fill(T::zero());
        add_product(&tape.linear.by_q, &tape.x, &mut tape.y);
        add_product(&tape.linear.by_input, du, &mut tape.y);
        tape.x.copy_from_slice(dv);
        add_scaled(half, &tape.y, &mut tape.x);
        tape.factors.solve(&mut tape.x);
        for (dv, middle) in dv.iter_mut().zip(&tape.x) {
            *dv = *middle + (*middle - *dv);
        }
        tape.end_by_q.mul(dq, &mut tape.y).expect("δq has the size of the tree");
        dq.copy_from_slice(&tape.y);
        tape.end_by_step.mul(&tape.x, &mut tape.y).expect("δu has the size of the tree");
        add_scaled(tape.h, &tape.y, dq);
    }

    fn pull(&mut self, lq: &mut [T], lv: &mut [T], lu: &mut [T]) {
        let tape = self.tape.as_mut().expect("a workspace made for derivatives");
        let half = tape.h * T::from_f64(0.5);
        // the gradient of u, through N
        tape.end_by_step.transpose_mul(lq, &mut tape.x).expect("λq has the size of the tree");
        for (x, lv) in tape.x.iter_mut().zip(lv.iter()) {
            *x = tape.h.mul_add(*x, *lv + *lv);
        }
        tape.factors.transpose_solve(&mut tape.x);
        for (lv, x) in lv.iter_mut().zip(&tape.x) {
            *lv = *x - *lv;
        }
        tape.end_by_q.transpose_mul(lq, &mut tape.y).expect("λq has the size of the tree");
        lq.copy_from_slice(&tape.y);
        tape.x.iter_mut().for_each(|x| *x *= half);
        add_transpose_product(&tape.linear.by_input, &tape.x, lu);
        tape.y.fill(T::zero());
        add_transpose_product(&tape.linear.by_q, &tape.x, &mut tape.y);
        tape.middle_by_q.transpose_mul(&tape.y, &mut tape.x).expect("λq has the size of the tree");
        add_scaled(T::one(), &tape.x, lq);
    }
}
