//! Explicit Runge–Kutta methods on the configuration space, in the form of Munthe-Kaas: what [`super::RungeKutta4`] and
//! [`super::DormandPrince`] share.
//!
//! Within a step the configuration is q ⊕ ξ. The step ξ is in a vector space, begins at zero, and has the rate `ξ̇ = J(ξ)⁻¹ v`. So a method
//! for vector spaces solves for (ξ, v), and keeps its order:
//!
//! ```text
//! ξᵢ = h Σ aᵢⱼ κⱼ    vᵢ = v + h Σ aᵢⱼ αⱼ    qᵢ = q ⊕ ξᵢ    αᵢ = a(t + cᵢh, qᵢ, vᵢ)    κᵢ = J(ξᵢ)⁻¹ vᵢ
//! q' = q ⊕ h Σ bᵢ κᵢ    v' = v + h Σ bᵢ αᵢ
//! ```
//!
//! Source: H. Munthe-Kaas, *High order Runge–Kutta methods on manifolds* (1999); here with the exact J⁻¹ instead of a truncated series.
//! The rotation of one step must stay below 2π, where J⁻¹ has a pole. Steps of half a turn are far longer than accuracy allows.
//! Frames, shapes, units: as in [`crate::Aba`]. Cost of a step: one acceleration per stage. A call does not allocate.
//!
//! Derivative of a stage, with Q = ∂(q ⊕ ξ)/∂q, V = ∂(q ⊕ ξ)/∂ξ, K = ∂(J⁻¹v)/∂ξ:
//! `δqᵢ = Q δq + V δξᵢ`, `δαᵢ = A_q δqᵢ + A_v δvᵢ + A_u δu`, `δκᵢ = J⁻¹ δvᵢ + K δξᵢ`. The adjoint goes through the stages backwards.

use super::dense::{add_product, add_scaled, add_transpose_product};
use super::dynamics::Acceleration;
use super::error::expect_finite;
use super::error::no_room;
use super::{IntegrationError, Linearisation, Linearise};
use crate::error::expect;
use featherbench_model::{TangentMap, Topology};
use featherbench_spatial::{Angle, Real};

/// The coefficients of a method, as ratios of whole numbers.
pub(super) struct Tableau {
    /// cᵢ, one per stage.
    pub(super) nodes: &'static [(f64, f64)],
    /// Row i has aᵢⱼ for j < i.
    pub(super) rows: &'static [&'static [(f64, f64)]],
    /// bᵢ.
    pub(super) weights: &'static [(f64, f64)],
}

/// The workspace of one explicit method.
#[derive(Clone, Debug)]
pub(super) struct Explicit<T> {
    pub(super) topology: Topology,
    nodes: Vec<T>,
    rows: Vec<Vec<T>>,
    weights: Vec<T>,
    pub(super) stages: Vec<Stage<T>>,
    /// The whole step ξ, and the state after it.
    pub(super) step: Vec<T>,
    pub(super) q: Vec<T>,
    pub(super) v: Vec<T>,
    tape: Option<Tape<T>>,
}

/// One stage: the state at which it evaluates, and what it finds there.
#[derive(Clone, Debug)]
pub(super) struct Stage<T> {
    step: Vec<T>,
    q: Vec<T>,
    v: Vec<T>,
    /// κ
    pub(super) rate: Vec<T>,
    /// α
    pub(super) a: Vec<T>,
}

/// What the derivative of the last step needs.
#[derive(Clone, Debug)]
struct Tape<T> {
    h: T,
    stages: Vec<StageTape<T>>,
    end_by_q: TangentMap<T>,
    end_by_step: TangentMap<T>,
    /// δξ and δv at a stage, or gradients of them; products.
    step: Vec<T>,
    v: Vec<T>,
    q: Vec<T>,
    product: Vec<T>,
}

#[derive(Clone, Debug)]
struct StageTape<T> {
    linear: Linearisation<T>,
    by_q: TangentMap<T>,
    by_step: TangentMap<T>,
    rate_by_v: TangentMap<T>,
    rate_by_step: TangentMap<T>,
    /// δκ and δα, or the gradients of κ and α.
    rate: Vec<T>,
    a: Vec<T>,
}

fn ratio<T: Real>(&(numerator, denominator): &(f64, f64)) -> T {
    T::from_f64(numerator) / T::from_f64(denominator)
}

