//! The discrete adjoint: the gradient of a cost of a whole trajectory, in one pass back.
//!
//! Computes, for J = Σ ℓ_k(x_k, u_k) over the states k = 0 … N of the discrete steps Φ of an integrator:
//!
//! ```text
//! λ_N = ∂ℓ_N/∂x    λ_k = (∂Φ/∂x)ᵀ λ_{k+1} + ∂ℓ_k/∂x    dJ/du_k = (∂Φ/∂u)ᵀ λ_{k+1} + ∂ℓ_k/∂u    dJ/dx₀ = λ₀
//! ```
//!
//! It is the gradient of the computed cost, exact up to rounding, for each integrator and step length. Source: Griewank and Walther,
//! *Evaluating Derivatives* (2008), chapters 3 and 12.
//!
//! **Memory.** Each c-th state is kept (c is `spacing`). The states between two of them are computed again, together with the steps'
//! linearisations, one step at a time. So N/c + c states are kept, and one linearised step, whatever N is. The smallest memory is at c = √N.
//! With c = 1 all states are kept and none is computed again.
//!
//! Shapes: the gradient has [`Rollout::variables`] numbers. Cost: two steps and a linearised step per step (one step less with c = 1), and
//! O(nv²) per stage. [`Adjoint::run`] does not allocate.

use super::{IntegrationError, Integrator, Linearise, Rollout};
use crate::error::expect;
use featherbench_model::Topology;
use featherbench_spatial::Angle;

/// A state of a trajectory that a cost looks at.
#[derive(Clone, Copy, Debug)]
pub struct Visit<'a, T> {
    /// The number of steps before it.
    pub index: usize,
    /// Whether it is the last one. That has no controls.
    pub last: bool,
    /// The time.
    pub time: T,
    /// The configuration.
    pub q: &'a [T],
    /// The velocity.
    pub v: &'a [T],
    /// The controls of the step that begins here.
    pub controls: &'a [T],
    /// The parameters.
    pub parameters: &'a [T],
}

/// The gradient of one state's cost.
#[derive(Debug)]
pub struct CostGradient<'a, T> {
    /// On the tangent space of q.
    pub q: &'a mut [T],
    /// With respect to v.
    pub v: &'a mut [T],
    /// With respect to the controls.
    pub controls: &'a mut [T],
    /// With respect to the parameters.
    pub parameters: &'a mut [T],
}