impl<T: Angle> Explicit<T> {
    pub(super) fn new(topology: &Topology, tableau: &Tableau) -> Self {
        let zeros = |count| vec![T::zero(); count];
        let (nq, nv) = (topology.nq(), topology.nv());
        let stage = Stage { step: zeros(nv), q: zeros(nq), v: zeros(nv), rate: zeros(nv), a: zeros(nv) };
        Self {
            topology: topology.clone(),
            nodes: tableau.nodes.iter().map(ratio).collect(),
            rows: tableau.rows.iter().map(|row| row.iter().map(ratio).collect()).collect(),
            weights: tableau.weights.iter().map(ratio).collect(),
            stages: vec![stage; tableau.nodes.len()],
            step: zeros(nv),
            q: zeros(nq),
            v: zeros(nv),
            tape: None,
        }
    }

    pub(super) fn with_derivatives(topology: &Topology, tableau: &Tableau, inputs: usize) -> Self {
        let nv = topology.nv();
        let (zeros, map) = (vec![T::zero(); nv], TangentMap::new(topology));
        let stage = StageTape {
            linear: Linearisation::new(nv, inputs),
            by_q: map.clone(),
            by_step: map.clone(),
            rate_by_v: map.clone(),
            rate_by_step: map.clone(),
            rate: zeros.clone(),
            a: zeros.clone(),
        };
        let tape = Tape {
            h: T::zero(),
            stages: vec![stage; tableau.nodes.len()],
            end_by_q: map.clone(),
            end_by_step: map,
            step: zeros.clone(),
            v: zeros.clone(),
            q: zeros.clone(),
            product: zeros,
        };
        Self { tape: Some(tape), ..Self::new(topology, tableau) }
    }

    /// The stages from `first` on, by an evaluation of the acceleration at each; then the end of the step in `self.q` and `self.v`.
    pub(super) fn evaluate(
        &mut self,
        first: usize,
        t: T,
        h: T,
        q: &[T],
        v: &[T],
        mut evaluate: impl FnMut(usize, T, &[T], &[T], &mut [T]) -> Result<(), crate::Error>,
    ) -> Result<(), IntegrationError> {
        expect("velocity v", self.topology.nv(), v.len())?;
        for i in 0..self.stages.len() {
            let (before, rest) = self.stages.split_at_mut(i);
            let Stage { step, q: q_stage, v: v_stage, rate, a } = &mut rest[0];
            step.fill(T::zero());
            v_stage.copy_from_slice(v);
            for (coefficient, stage) in self.rows[i].iter().zip(before.iter()) {
                let factor = h * *coefficient;
                add_scaled(factor, &stage.rate, step);
                add_scaled(factor, &stage.a, v_stage);
            }
            self.topology.integrate(q, step, q_stage)?;
            self.topology.step_rate(step, v_stage, rate)?;
            if i >= first {
                evaluate(i, self.nodes[i].mul_add(h, t), q_stage, v_stage, a)?;
            }
        }
        self.step.fill(T::zero());
        self.v.copy_from_slice(v);
        for (weight, stage) in self.weights.iter().zip(&self.stages) {
            add_scaled(h * *weight, &stage.rate, &mut self.step);
            add_scaled(h * *weight, &stage.a, &mut self.v);
        }
        self.topology.integrate(q, &self.step, &mut self.q)?;
        expect_finite(t, &self.q, &self.v)
    }