/// A cost that is a sum over the states of a trajectory.
pub trait Cost<T> {
    /// The cost of a state.
    fn value(&mut self, at: &Visit<'_, T>) -> T;

    /// *Adds* the gradient of that cost.
    fn add_gradient(&mut self, at: &Visit<'_, T>, gradient: &mut CostGradient<'_, T>);
}

/// The workspace of the adjoint.
///
/// A swing-up of a pendulum: the gradient of a cost with respect to each step's torque, and a descent along it.
///
/// ```
/// use featherbench_dynamics::integrate::{Adjoint, Analytic, Cost, CostGradient, Motors, Rollout, RungeKutta4, Visit};
/// use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model};
///
/// // One kilogramme, half a metre below its axis; q = 0 hangs down, q = π stands.
/// let joint = JointDescription { kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] }, ..JointDescription::default() };
/// let bob = BodyDescription { name: "bob".into(), parent: None, mass: 1.0, com: [0.0, 0.0, -0.5], inertia: [0.0; 6], joint };
/// let pendulum = Description { gravity: [0.0, 0.0, -9.81], bodies: vec![bob], ..Description::default() };
/// let model: Model<f64> = Model::build(&pendulum)?;
///
/// /// At the end: the distance from upright and at rest. On the way: a little for torque.
/// struct SwingUp;
/// const TORQUE: f64 = 1e-4;
/// impl Cost<f64> for SwingUp {
///     fn value(&mut self, at: &Visit<'_, f64>) -> f64 {
///         if at.last { (1.0 + at.q[0].cos()) + 0.1 * at.v[0] * at.v[0] } else { TORQUE * at.controls[0] * at.controls[0] }
///     }
///     fn add_gradient(&mut self, at: &Visit<'_, f64>, gradient: &mut CostGradient<'_, f64>) {
///         if at.last {
///             gradient.q[0] -= at.q[0].sin();
///             gradient.v[0] += 0.2 * at.v[0];
///         } else {
///             gradient.controls[0] += 2.0 * TORQUE * at.controls[0];
///         }
///     }
/// }
///
/// let steps = vec![0.02; 75];
/// let mut torques = vec![0.5; 75];
/// let mut f = Analytic::new(&model, Motors { dofs: vec![0] }, &[])?;
/// let mut integrator = RungeKutta4::with_derivatives(&model.topology, 1);
/// let mut adjoint = Adjoint::new(&model.topology, 75, 9, 1);
/// let mut gradient = vec![0.0; 2 + 75];
/// let mut cost_of = |torques: &[f64], gradient: &mut [f64]| {
///     let rollout = Rollout { start: 0.0, steps: &steps, q: &[0.0], v: &[0.0], controls: torques, parameters: &[] };
///     adjoint.run(&mut integrator, &mut f, &rollout, &mut SwingUp, gradient)
/// };
///
/// // The gradient is that of differences.
/// let first = cost_of(&torques, &mut gradient)?;
/// let along: f64 = gradient[2..].iter().sum();
/// let moved = |by: f64| torques.iter().map(|torque| torque + by).collect::<Vec<_>>();
/// let mut ignored = gradient.clone();
/// let difference = (cost_of(&moved(1e-5), &mut ignored)? - cost_of(&moved(-1e-5), &mut ignored)?) / 2e-5;
/// assert!((along - difference).abs() < 1e-7 * difference.abs());
///
/// // A descent swings it up.
/// let mut cost = first;
/// for _ in 0..200 {
///     for (torque, slope) in torques.iter_mut().zip(&gradient[2..]) {
///         *torque -= 5.0 * slope;
///     }
///     cost = cost_of(&torques, &mut gradient)?;
/// }
/// assert!(first > 1.0 && cost < 0.2, "from {first} to {cost}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Adjoint<T> {
    topology: Topology,
    spacing: usize,
    /// Each `spacing`-th state: time, q, v.
    kept: Vec<State<T>>,
    /// The states from one of these to the next.
    between: Vec<State<T>>,
    now: State<T>,
    lq: Vec<T>,
    lv: Vec<T>,
    inputs: Vec<T>,
}

#[derive(Clone, Debug)]
struct State<T> {
    t: T,
    q: Vec<T>,
    v: Vec<T>,
}

impl<T: Angle> State<T> {
    fn copy(&mut self, other: &Self) {
        self.t = other.t;
        self.q.copy_from_slice(&other.q);
        self.v.copy_from_slice(&other.v);
    }
}

impl<T: Angle> Adjoint<T> {
    /// A workspace for trajectories of this tree with up to `steps` steps, and with this many controls and parameters together. Each
    /// `spacing`-th state is kept (0 counts as 1).
    pub fn new(topology: &Topology, steps: usize, spacing: usize, inputs: usize) -> Self {
        let zeros = |count| vec![T::zero(); count];
        let state = State { t: T::zero(), q: zeros(topology.nq()), v: zeros(topology.nv()) };
        let spacing = if spacing == 0 { 1 } else { spacing };
        Self {
            topology: topology.clone(),
            spacing,
            kept: vec![state.clone(); steps.div_ceil(spacing)],
            between: vec![state.clone(); if spacing < steps { spacing } else { steps }],
            now: state,
            lq: zeros(topology.nv()),
            lv: zeros(topology.nv()),
            inputs: zeros(inputs),
        }
    }

    /// The states that are kept: the memory in numbers is this times `nq + nv + 1`.
    pub fn states_kept(&self) -> usize {
        self.kept.len() + self.between.len()
    }

    /// The cost of a trajectory, and its gradient with respect to the trajectory's variables.
    ///
    /// # Errors
    /// [`IntegrationError`] when an argument does not fit, or of the first step that fails.
    pub fn run<I: Integrator<T>, F: Linearise<T>, C: Cost<T>>(
        &mut self,
        integrator: &mut I,
        f: &mut F,
        rollout: &Rollout<'_, T>,
        cost: &mut C,
        gradient: &mut [T],
    ) -> Result<T, IntegrationError> {
        rollout.begin(&self.topology, f)?;
        let (nv, steps, controls) = (self.topology.nv(), rollout.steps.len(), f.controls());
        expect("gradient", rollout.variables(), gradient.len())?;
        expect("inputs of the workspace", controls + f.parameters(), self.inputs.len())?;
        let room = self.kept.len() * self.spacing;
        if steps > room {
            expect("steps that the workspace has room for", steps, room)?;
        }
        gradient.fill(T::zero());

        // Forward: the cost, and each c-th state.
        let mut total = T::zero();
        self.now.t = rollout.start;
        self.now.q.copy_from_slice(rollout.q);
        self.now.v.copy_from_slice(rollout.v);
        for (step, &h) in rollout.steps.iter().enumerate() {
            if step % self.spacing == 0 {
                self.kept[step / self.spacing].copy(&self.now);
            }
            let at = &mut self.now;
            total += cost.value(&visit(at, rollout, step));
            f.set_controls(rollout.controls_of(step))?;
            integrator.step(f, at.t, h, &mut at.q, &mut at.v)?;
            at.t += h;
        }
        total += cost.value(&visit(&self.now, rollout, steps));

        // Back, from one kept state to the one before.
        self.lq.fill(T::zero());
        self.lv.fill(T::zero());
        add_cost(cost, &self.now, rollout, steps, &mut self.lq, &mut self.lv, gradient);
        for block in (0..steps.div_ceil(self.spacing)).rev() {
            let first = block * self.spacing;
            let end = if first + self.spacing < steps { first + self.spacing } else { steps };
            self.between[0].copy(&self.kept[block]);
            for step in first..end - 1 {
                let (done, rest) = self.between.split_at_mut(step + 1 - first);
                let next = &mut rest[0];
                next.copy(&done[step - first]);
                f.set_controls(rollout.controls_of(step))?;
                integrator.step(f, next.t, rollout.steps[step], &mut next.q, &mut next.v)?;
                next.t += rollout.steps[step];
            }
            for step in (first..end).rev() {
                self.now.copy(&self.between[step - first]);
                f.set_controls(rollout.controls_of(step))?;
                integrator.linearise(f, self.now.t, rollout.steps[step], &mut self.now.q, &mut self.now.v)?;
                self.inputs.fill(T::zero());
                integrator.pull(&mut self.lq, &mut self.lv, &mut self.inputs);
                let (of_controls, of_parameters) = self.inputs.split_at(controls);
                add(of_controls, &mut gradient[rollout.place_of_controls(step)]);
                add(of_parameters, &mut gradient[rollout.place_of_parameters()]);
                add_cost(cost, &self.between[step - first], rollout, step, &mut self.lq, &mut self.lv, gradient);
            }
        }
        gradient[..nv].copy_from_slice(&self.lq);
        gradient[nv..2 * nv].copy_from_slice(&self.lv);
        Ok(total)
    }
}

/// What the cost sees of a state.
fn visit<'a, T: Angle>(state: &'a State<T>, rollout: &'a Rollout<'_, T>, index: usize) -> Visit<'a, T> {
    let last = index == rollout.steps.len();
    let controls = if last { &[] } else { rollout.controls_of(index) };
    Visit { index, last, time: state.t, q: &state.q, v: &state.v, controls, parameters: rollout.parameters }
}

/// Adds the gradient of one state's cost.
fn add_cost<T: Angle, C: Cost<T>>(
    cost: &mut C,
    state: &State<T>,
    rollout: &Rollout<'_, T>,
    index: usize,
    q: &mut [T],
    v: &mut [T],
    gradient: &mut [T],
) {
    let (before, parameters) = gradient.split_at_mut(rollout.place_of_parameters().start);
    let controls = if index == rollout.steps.len() { &mut [] } else { &mut before[rollout.place_of_controls(index)] };
    cost.add_gradient(&visit(state, rollout, index), &mut CostGradient { q, v, controls, parameters });
}

fn add<T: Angle>(x: &[T], sum: &mut [T]) {
    for (x, sum) in x.iter().zip(sum) {
        *sum += *x;
    }
}