    pub(super) fn step<F: Acceleration<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        self.evaluate(0, t, h, q, v, |_, t, q, v, a| f.acceleration(t, q, v, a))?;
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        Ok(())
    }

    pub(super) fn linearise<F: Linearise<T>>(&mut self, f: &mut F, t: T, h: T, q: &mut [T], v: &mut [T]) -> Result<(), IntegrationError> {
        let Some(mut tape) = self.tape.take() else {
            return Err(no_room().into());
        };
        let result = self.evaluate(0, t, h, q, v, |i, t, q, v, a| f.linearise(t, q, v, a, &mut tape.stages[i].linear));
        let result = result.and_then(|()| tape.note(self, h));
        self.tape = Some(tape);
        result?;
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        Ok(())
    }

    pub(super) fn push(&mut self, dq: &mut [T], dv: &mut [T], du: &[T]) {
        let tape = self.tape.as_mut().expect("a workspace made for derivatives");
        for i in 0..tape.stages.len() {
            tape.sum(i, &self.rows[i], dv);
            let Tape { stages, step, v, q, product, .. } = tape;
            let stage = &mut stages[i];
            apply(&stage.by_q, dq, q);
            apply(&stage.by_step, step, product);
            add_scaled(T::one(), product, q);
            stage.a.fill(T::zero());
            add_product(&stage.linear.by_q, q, &mut stage.a);
            add_product(&stage.linear.by_v, v, &mut stage.a);
            add_product(&stage.linear.by_input, du, &mut stage.a);
            apply(&stage.rate_by_v, v, &mut stage.rate);
            apply(&stage.rate_by_step, step, product);
            add_scaled(T::one(), product, &mut stage.rate);
        }
        tape.sum(tape.stages.len(), &self.weights, dv);
        dv.copy_from_slice(&tape.v);
        apply(&tape.end_by_q, dq, &mut tape.q);
        dq.copy_from_slice(&tape.q);
        apply(&tape.end_by_step, &tape.step, &mut tape.product);
        add_scaled(T::one(), &tape.product, dq);
    }

    pub(super) fn pull(&mut self, lq: &mut [T], lv: &mut [T], lu: &mut [T]) {
        let tape = self.tape.as_mut().expect("a workspace made for derivatives");
        let count = tape.stages.len();
        for stage in &mut tape.stages {
            stage.rate.fill(T::zero());
            stage.a.fill(T::zero());
        }
        // The end: gradients of ξ and v', passed to κ and α of the stages.
        apply_transpose(&tape.end_by_step, lq, &mut tape.step);
        tape.v.copy_from_slice(lv);
        tape.scatter(count, &self.weights);
        apply_transpose(&tape.end_by_q, lq, &mut tape.product);
        lq.copy_from_slice(&tape.product);
        for i in (0..count).rev() {
            let Tape { stages, step, v, q, product, .. } = tape;
            let stage = &stages[i];
            q.fill(T::zero());
            add_transpose_product(&stage.linear.by_q, &stage.a, q);
            apply_transpose(&stage.rate_by_v, &stage.rate, v);
            add_transpose_product(&stage.linear.by_v, &stage.a, v);
            add_transpose_product(&stage.linear.by_input, &stage.a, lu);
            apply_transpose(&stage.by_step, q, step);
            apply_transpose(&stage.rate_by_step, &stage.rate, product);
            add_scaled(T::one(), product, step);
            apply_transpose(&stage.by_q, q, product);
            add_scaled(T::one(), product, lq);
            add_scaled(T::one(), v, lv);
            tape.scatter(i, &self.rows[i]);
        }
    }
}

impl<T: Angle> Tape<T> {
    /// The tangent maps of the step that `method` has made.
    fn note(&mut self, method: &Explicit<T>, h: T) -> Result<(), IntegrationError> {
        self.h = h;
        for (tape, stage) in self.stages.iter_mut().zip(&method.stages) {
            tape.by_q.d_integrate_q(&stage.step)?;
            tape.by_step.d_integrate_v(&stage.step)?;
            tape.rate_by_v.d_difference_to(&stage.step)?;
            tape.rate_by_step.d_step_rate(&stage.step, &stage.v)?;
        }
        self.end_by_q.d_integrate_q(&method.step)?;
        self.end_by_step.d_integrate_v(&method.step)?;
        Ok(())
    }

    /// `δξ = h Σ aⱼ δκⱼ`, `δv + h Σ aⱼ δαⱼ` over the first stages.
    fn sum(&mut self, stages: usize, row: &[T], dv: &[T]) {
        self.step.fill(T::zero());
        self.v.copy_from_slice(dv);
        for (coefficient, stage) in row.iter().zip(&self.stages[..stages]) {
            add_scaled(self.h * *coefficient, &stage.rate, &mut self.step);
            add_scaled(self.h * *coefficient, &stage.a, &mut self.v);
        }
    }

    /// The transpose of [`Tape::sum`]: gradients of ξ and v, passed to κ and α of the first stages.
    fn scatter(&mut self, stages: usize, row: &[T]) {
        for (coefficient, stage) in row.iter().zip(&mut self.stages[..stages]) {
            add_scaled(self.h * *coefficient, &self.step, &mut stage.rate);
            add_scaled(self.h * *coefficient, &self.v, &mut stage.a);
        }
    }
}

/// `result = map · x`, on vectors of the workspace or checked before.
fn apply<T: Real>(map: &TangentMap<T>, x: &[T], result: &mut [T]) {
    map.mul(x, result).expect("directions have the size of the tree");
}

/// `result = mapᵀ · x`
fn apply_transpose<T: Real>(map: &TangentMap<T>, x: &[T], result: &mut [T]) {
    map.transpose_mul(x, result).expect("gradients have the size of the tree");
}
